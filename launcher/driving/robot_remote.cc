#include "launcher/driving/robot_remote.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "transport/dds/tools/control_client.h"

namespace troupe {
namespace {

constexpr double kReplySeconds = 10.0;
constexpr double kDiscoverySeconds = 5.0;
constexpr double kMeasureSeconds = 0.3;

}  // namespace

Result<RobotRemote> RobotRemote::Connect(const NetworkSettings& network, const std::string& robot) {
  auto client = std::make_unique<ControlClient>(network);
  if (Status missing = client->WaitForService(kDiscoverySeconds); !missing.ok()) return missing.error();
  RobotRemote remote(std::move(client), robot);
  const Result<ControlReply> reply = remote.Ask();
  if (!reply.ok()) return reply.error();
  if (reply.value().entities.front().kind != EntityKind::kRobot) return Failure("'" + robot + "' is no robot");
  return remote;
}

RobotRemote::RobotRemote(std::unique_ptr<ControlClient> client, std::string robot)
    : client_(std::move(client)), robot_(std::move(robot)), measured_at_(Clock::now()) {}
RobotRemote::RobotRemote(RobotRemote&& other) noexcept = default;
RobotRemote::~RobotRemote() = default;

Result<ControlReply> RobotRemote::Ask() {
  ControlRequest request;
  request.command = ControlCommand::kEntities;
  request.name = robot_;
  Result<ControlReply> reply = Call(request);
  if (reply.ok() && reply.value().entities.size() != 1) return Failure("the world has no robot '" + robot_ + "'");
  return reply;
}

Result<ControlReply> RobotRemote::Send(const RobotCommand& command, std::uint64_t ticks) {
  ControlRequest request;
  request.command = ControlCommand::kCommandRobot;
  request.name = robot_;
  request.ticks = std::clamp<std::uint64_t>(ticks, 1, kMostCommandTicks);
  request.robot_command = command;
  return Call(request);
}

Result<ControlReply> RobotRemote::Call(const ControlRequest& request) {
  Result<ControlReply> reply = client_->Call(request, kReplySeconds);
  if (!reply.ok()) return reply;
  if (!reply.value().done) return Failure(reply.value().problem);
  if (reply.value().state == RunState::kOver) return Failure("the run is over");
  NoteTick(reply.value().tick);
  return reply;
}

void RobotRemote::NoteTick(Tick tick) {
  const Clock::time_point now = Clock::now();
  const double passed = std::chrono::duration<double>(now - measured_at_).count();
  if (measured_tick_ != 0 && passed < kMeasureSeconds && tick >= measured_tick_) return;
  if (measured_tick_ != 0 && tick >= measured_tick_) {
    ticks_per_second_ = static_cast<double>(tick - measured_tick_) / passed;
  }
  measured_tick_ = std::max<Tick>(tick, 1);
  measured_at_ = now;
}

std::uint64_t RobotRemote::TicksIn(double seconds) const {
  const double ticks = std::ceil(seconds * ticks_per_second_);
  return static_cast<std::uint64_t>(std::clamp(ticks, 2.0, static_cast<double>(kMostCommandTicks)));
}

}  // namespace troupe
