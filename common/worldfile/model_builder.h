// Turns the entities of a world tree into models and robots. Private to this folder.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/worldfile/build_context.h"
#include "common/worldfile/gripper_builder.h"
#include "common/worldfile/model_shape.h"
#include "common/worldfile/property_catalogue.h"

namespace troupe {

class ModelBuilder {
 public:
  explicit ModelBuilder(BuildContext& context) : context_(context) {}

  // Adds all models of the tree to the context's world, parents before children.
  void BuildTree();

 private:
  // What a model's children need to know of it.
  struct Parent {
    ModelId id;
    std::string name;
    std::string type;
    Pose X_WP;
    double stack_height = 0.0;     // m, added to the children's z
    std::optional<RobotId> robot;  // whose tree it belongs to
  };

  void BuildChildren(const Entity& entity, const Parent* parent);
  void BuildModel(const Entity& entity, const std::string& name, const Parent* parent);
  void ReadAppearance(PropertyReader& reader, const TypeDefaults& type, ModelDescription& model);
  RobotId AddRobot(PropertyReader& reader, const ModelDescription& model, ModelId id);
  void AddRanger(PropertyReader& reader, const Pose& origin, const ModelDescription& model, ModelId id,
                 std::optional<RobotId> robot);
  void AddActuator(PropertyReader& reader, const ModelDescription& model, ModelId id, std::optional<RobotId> robot);
  std::optional<GripperSettings> ReadGripperOf(PropertyReader& reader, const Size& size, const Pose& X_WM,
                                               std::optional<RobotId> robot);
  void AddGripper(const Entity& entity, GripperSettings settings, const Size& size, const Pose& origin, ModelId id,
                  RobotId robot);
  Shape ReadShape(PropertyReader& reader, TypeDefaults type, const std::optional<RosMap>& map, const Size& size,
                  const Pose& origin, const std::optional<GripperSettings>& gripper);
  void CheckName(const Entity& entity, const std::string& name);
  void WarnIfNotSimulated(const Entity& entity, const TypeDefaults& type);
  void WarnIfSeenButNotHit(PropertyReader& reader, const ModelDescription& model);

  BuildContext& context_;
  std::vector<GripperDraft> grippers_;
  std::map<std::string, SourceLocation> names_;  // and where each was given
  std::set<std::string> warned_types_;           // types and macros already said not to be simulated
};

}  // namespace troupe
