#include "world-service/core/step.h"

#include <optional>

#include "common/base/check.h"
#include "common/spatial/robot_index.h"
#include "common/spatial/sweep.h"

namespace troupe {
namespace {

// The twist proposed for each robot, by id; nothing for a robot without a proposal.
std::vector<std::optional<Twist>> TwistByRobot(std::size_t robots, std::span<const Proposal> proposals) {
  std::vector<std::optional<Twist>> twists(robots);
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    TROUPE_CHECK(proposals[i].robot.index() < robots);
    TROUPE_CHECK(i == 0 || proposals[i - 1].robot < proposals[i].robot);
    twists[proposals[i].robot.index()] = proposals[i].twist;
  }
  return twists;
}

// Moves one robot as far as it gets; returns the contact that cut its motion short.
std::optional<Contact> MoveRobot(const Scene& scene, const RobotIndex& index, RobotId id, const Twist& twist,
                                 RobotState& robot) {
  const double duration = scene.world().interval_seconds();
  const std::optional<Contact> contact = FirstContact(scene, index, id, robot.X_WR, twist, duration);
  const double moved_for = contact ? contact->time : duration;
  if (moved_for > 0.0) robot.X_WR = robot.X_WR * Integrate(twist, moved_for);
  robot.twist = contact ? Twist{} : twist;
  robot.stalled = contact.has_value();
  return contact;
}

}  // namespace

StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals) {
  const std::size_t count = state.robots.size();
  TROUPE_CHECK(count == scene.world().robots.size());
  const std::vector<std::optional<Twist>> twists = TwistByRobot(count, proposals);

  StepResult result{.state = state, .events = {}};
  WorldState& next = result.state;
  next.tick = state.tick + 1;
  RobotIndex index(scene);
  index.Assign(state);
  std::vector<std::optional<Contact>> contacts(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = (next.tick + k) % count;  // so that no robot always goes first
    RobotState& robot = next.robots[i];
    if (!twists[i] || twists[i]->IsZero()) {
      robot.twist = {};
      if (twists[i]) robot.stalled = false;  // who does not want to move is not held up
      continue;
    }
    contacts[i] = MoveRobot(scene, index, RobotId(i), *twists[i], robot);
    index.Move(RobotId(i), robot.X_WR);
  }

  for (std::size_t i = 0; i < count; ++i) {
    const bool before = state.robots[i].stalled;
    const bool now = next.robots[i].stalled;
    if (before == now) continue;
    result.events.push_back({.tick = next.tick,
                             .type = now ? EventType::kStallBegan : EventType::kStallEnded,
                             .robot = RobotId(i),
                             .other = now ? contacts[i]->other : std::nullopt,
                             .detail = ""});
  }
  return result;
}

}  // namespace troupe
