// The registry of model types: from a type's name in a world file to its defaults and its reader.
//
// A table of values, not a registration by static objects: the order of messages is fixed, and a type cannot be lost by
// the linker. Readers are made for one model each, so that they may keep what Complete needs until all models exist.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "worldfile/models/properties/model_shape.h"
#include "worldfile/models/properties/property_reader.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// ModelType: a model type of the Stage language: its defaults, and the reader of its own properties. A new type is one
// file that defines its ModelType, declared in model_types.h and listed in model_types.cc.
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

// A model's name without the prefix of its robot's name.
std::string NameOnRobot(const WorldDescription& world, RobotId robot, const std::string& name);

// Null for a type that does not exist. Valid for the program's life; any thread may call it.
const ModelType* FindModelType(std::string_view name);

// "found model type 'scot', expected the name of a define (chair, scout), or one of ...; did you mean 'scout'?"
std::string UnknownTypeMessage(const std::string& type, const std::map<std::string, Define>& defines);

// The model types, each defined in a file of its own, or beside its relatives.

ModelType ActuatorType();
ModelType BlinkenlightType();
ModelType BlobfinderType();
ModelType BumperType();
ModelType CameraType();
ModelType ContactType();
ModelType DoorType();
ModelType FiducialType();
ModelType GripperType();
ModelType ImuType();
ModelType LiftType();
ModelType LightIndicatorType();
ModelType PositionType();
ModelType RadioType();
ModelType RangerType();

// Bodies, without properties of their own.
ModelType PlainModelType();

// Properties that sensors of several kinds have in common.

// "90 degrees", or "1.5 radians" in a file of radians.
std::string AngleText(const Units& units, double radians);

// A side of the image of property `name`, in pixels, within the limits.
std::uint32_t ImageSide(PropertyReader& reader, std::string_view name, double found);

// `update_interval`, in ticks.
std::uint32_t ReadPeriod(PropertyReader& reader, std::int64_t interval_ns);

// `fov`, in rad, from 0 to 2 pi.
double ReadFov(PropertyReader& reader, double otherwise);

// `range [min max]`, in m.
Interval ReadRange(PropertyReader& reader, const Interval& otherwise);

// A length of at least 0, in m.
double ReadDistance(PropertyReader& reader, std::string_view name, double otherwise);

// An angle in rad, its size at most `max` rad.
double ReadAngle(PropertyReader& reader, std::string_view name, double otherwise, double max = 2.0 * kPi);

// Adds the sensor that the draft's model is to its robot; a sensor on no robot gets a warning that names it `noun`.
// Parameters that are out of bounds are an error at the model.
void AddSensor(PropertyReader& reader, const ModelDraft& draft, std::string_view noun, SensorParameters parameters,
               BuildContext& context);

}  // namespace troupe
