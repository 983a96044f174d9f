// Edits: changes of a world from outside the simulation, between two steps. Pure functions from a world and its state to
// another. Ids stay what they are, but in an edit that is `fresh`: what is spawned comes last, and what is deleted keeps
// its place as a model without a body. Errors are for people.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/model/event.h"
#include "common/model/world_state.h"
#include "common/spatial/scene.h"

namespace troupe {

struct EditedWorld {
  std::shared_ptr<const Scene> scene;  // the one before, if the description is still the same
  WorldState state;
  std::vector<Event> events = {};  // of grippers that had to let go
  bool fresh = false;              // the robots begin anew, as at the start
};

// The entity called `name`: a model without a parent that was not removed. The error says what there is instead.
Result<ModelId> FindEntity(const WorldDescription& world, const std::string& name);

// Puts a robot, an object or a model that stands still somewhere else. What a robot held, and what stood on it, falls.
// The error is an unknown name, a pose that is not finite, or an obstacle that is there already.
Result<EditedWorld> SetPose(const std::shared_ptr<const Scene>& scene, const WorldState& state,
                            const std::string& name, const Pose& X_WE);

// Takes an entity away.
Result<EditedWorld> DeleteEntity(const std::shared_ptr<const Scene>& scene, const WorldState& state,
                                 const std::string& name);

// Adds the only entity of the world `spawned`, called `name`. The error is a name that is taken, a pose as in SetPose,
// or a world that has another number of entities than one.
Result<EditedWorld> SpawnEntity(const std::shared_ptr<const Scene>& scene, const WorldState& state,
                                const WorldDescription& spawned, const std::string& name, const Pose& X_WE);

// What a reset concerns.
struct ResetScopes {
  bool time = true;     // back to tick 0
  bool state = true;    // everything where it was at first, and the robots anew
  bool spawned = true;  // what was spawned goes
  bool deleted = true;  // what was deleted comes back; only with all the others
};

// `original`: the world as loaded.
EditedWorld ResetWorld(const std::shared_ptr<const Scene>& original, const std::shared_ptr<const Scene>& scene,
                       const WorldState& state, const ResetScopes& scopes);

}  // namespace troupe
