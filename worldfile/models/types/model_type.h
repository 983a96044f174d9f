// ModelType: a model type of the Stage language: its defaults, and the reader of its own properties. A new type is one
// file that defines its ModelType, declared in built_in_types.h and listed in model_types.cc.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "worldfile/models/properties/build_context.h"
#include "worldfile/models/properties/model_shape.h"

namespace troupe {

struct ModelType;

// A model whose common properties are read; the reader of its type adds the rest.
struct ModelDraft {
  const ModelType& type;
  const WorldNode& node;
  ModelId id;  // its place in the world's models, which the builder appends it to
  ModelDescription model = {};
  Size size = {};                     // m
  Pose X_MD = {};                     // the declared shape's frame D in the model's frame M
  Pose X_WM = {};                     // at load
  std::optional<RosMap> map = {};     // given by the property `map_yaml`
  std::optional<RobotId> robot = {};  // the robot that the model belongs to; a type with a drive may start one
};

// Reads the properties that only models of one type have. One reader serves one model, and is called in the order of
// its methods. Faults are reported to the PropertyReader's diagnostics; after the first one results are ignored.
class ModelReader {
 public:
  virtual ~ModelReader() = default;

  // The model's body in frame M. By default: the map, the bitmap, the blocks, or the box that the type starts as.
  virtual Shape ReadShape(PropertyReader& reader, const ModelDraft& draft, BuildContext& context);

  // The properties that do not concern the body.
  virtual void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context);

  // Adds the parts that the model has by itself. The model is the last one of the world.
  virtual void AddParts(const ModelDraft& draft, BuildContext& context);

  // Adds descriptions that name other models or joints: all of them are in the world.
  virtual void Complete(BuildContext& context);
};

template <typename Reader>
std::unique_ptr<ModelReader> MakeReader() {
  return std::make_unique<Reader>();
}

struct ModelType {
  std::string_view name;
  bool has_body = true;      // starts as a box of its size
  Size size{0.4, 0.4, 1.0};  // m
  Color color{1.0, 0.0, 0.0, 1.0};
  bool has_drive = false;    // a robot, unless it is a part of one
  bool has_sensors = false;  // its children may be `sensor`
  std::unique_ptr<ModelReader> (*make_reader)() = MakeReader<ModelReader>;
};

// A model's name without that of its robot.
std::string NameOnRobot(const WorldDescription& world, RobotId robot, const std::string& name);

}  // namespace troupe
