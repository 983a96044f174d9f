#include "robot-agent/ros/manipulator_port.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "ros/connection/ros_network.h"
#include "ros/messages/names.h"
#include "ros/messages/text_messages.h"
#include "transport/dds/binding/wire.h"

namespace troupe {
namespace {

constexpr std::int32_t kStateDepth = 10;
constexpr double kPercent = 100.0;

// The index of a joint among its robot's joints, as in a Command.
std::size_t NumberOf(std::span<const JointId> joints, JointId joint) {
  return static_cast<std::size_t>(std::find(joints.begin(), joints.end(), joint) - joints.begin());
}

double ToPercent(double opening, double largest) {
  return largest > 0.0 ? std::clamp(kPercent * opening / largest, 0.0, kPercent) : 0.0;
}

}  // namespace

// Fingers and lifts are commanded by their gripper; all other joints have a topic each.
ManipulatorPort::ManipulatorPort(const ros::RosNode& node, const Scene& scene, RobotId robot) : world_(&scene.world()) {
  const std::span<const JointId> joints = scene.joints_of(robot);
  std::vector<bool> in_gripper(joints.size(), false);
  for (const auto& [id, name] : ros::GripperNamesOf(*world_, robot)) {
    const GripperDescription& description = world_->gripper(id);
    Gripper gripper{id, grippers_.size(), {}, ros::LargestOpening(*world_, id), nullptr, nullptr, nullptr, nullptr};
    for (const JointId finger : {description.left, description.right}) in_gripper[NumberOf(joints, finger)] = true;
    gripper.opening = std::make_unique<PositionInput>(node, name + "/command", Interval{0.0, gripper.largest_opening});
    if (description.lift) {
      gripper.lift = NumberOf(joints, *description.lift);
      in_gripper[*gripper.lift] = true;
      gripper.height =
          std::make_unique<PositionInput>(node, name + "/lift/command", world_->joint(*description.lift).position);
    }
    gripper.action = std::make_unique<GripperAction>(node, name + "/gripper_cmd", *world_, id);
    gripper.state = std::make_unique<ros::RosWriter<ros::String>>(node, name + "/state", ros::Stream(kStateDepth));
    grippers_.push_back(std::move(gripper));
  }
  for (const ros::JointName& joint : ros::JointNamesOf(*world_, robot)) {
    const std::size_t number = NumberOf(joints, joint.joint);
    if (in_gripper[number]) continue;
    joints_.push_back(
        {number, std::make_unique<PositionInput>(node, joint.name + "/command", world_->joint(joint.joint).position)});
  }
}

Command ManipulatorPort::WithCommands(Tick tick, Command command) {
  for (Gripper& gripper : grippers_) AppendGripperCommands(tick, gripper, command);
  for (Joint& joint : joints_) {
    if (const std::optional<double> position = joint.position->Latest()) {
      command.joints.push_back({.joint = joint.number, .position = position});
    }
  }
  return command;
}

// A command on the topic takes precedence, and ends the goals of the action: two sources must not pull the fingers.
void ManipulatorPort::AppendGripperCommands(Tick tick, Gripper& gripper, Command& command) {
  const auto open = [&](double opening) {
    command.grippers.push_back({.gripper = gripper.number, .opening = ToPercent(opening, gripper.largest_opening)});
  };
  if (const std::optional<double> opening = gripper.opening->Latest()) {
    gripper.action->AbortAll();
    open(*opening);
  } else if (const std::optional<GripperGoals::Order> order = gripper.action->Begin(tick)) {
    if (order->opening) {
      open(*order->opening);
    } else {
      command.grippers.push_back({.gripper = gripper.number, .fingers = FingerCommand::kStay});
    }
  }
  if (!gripper.height) return;
  if (const std::optional<double> height = gripper.height->Latest()) {
    command.joints.push_back({.joint = *gripper.lift, .position = height});
  }
}

void ManipulatorPort::PublishActions(const WorldState& state) {
  for (Gripper& gripper : grippers_) gripper.action->Publish(state);
}

void ManipulatorPort::PublishStates(const WorldState& state) {
  for (Gripper& gripper : grippers_) {
    if (!gripper.state->is_addressed()) continue;
    dds::WireArena arena;
    gripper.state->Write({arena.Copy(ros::GripperJson(*world_, gripper.id, state))});
  }
}

std::vector<std::string> ManipulatorPort::DrainReports() {
  std::vector<std::string> reports;
  const auto add = [&](std::optional<std::string> report) {
    if (report) reports.push_back(*std::move(report));
  };
  for (Gripper& gripper : grippers_) {
    add(gripper.opening->DrainReport());
    if (gripper.height) add(gripper.height->DrainReport());
    add(gripper.action->DrainReport());
  }
  for (Joint& joint : joints_) add(joint.position->DrainReport());
  return reports;
}

PositionInput::PositionInput(const ros::RosNode& node, const std::string& topic, const Interval& range)
    : topic_(node.Resolve(topic)), range_(range), reader_(node, topic, ros::Commands(true)) {}

// m or rad, within the limits of the joint; nothing: no command has arrived since the last call.
std::optional<double> PositionInput::Latest() {
  std::optional<double> position;
  reader_.Drain([&](const ros::Float64& command) {
    if (std::isfinite(command.data)) {
      position = range_.Clamp(command.data);
    } else {
      refusals_.Count();
    }
  });
  return position;
}

std::optional<std::string> PositionInput::DrainReport() {
  const std::uint64_t refused = refusals_.CountToReport();
  if (refused == 0) return std::nullopt;
  return fmt::format("{}: ignored a command that is not finite ({} so far)", topic_, refused);
}

}  // namespace troupe
