// Edits: changes of a world from outside the simulation, between two steps. Pure functions from a world and its state
// to another. Ids keep their meaning, except in an edit that is `fresh`: a spawned entity is appended, and a deleted
// one keeps its place as a model without a body. Errors are for people.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "troupe/event.h"
#include "troupe/result.h"
#include "troupe/world_state.h"

namespace troupe {

struct EditedWorld {
  std::shared_ptr<const Scene> scene;  // the one before, if the description is still the same
  WorldState state;
  std::vector<Event> events = {};  // of grippers that had to release
  bool fresh = false;              // the robots are made anew, as at the start
};

// The entity called `name`: a model without a parent that was not removed.
Result<ModelId> FindEntity(const WorldDescription& world, const std::string& name);

// Sets the pose of a robot, an object or a static model. The payload of a robot falls. The error is an unknown name, a
// pose that is not finite or beyond 1e6 m, or an obstacle at the pose.
Result<EditedWorld> SetPose(const std::shared_ptr<const Scene>& scene, const WorldState& state, const std::string& name,
                            const Pose& X_WE);

// Whether an entity can be moved and deleted. The error is one that is a part of a door or a lift, or has one.
Status CheckIsMovable(const WorldDescription& world, ModelId root);

// Removes an entity.
Result<EditedWorld> DeleteEntity(const std::shared_ptr<const Scene>& scene, const WorldState& state,
                                 const std::string& name);

// Adds the only entity of the world `spawned`, called `name`. The error is a name in use, a pose as in SetPose, or a
// world with another number of entities than one.
Result<EditedWorld> SpawnEntity(const std::shared_ptr<const Scene>& scene, const WorldState& state,
                                const WorldDescription& spawned, const std::string& name, const Pose& X_WE);

// A world with only the entity, as SpawnEntity adds it: the tree of `root` with its robot, joints, grippers and object,
// as the description has them. REQUIRES: `root` is an entity that was not removed.
WorldDescription ExtractEntity(const WorldDescription& world, ModelId root);

// The parts of a world that a reset concerns.
struct ResetScopes {
  bool time = true;     // back to tick 0
  bool state = true;    // initial poses, and the robots made anew
  bool spawned = true;  // spawned entities are removed
  bool deleted = true;  // deleted entities are restored; only with all the others
};

// `original`: the world as loaded.
EditedWorld ResetWorld(const std::shared_ptr<const Scene>& original, const std::shared_ptr<const Scene>& scene,
                       const WorldState& state, const ResetScopes& scopes);

}  // namespace troupe
