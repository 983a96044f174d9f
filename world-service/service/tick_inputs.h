// The inputs of the next tick: proposals of agents, and commands from outside of the simulation.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "transport/protocol/messages.h"
#include "troupe/robot_command.h"
#include "troupe/world_description.h"
#include "world-service/service/membership.h"
#include "worldfile/load_world.h"

namespace troupe {

struct Rejection {
  std::optional<RobotId> robot;
  std::string reason;
};

// The proposals that enter the next step, all of them valid.
class ProposalCollector {
 public:
  // REQUIRES: the world outlives the collector, or the next ChangeWorld.
  ProposalCollector(const WorldDescription& world, Mode mode);

  // An edit has changed the world or its state: all proposals are dropped.
  void ChangeWorld(const WorldDescription& world);

  // Collects the valid proposals of a member's first message for `message.tick`; returns the others. The result is
  // valid until the next call. REQUIRES: robots' states in `state` are those that the tick starts from.
  std::span<const Rejection> Collect(const Member& member, const ProposalMessage& message, const WorldState& state);

  // The proposals for the step from `state` to the next tick, in robot-id order; valid until the next call. In realtime
  // mode, a robot without a proposal for that tick keeps the one for the tick before.
  std::span<const Proposal> ForStep(const WorldState& state);

 private:
  struct Newest {
    Proposal proposal;
    Tick tick = 0;  // that it is for; 0: none yet
  };

  const WorldDescription* world_;
  const Mode mode_;
  std::vector<Newest> newest_;  // by robot
  // Members for their memory only.
  std::vector<Proposal> for_step_;
  std::vector<Rejection> rejections_;
};

// A part of a command that is in force. Beside the class, because clang 14 cannot compile it inside.
template <typename Value>
struct Timed {
  Value value;
  std::uint64_t ticks = 0;  // left
  bool sent = false;        // to the agents, for the next tick
};

// The commands to robots from outside of the simulation (tools, viewers), each in force for a number of ticks. A
// command replaces the one before of the same kind: motion, each gripper, goal.
class RobotCommands {
 public:
  // Goals are numbered from the one after `last_goal` on: the robots of a run that is continued know other numbers.
  explicit RobotCommands(std::uint32_t last_goal = 0) : goals_(last_goal) {}

  // For the next `ticks` ticks. A goal without waypoints cancels the goal.
  // REQUIRES: CheckRobotCommand succeeded, but for that.
  void Add(const RobotCommand& command, std::uint64_t ticks);

  // Those for the next tick, in robot-id order, of robots that the world has.
  std::vector<RobotCommand> ForNextTick(const WorldDescription& world);
  // Those that ForNextTick returned last and that are still in force.
  std::vector<RobotCommand> Sent() const;
  // The tick for which ForNextTick was called last was stepped.
  void Elapse();

  void Clear() { robots_.clear(); }

  // All of them, and the same for a service that continues the run.
  std::vector<CommandInForce> InForce() const;
  void Restore(const std::vector<CommandInForce>& commands);

 private:
  struct OfRobot {
    std::optional<Timed<Twist>> twist;
    std::map<std::size_t, Timed<GripperOrder>> grippers;
    std::optional<Timed<Goal>> goal;
    bool empty() const { return !twist && grippers.empty() && !goal; }
  };
  std::map<RobotId, OfRobot> robots_;
  std::uint32_t goals_;  // numbers them
};

}  // namespace troupe
