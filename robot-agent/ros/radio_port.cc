#include "robot-agent/ros/radio_port.h"

#include <fmt/format.h>

#include <utility>

#include "ros/connection/ros_qos.h"
#include "ros/messages/names.h"
#include "ros/messages/radio_json.h"
#include "transport/dds/binding/wire.h"
#include "troupe/radio_limits.h"

namespace troupe {
namespace {

constexpr std::int32_t kDepth = 100;  // messages; a radio receives those of many robots in one tick

}  // namespace

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
