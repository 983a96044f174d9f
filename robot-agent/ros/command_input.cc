#include "robot-agent/ros/command_input.h"

#include <fmt/format.h>

#include "robot-agent/drive/drive.h"
#include "ros/connection/ros_qos.h"

namespace troupe {
namespace {

constexpr const char* kTopic = "cmd_vel";

}  // namespace

template <typename T>
void CommandInput::Readers<T>::Open(const ros::RosNode& node, bool reliable_only) {
  node_ = node;
  reliable_ = std::make_unique<ros::RosReader<T>>(node, kTopic, ros::Commands(true),
                                                  reliable_only ? ros::Part::kOnlyReader : ros::Part::kReliableReader);
}

template <typename T>
void CommandInput::Readers<T>::OpenMissing() {
  if (!reliable_ || best_effort_ || !reliable_->missed_writer()) return;
  best_effort_ = std::make_unique<ros::RosReader<T>>(node_, kTopic, ros::Commands(false), ros::Part::kBestEffortReader);
  node_.connection->Announce();
}

CommandInput::CommandInput(const ros::RosNode& node, const ros::RobotTopics& topics, const RobotDescription& robot,
                           double interval_seconds)
    : robot_(&robot), timeout_ticks_(topics.command_timeout / interval_seconds) {
  if (topics.command_type != ros::CommandType::kTwistStamped) twists_.Open(node, topics.reliable_commands);
  if (topics.command_type != ros::CommandType::kTwist) stamped_twists_.Open(node, topics.reliable_commands);
}

std::optional<Command> CommandInput::CommandAt(Tick tick) {
  twists_.Drain([&](const ros::TwistMessage& twist) { Apply(twist, tick); });
  stamped_twists_.Drain([&](const ros::TwistStamped& stamped) { Apply(stamped.twist, tick); });
  twists_.OpenMissing();
  stamped_twists_.OpenMissing();
  const bool expired = timeout_ticks_ > 0.0 && static_cast<double>(tick - received_) >= timeout_ticks_;
  if (expired) command_.reset();
  return command_;
}

void CommandInput::Restart() {
  twists_.Drain([](const ros::TwistMessage&) {});
  stamped_twists_.Drain([](const ros::TwistStamped&) {});
  command_.reset();
  received_ = 0;
}

void CommandInput::Apply(const ros::TwistMessage& twist, Tick tick) {
  const Twist wanted{twist.linear.x, twist.linear.y, twist.angular.z};
  if (!IsFinite(wanted)) {
    refusals_.Count();
    return;
  }
  command_ = CommandFromTwist(wanted, robot_->drive);
  received_ = tick;
}

std::optional<std::string> CommandInput::DrainReport() {
  const std::uint64_t refused = refusals_.CountToReport();
  if (refused == 0) return std::nullopt;
  return fmt::format("robot {}: cmd_vel: ignored a command that is not finite ({} so far)", robot_->name, refused);
}

}  // namespace troupe
