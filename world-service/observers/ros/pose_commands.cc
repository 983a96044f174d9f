#include "world-service/observers/ros/pose_commands.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/link/host_connection.h"
#include "ros/messages/names.h"
#include "world-service/observers/ros/request_values.h"

namespace troupe {
namespace {

constexpr const char* kGoalTopic = "goal_pose";
constexpr const char* kPoseTopic = "initialpose";

}  // namespace

// The topics of a robot.
struct PoseCommands::Inputs {
  Inputs(ros::RosConnection& of_run, const ros::RosOptions& options, const std::string& robot,
         const ros::RobotInRos& in_ros, const std::function<void()>& notify)
      : name(robot), domain(in_ros.domain), name_space(in_ros.node_namespace) {
    if (in_ros.alone) {
      own = std::make_unique<ros::HostConnection>(options.network.distribution, options.socket, in_ros.domain,
                                                  ros::HostConnection::Sending::kAtOnce);
    }
    ros::RosConnection& connection = own ? *own : of_run;
    const ros::RosNode node = {&connection, ros::kNoNode, name_space};
    const auto open = [&](auto& reader, const char* topic) {
      reader.emplace(node, topic, ros::Commands(true), ros::Part::kOnlyReader, notify);
    };
    if (options.pose_topics.goals) open(goals, kGoalTopic);
    if (options.pose_topics.poses) open(poses, kPoseTopic);
  }

  bool IsOf(const std::string& robot, const ros::RobotInRos& in_ros) const {
    return name == robot && domain == in_ros.domain && name_space == in_ros.node_namespace;
  }

  const std::string name;
  const std::uint32_t domain;
  const std::string name_space;
  std::unique_ptr<ros::RosConnection> own;  // null: that of the run
  std::optional<ros::RosReader<geometry_msgs_msg_dds__PoseStamped_>> goals;
  std::optional<ros::RosReader<geometry_msgs_msg_dds__PoseWithCovarianceStamped_>> poses;
};

PoseCommands::PoseCommands(ros::RosConnection& of_run, const ros::RosOptions& options,
                           std::shared_ptr<const Scene> scene, WorldControl& control,
                           std::function<void(const std::string&)> report)
    : of_run_(of_run),
      options_(options),
      control_(control),
      reports_(std::make_shared<FloodLimiter>(std::move(report))),
      scene_(std::move(scene)),
      thread_([this] { Run(); }) {}

PoseCommands::~PoseCommands() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    changed_.notify_one();
  }
  thread_.join();
}

void PoseCommands::ChangeWorld(std::shared_ptr<const Scene> scene) {
  const std::lock_guard lock(mutex_);
  scene_ = std::move(scene);
  follow_ = true;
  changed_.notify_one();
}

void PoseCommands::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stop_ || follow_ || arrived_; });
    if (stop_) break;
    const std::shared_ptr<const Scene> scene = std::exchange(follow_, false) ? scene_ : nullptr;
    arrived_ = false;
    lock.unlock();
    try {
      if (scene) Follow(*scene);
      for (const auto& robot : inputs_) {
        const std::string& name = robot->name;
        if (robot->goals) {
          robot->goals->Drain([&](const auto& goal) { SetGoal(name, goal.header.frame_id, goal.pose); });
        }
        if (robot->poses) {
          robot->poses->Drain([&](const auto& pose) { SetPose(name, pose.header.frame_id, pose.pose.pose); });
        }
      }
    } catch (const std::exception& exception) {  // of DDS, as without memory
      reports_->Add(exception.what());
    }
    lock.lock();
  }
  lock.unlock();
  inputs_.clear();
}

void PoseCommands::Follow(const Scene& scene) {
  const WorldDescription& world = scene.world();
  const auto robots = ros::FindRobotsInRos(world, options_.network.domain, options_.names);
  std::erase_if(inputs_, [&](const auto& input) {
    return std::none_of(robots.begin(), robots.end(),
                        [&](const auto& robot) { return input->IsOf(world.robot(robot.first).name, robot.second); });
  });
  const auto notify = [this] {
    const std::lock_guard lock(mutex_);
    arrived_ = true;
    changed_.notify_one();
  };
  for (const auto& robot : robots) {
    const std::string& name = world.robot(robot.first).name;
    // A robot that has moved to another domain or namespace by an edit is another input: the one before has ended
    // above.
    const bool is_known =
        std::any_of(inputs_.begin(), inputs_.end(), [&](const auto& input) { return input->IsOf(name, robot.second); });
    if (!is_known) inputs_.push_back(std::make_unique<Inputs>(of_run_, options_, name, robot.second, notify));
  }
}

void PoseCommands::SetGoal(const std::string& robot, const char* frame, const ros::PoseMessage& pose) {
  const Result<Pose> X_WG = PoseFromRos(frame, pose);
  if (!X_WG.ok()) return Refuse(robot, kGoalTopic, X_WG.error().message);
  control::CommandRobot request{.name = robot, .ticks = kMaxCommandTicks};
  request.goal = Goal{0, {Vec2(X_WG.value().x, X_WG.value().y)}, X_WG.value().heading};
  // RViz knows no heights: 0 is the level of the robot.
  if (X_WG.value().z != 0.0) request.goal->heights = {X_WG.value().z};
  control_.Request(request, [reports = reports_, robot](const ControlReply& reply) {
    if (!reply.done) reports->Add(std::string(kGoalTopic) + " of '" + robot + "': " + reply.problem);
  });
}

// RViz knows no heights: the robot keeps its own.
void PoseCommands::SetPose(const std::string& robot, const char* frame, const ros::PoseMessage& pose) {
  const Result<Pose> X_WR = PoseFromRos(frame, pose);
  if (!X_WR.ok()) return Refuse(robot, kPoseTopic, X_WR.error().message);
  control_.Request(control::Entities{.name = robot},
                   [&control = control_, reports = reports_, robot, to = X_WR.value()](const ControlReply& reply) {
                     if (reply.entities.size() != 1) return;
                     control::SetPose move{robot, to};
                     move.pose.z = reply.entities.front().X_WE.z;
                     control.Request(move, [reports, robot](const ControlReply& answer) {
                       if (!answer.done)
                         reports->Add(std::string(kPoseTopic) + " of '" + robot + "': " + answer.problem);
                     });
                   });
}

void PoseCommands::Refuse(const std::string& robot, const std::string& topic, const std::string& reason) {
  reports_->Add(topic + " of '" + robot + "': " + reason);
}

}  // namespace troupe
