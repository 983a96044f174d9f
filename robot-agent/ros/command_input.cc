#include "robot-agent/ros/command_input.h"

#include <fmt/format.h>

#include <utility>

#include "robot-agent/drive/drive.h"
#include "ros/connection/ros_network.h"
#include "ros/messages/names.h"
#include "ros/messages/text_messages.h"
#include "transport/dds/binding/wire.h"
#include "troupe/radio_limits.h"

namespace troupe {
namespace {

constexpr const char* kTopic = "cmd_vel";

constexpr std::int32_t kDepth = 100;  // messages; a radio receives messages of many robots in one tick

}  // namespace

template <typename T>
void CommandInput::Readers<T>::Open(const ros::RosNode& node, bool reliable_only) {
  node_ = node;
  reliable_ = std::make_unique<ros::RosReader<T>>(node, kTopic, ros::Commands(true),
                                                  reliable_only ? ros::Part::kOnlyReader : ros::Part::kReliableReader);
}

// A reliable reader does not match a best-effort writer. The second reader is opened only when there is such a writer,
// as each reader costs discovery.
template <typename T>
void CommandInput::Readers<T>::OpenMissing() {
  if (!reliable_ || best_effort_ || !reliable_->missed_writer()) return;
  best_effort_ = std::make_unique<ros::RosReader<T>>(node_, kTopic, ros::Commands(false), ros::Part::kBestEffortReader);
  // Tools list the new reader with its node only after this.
  node_.connection->Announce();
}

CommandInput::CommandInput(const ros::RosNode& node, const ros::RobotTopics& topics, const RobotDescription& robot,
                           double interval_seconds)
    : robot_(&robot), timeout_ticks_(topics.command_timeout / interval_seconds) {
  if (topics.command_type != ros::CommandType::kTwistStamped) twists_.Open(node, topics.reliable_commands);
  if (topics.command_type != ros::CommandType::kTwist) stamped_twists_.Open(node, topics.reliable_commands);
}

// The newest command counts, until it is older than the timeout in simulated time: a paused run ages no command.
std::optional<Command> CommandInput::CommandAt(Tick tick) {
  twists_.Drain([&](const ros::TwistMessage& twist) { Apply(twist, tick); });
  stamped_twists_.Drain([&](const ros::TwistStamped& stamped) { Apply(stamped.twist, tick); });
  twists_.OpenMissing();
  stamped_twists_.OpenMissing();
  const bool expired = timeout_ticks_ > 0.0 && static_cast<double>(tick - received_) >= timeout_ticks_;
  if (expired) command_.reset();
  return command_;
}

// Messages of the past belong to the time before the reset.
void CommandInput::Restart() {
  twists_.Drain([](const ros::TwistMessage&) {});
  stamped_twists_.Drain([](const ros::TwistStamped&) {});
  command_.reset();
  received_ = 0;
}

// The frame of a stamped twist is not looked at: commands are in the robot's frame.
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

RadioPort::RadioPort(const ros::RosNode& node, const Scene& scene, RobotId robot) : world_(&scene.world()) {
  const RobotDescription& description = world_->robot(robot);
  for (const ros::KindTopic& topic : ros::SensorTopicsOf(description).radios) {
    Radio radio{.sensor = topic.sensor,
                .topic = node.Resolve(topic.topic + "/send"),
                .most_bytes = BytesPerTick(*FindRadio(description, topic.sensor), world_->interval_seconds()),
                .input = nullptr,
                .output = nullptr};
    radio.input = std::make_unique<ros::RosReader<ros::String>>(node, topic.topic + "/send", ros::Stream(kDepth));
    radio.output = std::make_unique<ros::RosWriter<ros::String>>(node, topic.topic + "/received", ros::Stream(kDepth));
    radios_.push_back(std::move(radio));
  }
}

// A message that the radio could not send in a tick is refused here, with its reason.
void RadioPort::AddMessages(std::vector<RadioMessage>& messages) {
  for (Radio& radio : radios_) {
    radio.input->Drain([&](const ros::String& sample) {
      Result<RadioMessage> message = ros::ReadRadioMessage(*world_, radio.sensor, dds::Text(sample.data));
      if (message.ok() && message.value().bytes.size() <= radio.most_bytes) {
        messages.push_back(std::move(message).value());
        return;
      }
      radio.reason =
          message.ok() ? fmt::format("a message of {} bytes", message.value().bytes.size()) : message.error().message;
      radio.refusals.Count();
    });
  }
}

// One sample for each reception, only while the topic has a reader.
void RadioPort::Publish(const RobotView& robot) {
  for (const Radio& radio : radios_) {
    if (!radio.output->wanted()) continue;
    const SensorReading& reading = robot.Measure(radio.sensor);
    for (const RadioReception& reception : std::get<RadioReading>(reading.content).receptions) {
      dds::WireArena arena;
      radio.output->Write({arena.Copy(ros::ReceptionJson(*world_, reception))});
    }
  }
}

void RadioPort::Restart() {
  for (const Radio& radio : radios_) radio.input->Drain([](const ros::String&) {});
}

std::vector<std::string> RadioPort::DrainReports() {
  std::vector<std::string> reports;
  for (Radio& radio : radios_) {
    const std::uint64_t refused = radio.refusals.CountToReport();
    if (refused == 0) continue;
    reports.push_back(
        fmt::format("{}: ignored {}, expected {{\"text\": ...}} or {{\"bytes\": ...}} of at most {} bytes, "
                    "perhaps with {{\"to\": ROBOT}} ({} so far)",
                    radio.topic, radio.reason, radio.most_bytes, refused));
  }
  return reports;
}

}  // namespace troupe
