// Edits of a world by control requests: pure functions of (request, scene, state), without clock, files or members.
//
// They are pure because an edit is made three times in the life of a run: by the service that executes the request, by
// `troupe replay` that verifies its recording, and by a service that continues the run after the death of the one
// before. All three must obtain the same edition bit by bit. So whatever an edit depends on beyond the state (the text
// of a world file, the name chosen for a spawned entity, a free ROS domain) is resolved before, and recorded with the
// request.
//
// Three kinds of commands: an edit makes a new edition of the world or its state, and needs a quiescent pause; an input
// enters the next step and needs no pause; the others (status, play, speed, lists) change no state at all.
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

// The input that a request asks for, valid in the world. The error names what is unknown or out of range, for users.
// REQUIRES: it is of kind kInput.
// The request names things as users do, by names; the input has ids, so that the step looks up nothing.
Result<Input> InputOf(const Scene& scene, const control::Request& request);

// `original`: the scene that a reset restores, the newest that was loaded. The error is the reason why the edit
// cannot be applied: an unknown name, an obstacle, or the request is no edit. REQUIRES: `edit.world` is null
// or as in AppliedEdit; `state` belongs to `scene`.
Result<EditedWorld> ApplyEdit(const AppliedEdit& edit, const std::shared_ptr<const Scene>& original,
                              const std::shared_ptr<const Scene>& scene, const WorldState& state);

// Change: another seed and other controllers for a run that continues from a recording. Not accepted from tools during
// a run (RunControl): it is the first edit of a branch, so that the branch's own recording replays without the command
// line with which it was started.
struct WorldChanges {
  std::optional<std::uint64_t> seed = {};
  std::map<std::string, ControllerDescription> controllers = {};  // by robot

  bool any() const { return seed.has_value() || !controllers.empty(); }
  // The world with the changes of the robots that it has.
  WorldDescription AppliedTo(WorldDescription world) const;

  // As in control::Change: a JSON object.
  // Parameters of controllers remain text inside it: only the controller knows their form.
  std::string ToText() const;
  static Result<WorldChanges> FromText(const std::string& text);
};

// The entities of a world, for tools that edit it.

// All entities that were not removed, in the order of their ids, with their poses in `state`.
// Entities are root models: children and links are parts of one. Removed models keep their ids, so that ids in events
// and recordings stay valid, but are not listed.
std::vector<EntityReport> ListEntities(const WorldDescription& world, const WorldState& state);

// Sets the agent of each entity that is a robot with a member.
void SetAgents(const WorldDescription& world, const Membership& members, std::vector<EntityReport>& entities);

// Sets the signals of an entity: of each row of a table of the state that is the entity, and not a part of it.
void SetSignals(const WorldDescription& world, const WorldState& state, EntityReport& entity);

// Adds the newest state of a vehicle of VDA 5050 to its signals, as it has sent it: a line "vehicle {...}".
void SetVehicle(const std::string& sent, EntityReport& entity);

// Adds the last words of a robot's controller to its signals: a line "said {"tick":N,"text":"..."}".
void SetSaid(const Event& said, EntityReport& entity);

// Sets the box of each of `entities`, which are of the world. REQUIRES: the state belongs to the world.
// A box is in the frame E of its entity, over all its models; an entity without a shape has an empty box at its origin.
// Costs one pass over all models, so a request has to ask for it.
void SetBoxes(const WorldDescription& world, const WorldState& state, std::vector<EntityReport>& entities);

}  // namespace troupe
