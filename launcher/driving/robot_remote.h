// RobotRemote: commands from a tool to one robot of a run, and its pose.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "common/run/network_settings.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"

namespace troupe {

class ControlClient;

class RobotRemote {
 public:
  // Of the session `network.session`. The error: it was not found, or has no such robot. Throws as ControlClient.
  static Result<RobotRemote> Connect(const NetworkSettings& network, const std::string& robot);
  RobotRemote(RobotRemote&& other) noexcept;
  ~RobotRemote();

  // The state of the run and, as its only entity, the robot. The error: the service is gone or does not answer, or the
  // robot does not exist any more.
  Result<ControlReply> Ask();

  // Gives the robot a command for `ticks` ticks. The error: as above, or a refusal.
  Result<ControlReply> Send(const RobotCommand& command, std::uint64_t ticks);

  // The number of ticks that pass in `seconds` s of wall time, by the ticks of the replies so far; at least 2.
  std::uint64_t TicksIn(double seconds) const;

 private:
  using Clock = std::chrono::steady_clock;

  RobotRemote(std::unique_ptr<ControlClient> client, std::string robot);
  Result<ControlReply> Call(const ControlRequest& request);
  void NoteTick(Tick tick);

  std::unique_ptr<ControlClient> client_;
  std::string robot_;
  Tick measured_tick_ = 0;  // at the begin of the present measurement
  Clock::time_point measured_at_;
  double ticks_per_second_ = 10.0;
};

}  // namespace troupe
