// Edits of a world by control requests: pure functions, so that a recorded edit can be applied again.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/protocol/messages.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "world-service/core/edit_world.h"
#include "world-service/service/membership.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// Reset, load, spawn, delete, set pose, rewind, change: what makes a new edition of the world or its state, in a pause.
bool IsEdit(ControlCommand command);

// Set twist, door, lift: what enters the next step, without a pause.
bool IsInput(ControlCommand command);

// The input that a request asks for, valid in the world. The error names what is unknown or out of range, for people.
// REQUIRES: IsInput.
Result<Input> InputOf(const Scene& scene, const ControlRequest& request);

// `original`: the scene that a reset restores, the newest that was loaded. The error is the reason why the edit
// cannot be applied: an unknown name, an obstacle, bad scopes. REQUIRES: the command is an edit; `edit.world` is null
// or as in AppliedEdit; `state` belongs to `scene`.
Result<EditedWorld> ApplyEdit(const AppliedEdit& edit, const std::shared_ptr<const Scene>& original,
                              const std::shared_ptr<const Scene>& scene, const WorldState& state);

// kChange: another seed and other controllers for a run that continues from a recording.
struct WorldChanges {
  std::optional<std::uint64_t> seed = {};
  std::map<std::string, ControllerDescription> controllers = {};  // by robot

  bool any() const { return seed.has_value() || !controllers.empty(); }
  // The world with the changes of the robots that it has.
  WorldDescription AppliedTo(WorldDescription world) const;

  // As the source of a ControlRequest: a JSON object.
  std::string ToText() const;
  static Result<WorldChanges> FromText(const std::string& text);
};

// The entities of a world, for tools that edit it.

// All entities that were not removed, in the order of their ids, with their poses in `state`.
std::vector<EntityReport> ListEntities(const WorldDescription& world, const WorldState& state);

// Sets the agents of those that are robots.
void SetAgents(const WorldDescription& world, const Membership& members, std::vector<EntityReport>& entities);

// "base", or "base0", "base1", ...: the first that is free.
std::string FreeName(const WorldDescription& world, const std::string& base);

// Sets the box of each of `entities`, which are of the world. REQUIRES: the state belongs to the world.
void SetBoxes(const WorldDescription& world, const WorldState& state, std::vector<EntityReport>& entities);

}  // namespace troupe
