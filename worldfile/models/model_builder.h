// ModelBuilder: turns the nodes of a world tree into models. The properties that all models have are read here; the
// reader of the model's type adds the rest. Private to this folder.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "worldfile/models/properties/build_context.h"
#include "worldfile/models/types/model_type.h"

namespace troupe {

class ModelBuilder {
 public:
  // The context must outlive the builder.
  explicit ModelBuilder(BuildContext& context) : context_(context) {}

  // Adds all models of the tree to the context's world, parents before children. REQUIRES: called once.
  void BuildTree();

  // The models that have a parent in the file, but none in the world, with the parent in the file.
  const std::map<ModelId, ModelId>& placed_alone() const { return placed_alone_; }

 private:
  // The facts about a model that its children depend on.
  struct Parent {
    ModelId id;
    std::string name;
    const ModelType& type;
    Pose X_WP;
    double stack_height = 0.0;     // m, added to the children's z
    std::optional<RobotId> robot;  // the robot that it belongs to
    bool moves = false;            // belongs to a robot or a movable object
  };

  void BuildChildren(const WorldNode& node, const Parent* parent);
  void BuildModel(const WorldNode& node, const std::string& wanted_name, const Parent* parent);
  void FailForUnknownType(const WorldNode& node);
  // Nothing if the model is too far away, which is then reported.
  std::optional<ModelDraft> StartDraft(PropertyReader& reader, const ModelType& type, const std::string& name,
                                       const Parent* parent);
  void PlaceInTree(PropertyReader& reader, const Parent* parent, const Pose& X_PM, ModelDraft& draft);
  // Whether the model belongs to a robot or a movable object.
  bool Moves(const ModelDraft& draft, const Parent* parent) const;

  BuildContext& context_;
  std::vector<std::unique_ptr<ModelReader>> readers_;  // of the models so far, in their order
  std::map<ModelId, ModelId> placed_alone_;
};

}  // namespace troupe
