// Step: the simulation. A pure function from a state and the robots' proposals to the next state and the ordered
// events. Start here to understand Troupe.
//
// Robots act one after another, in an order that is a fixed function of the tick; each sees the new poses of its
// predecessors. A robot releases the object from which its fingers open, moves its base along the exact arc of its
// twist until its first contact, moves its joints one by one, and grips the object on which its fingers close. Its
// payload (the objects that it holds, and the stacks on them and on it) moves and collides with it. Then doors and
// lifts follow their orders, tools' orders first, and move until a body is in their way, objects without support fall,
// people walk (people.h), the robots' radio messages are on their way, and energy is consumed and exchanged. A robot
// without energy has no proposal. A motion cut short by a contact ends at the contact; its stall or blocked flag is set
// and its velocity is zero.
//
// The order within a tick is part of the definition of the simulation, as the golden hashes fix it. Robots before doors
// and lifts: a door never hits a robot that leaves in the same tick. Gravity after all of these: it sees the final
// places of supports. People after that: they see where everything is, and are the last to move. Radio, energy, devices
// and the twists of tools change nothing that moves.
//
// Determinism: every loop is in the order of ids or of a function of the tick; sums of floating-point numbers have a
// fixed order; random numbers are functions of (seed, id, tick); trigonometry is troupe/deterministic_math.h. So the
// next state is the same to the last bit for any number of threads, on every processor, and after any snapshot.
// docs/determinism.md has the rules.
//
// Cost: linear in the robots, objects and people that move, with searches of neighbours in spatial indices. A Step
// copies the state once.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/thread_pool.h"
#include "common/model/proposal.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/event.h"
#include "troupe/result.h"
#include "troupe/world_state.h"
#include "world-service/core/islands.h"

namespace troupe {

struct StepResult {
  WorldState state;
  std::vector<Event> events;  // of robots in robot-id order, then of objects, then of doors, lifts and people
};

// `inputs`: orders of tools; orders of a kind are executed in their sequence, before the orders of robots; a twist
// is set at the end of the tick. REQUIRES: `state` is InitialState of the scene, or the result of a step or an edit; it
// belongs to the scene's world; `proposals` are in robot-id order, at most one for each robot, and valid; so are
// `inputs` (check_order.h). A robot without a proposal stands still.
StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals,
                std::span<const Input> inputs = {});

// The same, for one tick after another: `bodies`, an index of the scene, is updated only by the bodies that have moved
// since the last step. Neither it nor the threads of `people_pool`, which may be null, change anything in the result.
StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals, BodyIndex& bodies,
                ThreadPool* people_pool = nullptr, std::span<const Input> inputs = {});

// The steps of one world, by several threads: islands of robots (islands.h) act at the same time, and people find their
// velocities. The result is that of Step, bit for bit.
// Not for several threads at a time: it keeps an index of bodies for each thread of its pool between ticks.
class Stepper {
 public:
  // With fewer robots, a step takes less time than to wake a thread.
  static constexpr std::size_t kMinRobots = 32;
  static constexpr std::size_t kMinPeople = 48;

  // `pool` may be null: one thread. REQUIRES: the scene outlives the stepper.
  explicit Stepper(const Scene& scene, std::shared_ptr<ThreadPool> pool = {}, std::size_t fewest_robots = kMinRobots);

  // REQUIRES: as above.
  StepResult Step(const WorldState& state, std::span<const Proposal> proposals, std::span<const Input> inputs = {});

 private:
  const Scene& scene_;
  const std::shared_ptr<ThreadPool> pool_;         // of islands; null: one thread
  const std::shared_ptr<ThreadPool> people_pool_;  // of people; null: one thread
  std::vector<BodyIndex> indices_;                 // one for each thread
  Islands islands_;
};

// The state that a run begins with.
// Tick 0: all models at their poses in the description, objects on a support at rest on it. An object in the air
// stays there until a contact.
WorldState InitialState(const Scene& scene);

// The version of the step: a recording can be stepped again only by programs with the same one.
// Changes with every change of Step or of an edit that gives another result for the same input, as the golden hashes
// do.
// Recordings keep it.
inline constexpr std::uint32_t kStepVersion = 7;

// Validates proposals from the network before they enter a step.
// Success if the proposal is for an existing robot, finite, and within the declared bounds of its drive (velocity and,
// from the velocity that it has in `state`, acceleration), of its joints, its radios and its orders. The error is for
// an event.
Status ValidateProposal(const Scene& scene, const WorldState& state, const Proposal& proposal);

}  // namespace troupe
