#include "world-service/service/tick_inputs.h"

#include <iterator>
#include <utility>

#include "world-service/core/step.h"

namespace troupe {

ProposalCollector::ProposalCollector(const Scene& scene, Mode mode)
    : scene_(&scene), mode_(mode), newest_(scene.world().robots.size()) {}

void ProposalCollector::ChangeWorld(const Scene& scene) {
  scene_ = &scene;
  newest_.assign(scene.world().robots.size(), {});
  copies_.clear();
  tick_ = 0;
  kept_.clear();
  only_ = nullptr;
}

std::span<const Rejection> ProposalCollector::Collect(const Member& member, const ProposalMessage& message,
                                                      const WorldState& state, const SharedProposal& shared) {
  rejections_.clear();
  // The first message of a tick releases the messages of the previous tick, to which no proposal of a step refers any
  // more.
  if (std::exchange(tick_, message.tick) != message.tick) {
    kept_.clear();
    messages_ = 0;
  }
  // In realtime mode a proposal may be used a tick later, when its message is gone: there it is copied.
  const bool keeps = shared != nullptr && mode_ == Mode::kLockstep;
  ++messages_;
  if (keeps) {
    kept_.push_back(shared);
  } else {
    copies_.resize(newest_.size());
  }
  // Both are in robot-id order, so that one pass finds missing and surplus proposals.
  auto proposal = message.proposals.begin();
  const auto end = message.proposals.end();
  const auto reject_surplus = [&] {
    const bool known = proposal->robot.index() < newest_.size();
    rejections_.push_back({known ? std::optional(proposal->robot) : std::nullopt,
                           "robot " + std::to_string(proposal->robot.index()) + " in a message of " + Describe(member) +
                               " is not one of its robots, or is repeated or out of order"});
    ++proposal;
  };
  for (RobotId robot : member.robots) {
    while (proposal != end && proposal->robot < robot) reject_surplus();
    if (proposal == end || proposal->robot != robot) {
      rejections_.push_back({robot, "the message of " + Describe(member) + " has no proposal for it"});
      continue;
    }
    if (const Status valid = ValidateProposal(*scene_, state, *proposal); valid.ok()) {
      if (!keeps) copies_[robot.index()] = *proposal;
      newest_[robot.index()] = {keeps ? &*proposal : &copies_[robot.index()], message.tick};
    } else {
      rejections_.push_back({robot, valid.error().message});
    }
    ++proposal;
  }
  while (proposal != end) reject_surplus();
  // All robots in one message, all valid: the step reads the message itself, and nothing is gathered.
  only_ = keeps && messages_ == 1 && rejections_.empty() ? &message : nullptr;
  return rejections_;
}

std::span<const Proposal> ProposalCollector::ForStep(const WorldState& state) {
  const Tick next = state.tick + 1;
  if (only_ != nullptr && tick_ == next) return only_->proposals;
  for_step_.clear();
  for (const Newest& newest : newest_) {
    const bool in_time = newest.tick == next;
    // A proposal within the limits of a tick ago need not be now: the robot may have stalled.
    const bool kept = mode_ == Mode::kRealtime && newest.tick != 0 && newest.tick + 1 == next;
    if (in_time || (kept && ValidateProposal(*scene_, state, *newest.proposal).ok())) {
      for_step_.push_back(*newest.proposal);
      if (!in_time) for_step_.back().messages.clear();  // they were sent in the tick before
    }
  }
  return for_step_;
}

void RobotCommands::Add(const RobotCommand& command, std::uint64_t ticks) {
  OfRobot& robot = robots_[command.robot];
  if (command.twist) robot.twist = Timed<Twist>{*command.twist, ticks};
  for (const GripperOrder& order : command.grippers) {
    Timed<GripperOrder>& timed = robot.grippers[order.gripper];
    GripperOrder merged = order;  // fingers and lift are distinct
    if (!merged.opening) merged.opening = timed.value.opening;
    if (!merged.lift) merged.lift = timed.value.lift;
    timed = Timed<GripperOrder>{merged, ticks};
  }
  if (command.goal) {
    robot.goal.reset();
    if (!command.goal->waypoints.empty()) {
      robot.goal = Timed<Goal>{*command.goal, ticks};
      robot.goal->value.number = ++goals_;
    }
  }
  for (const FleetMessage& message : command.messages) robot.messages.push_back({message, 1});
  if (robot.empty()) robots_.erase(command.robot);
}

std::vector<RobotCommand> RobotCommands::ForNextTick(const WorldDescription& world) {
  // An edit may have removed robots since the command was given.
  std::erase_if(robots_, [&](const auto& entry) {
    return entry.first.index() >= world.robots.size() || !RobotExists(world, entry.first);
  });
  for (auto& [robot, of_robot] : robots_) {
    if (of_robot.twist) of_robot.twist->sent = true;
    for (auto& [gripper, timed] : of_robot.grippers) timed.sent = true;
    if (of_robot.goal) of_robot.goal->sent = true;
    const std::size_t most = std::min(of_robot.messages.size(), kMaxFleetMessages);
    for (std::size_t i = 0; i < most; ++i) of_robot.messages[i].sent = true;
  }
  return Sent();
}

std::vector<RobotCommand> RobotCommands::Sent() const {
  std::vector<RobotCommand> commands;
  for (const auto& [robot, of_robot] : robots_) {
    RobotCommand command{.robot = robot};
    if (of_robot.twist && of_robot.twist->sent) command.twist = of_robot.twist->value;
    for (const auto& [gripper, timed] : of_robot.grippers) {
      if (timed.sent) command.grippers.push_back(timed.value);
    }
    if (of_robot.goal && of_robot.goal->sent) command.goal = of_robot.goal->value;
    for (const Timed<FleetMessage>& message : of_robot.messages) {
      if (message.sent) command.messages.push_back(message.value);
    }
    const bool is_empty = !command.twist && command.grippers.empty() && !command.goal && command.messages.empty();
    if (!is_empty) commands.push_back(std::move(command));
  }
  return commands;
}

std::vector<CommandInForce> RobotCommands::InForce() const {
  std::vector<CommandInForce> commands;
  for (const auto& [robot, of_robot] : robots_) {
    const auto add = [&commands, robot = robot](const auto& timed) -> RobotCommand& {
      // One entry for each part, because each has its own rest of ticks.
      return commands.emplace_back(CommandInForce{{.robot = robot}, timed.ticks, timed.sent}).command;
    };
    if (of_robot.twist) add(*of_robot.twist).twist = of_robot.twist->value;
    for (const auto& [gripper, timed] : of_robot.grippers) add(timed).grippers = {timed.value};
    if (of_robot.goal) add(*of_robot.goal).goal = of_robot.goal->value;
    for (const Timed<FleetMessage>& message : of_robot.messages) add(message).messages = {message.value};
  }
  return commands;
}

void RobotCommands::Restore(const std::vector<CommandInForce>& commands) {
  for (const CommandInForce& in_force : commands) {
    const RobotCommand& command = in_force.command;
    OfRobot& robot = robots_[command.robot];
    if (command.twist) robot.twist = Timed<Twist>{*command.twist, in_force.ticks, in_force.sent};
    for (const GripperOrder& order : command.grippers) {
      robot.grippers[order.gripper] = Timed<GripperOrder>{order, in_force.ticks, in_force.sent};
    }
    if (command.goal) robot.goal = Timed<Goal>{*command.goal, in_force.ticks, in_force.sent};
    for (const FleetMessage& message : command.messages) {
      robot.messages.push_back({message, in_force.ticks, in_force.sent});
    }
  }
}

void RobotCommands::Elapse() {
  // A command that was not sent yet, as in a pause, loses none of its ticks.
  const auto expires = [](auto& timed) { return timed.sent && --timed.ticks == 0; };
  for (auto& [robot, of_robot] : robots_) {
    if (of_robot.twist && expires(*of_robot.twist)) of_robot.twist.reset();
    for (auto entry = of_robot.grippers.begin(); entry != of_robot.grippers.end();) {
      entry = expires(entry->second) ? of_robot.grippers.erase(entry) : std::next(entry);
    }
    if (of_robot.goal && expires(*of_robot.goal)) of_robot.goal.reset();
    std::erase_if(of_robot.messages, expires);
  }
  std::erase_if(robots_, [](const auto& entry) { return entry.second.empty(); });
}

}  // namespace troupe
