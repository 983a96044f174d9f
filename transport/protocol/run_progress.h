// RunProgress: the state of a run beside its world. It does not travel: the service gives it to its observers, and the
// recorder writes it to the journal, for a service that continues the run.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "transport/protocol/messages.h"
#include "troupe/ids.h"
#include "troupe/order.h"
#include "troupe/robot_command.h"

namespace troupe {

// A command of a tool to a robot that is in force: one part, a twist, an order to a gripper or a goal.
struct CommandInForce {
  RobotCommand command;
  std::uint64_t ticks = 0;  // left
  bool sent = false;        // to the agents, for the next tick
  bool operator==(const CommandInForce&) const = default;
};

struct RunProgress {
  Incarnation incarnation = 0;                  // of the service that wrote it
  std::optional<std::uint64_t> ticks_to_pause;  // 0 in a pause; nothing: the run plays
  std::vector<RobotId> absent;                  // robots whose agents are lost, ascending
  std::vector<RobotId> newcomers;               // robots of the newest edit that have no agent yet
  std::uint64_t stalls = 0;                     // so far, for the summary
  std::uint64_t rejected = 0;
  std::set<std::string> frozen = {};  // names of the robots that have stood still without an agent
  bool speed_is_set = false;          // during the run, to:
  std::optional<double> speed = {};   // a multiple of real time; nothing: no pacing
  std::vector<CommandInForce> commands = {};
  std::vector<Input> inputs = {};  // that enter the next step, in the sequence of their arrival
  // Of the state that the run began with: its journal has the earlier states, too, if it continues another run.
  std::uint64_t first_number = 0;
  // The newest ticks are those of a rewind that has not ended: the other members, without commands and inputs, are of
  // the state before it.
  bool is_rewinding = false;
  bool operator==(const RunProgress&) const = default;
};

}  // namespace troupe
