// Edits: changes of a world from outside the simulation, between two steps. Pure functions from a scene and a state to
// others: nothing is changed in place, so that a failed edit leaves the run as it was, and a recording of the edit
// gives the same result again.
//
// Ids keep their meaning: a spawned entity is appended behind all others, and a deleted one keeps its place as a model
// without a body, whose name is free. So states, orders and recordings from before an edit stay valid after it. The
// exception is an edit that is `fresh`: a reset may restore the world as loaded, with its shorter lists.
//
// Cost: SetPose of a robot, an object or a person makes only a new state. All else makes a new Scene with its indices,
// which takes as long as loading the world without reading its files.
//
// The code of an error is kNoRoom where the place is taken by the ground or an obstacle, so that a caller can try
// another pose, and kBadInput for all else. The texts of errors are shown to users.
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

// The result of an edit: the scene and the state that belongs to it. The tick is that before the edit, except after a
// reset of the time.
struct EditedWorld {
  std::shared_ptr<const Scene> scene;  // the previous one, if the description is still the same
  WorldState state;
  std::vector<Event> events = {};  // of grippers that had to release
  bool fresh = false;              // the robots start again: controllers, odometry and readings
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

// "base", or "base0", "base1", ...: the first that no model has.
std::string FreeName(const WorldDescription& world, const std::string& base);
// "scout" of "scout", "robots/scout.inc" or "robots.inc#scout": the base of the name of an entity that is spawned from
// there.
std::string NameOfSource(const std::string& source);

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
  bool state = true;    // initial poses; the robots start again
  bool spawned = true;  // spawned entities are removed
  bool deleted = true;  // deleted entities are restored; only with all the others
};

// `original`: the world as loaded.
EditedWorld ResetWorld(const std::shared_ptr<const Scene>& original, const std::shared_ptr<const Scene>& scene,
                       const WorldState& state, const ResetScopes& scopes);

}  // namespace troupe
