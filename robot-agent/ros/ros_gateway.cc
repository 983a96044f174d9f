#include "robot-agent/ros/ros_gateway.h"

#include <memory>
#include <utility>

#include "common/ros/convert.h"
#include "common/ros_dds/parameter_services.h"
#include "common/ros_dds/ros_qos.h"
#include "robot-agent/ros/command_input.h"
#include "robot-agent/ros/manipulator_port.h"
#include "robot-agent/ros/robot_output.h"

namespace troupe {
namespace {

constexpr std::int32_t kTransformDepth = 100;
// In a world with more robots, their nodes have no parameter services, which are twelve endpoints each.
constexpr std::size_t kMostRobotsWithParameters = 10;
// More processes than these do not discover each other, because discovery would grow with the square of their number.
constexpr std::size_t kMostMutualProcesses = 10;
constexpr int kRepeats = 5;  // in a pause, after a reader has come
constexpr const char* kNodeName = "robot";

struct RosRobot;
using RosRobots = std::vector<RosRobot*>;  // by id; null for robots of other agents

// The topics tf and tf_static: of one robot, or of all robots of the process.
class Transforms {
 public:
  Transforms(const ros::RosNode& node, const std::string& prefix)
      : moving_(node, prefix + "tf", ros::Stream(kTransformDepth)),
        fixed_(node, prefix + "tf_static", ros::Latched()) {}

  void Write(Tick tick, std::span<const RobotView* const> robots, const RosRobots& by_id);

 private:
  ros::RosWriter<ros::TfMessage> moving_;
  ros::RosWriter<ros::TfMessage> fixed_;
  bool fixed_written_ = false;
};

struct RosRobot {
  RosRobot(const ros::RosNode& node_of_robot, const ros::RosOptions& options, const Scene& scene, RobotId robot,
           const std::string& name)
      : node(node_of_robot),
        input(node, options, scene.world().robot(robot), scene.world().interval_seconds()),
        output(node, options, scene, robot, name),
        manipulator(node, scene, robot) {
    if (options.namespaced_tf) transforms = std::make_unique<Transforms>(node, "");
    if (scene.world().robots.size() <= kMostRobotsWithParameters) {
      parameters =
          std::make_unique<ros::ParameterServices>(node, kNodeName,
                                                   ros::Parameters{{"use_sim_time", true},
                                                                   {"command_timeout", options.command_timeout},
                                                                   {"robot", scene.world().robot(robot).name}});
    }
  }

  ros::RosNode node;
  CommandInput input;
  RobotOutput output;
  ManipulatorPort manipulator;
  std::unique_ptr<Transforms> transforms;              // null where robots share them
  std::unique_ptr<ros::ParameterServices> parameters;  // null where there are many robots
};

void Transforms::Write(Tick tick, std::span<const RobotView* const> robots, const RosRobots& by_id) {
  if (!fixed_written_) {
    // One message for all robots, because only the last one is kept for late readers.
    fixed_written_ = true;
    dds::WireArena arena;
    std::vector<ros::TransformStamped> fixed;
    for (const RobotView* robot : robots) {
      const auto of_robot = by_id[robot->id().index()]->output.StaticTransforms(*robot, arena);
      fixed.insert(fixed.end(), of_robot.begin(), of_robot.end());
    }
    fixed_.Write(ros::MakeTfMessage(fixed, arena));
  }
  if (!moving_.wanted()) return;
  dds::WireArena arena;
  std::vector<ros::TransformStamped> moving;
  for (const RobotView* robot : robots) {
    const auto of_robot = by_id[robot->id().index()]->output.MovingTransforms(tick, *robot, arena);
    moving.insert(moving.end(), of_robot.begin(), of_robot.end());
  }
  moving_.Write(ros::MakeTfMessage(moving, arena));
}

// `robots`: of this process. Assumes that all processes have as many.
ros::RosOptions OptionsFor(ros::RosOptions options, const Scene& scene, const std::vector<RobotId>& robots) {
  options.quiet = scene.world().robots.size() > kMostMutualProcesses * robots.size();
  return options;
}

// A process has one participant, and so one enclave: that of its first robot.
std::string EnclaveFor(const Scene& scene, const std::vector<RobotId>& robots) {
  if (robots.empty()) return "/";
  return "/" + ros::RobotNames(scene.world())[robots.front().index()];
}

class RosGateway final : public Gateway {
 public:
  RosGateway(const ros::RosOptions& options, const Scene& scene, const std::vector<RobotId>& robots)
      : participant_(OptionsFor(options, scene, robots), EnclaveFor(scene, robots)),
        by_id_(scene.world().robots.size()) {
    participant_.WatchWriters();
    // Not by each process, because all would report the same.
    if (!robots.empty() && robots.front().index() == 0) participant_.WatchDistributions();
    const std::vector<std::string> names = ros::RobotNames(scene.world());
    for (const RobotId robot : robots) {
      const std::string& name = names[robot.index()];
      const ros::RosNode node = ros::MakeNode(participant_, "/" + name, kNodeName);
      robots_.push_back(std::make_unique<RosRobot>(node, options, scene, robot, name));
      by_id_[robot.index()] = robots_.back().get();
    }
    if (!options.namespaced_tf && !robots_.empty()) {
      shared_transforms_ = std::make_unique<Transforms>(robots_.front()->node, "/");
    }
    participant_.Announce();
  }

  ExternalCommand CommandFor(RobotId id, Tick tick) override {
    RosRobot& robot = *by_id_[id.index()];
    ExternalCommand external;
    if (const std::optional<Command> motion = robot.input.CommandAt(tick)) external = {*motion, true};
    external.command = robot.manipulator.WithCommands(tick, std::move(external.command));
    return external;
  }

  void Publish(Tick tick, std::span<const RobotView* const> robots) override {
    for (const RobotView* robot : robots) {
      by_id_[robot->id().index()]->output.AddMotion(*robot);
      by_id_[robot->id().index()]->manipulator.PublishActions(robot->world_state());
    }
    Show(tick, robots);
  }

  // A reader may need a moment to discover its writer in turn.
  void Repeat(Tick tick, std::span<const RobotView* const> robots) override {
    if (const std::uint64_t count = participant_.reader_count(); count != std::exchange(readers_seen_, count)) {
      repeats_ = kRepeats;
    }
    if (repeats_ == 0) return;
    --repeats_;
    Show(tick, robots);
  }
  void Restart() override {
    for (const auto& robot : robots_) robot->input.Restart();
  }

  std::vector<std::string> DrainReports() override {
    std::vector<std::string> reports = participant_.DrainMismatches();
    for (const auto& robot : robots_) {
      if (std::optional<std::string> report = robot->input.DrainReport()) reports.push_back(*std::move(report));
      for (std::string& report : robot->manipulator.DrainReports()) reports.push_back(std::move(report));
    }
    return reports;
  }

 private:
  void Show(Tick tick, std::span<const RobotView* const> robots) {
    for (const RobotView* robot : robots) {
      by_id_[robot->id().index()]->output.Publish(tick, *robot);
      by_id_[robot->id().index()]->manipulator.PublishStates(robot->world_state());
    }
    if (shared_transforms_) {
      shared_transforms_->Write(tick, robots, by_id_);
    } else {
      for (const RobotView* robot : robots) by_id_[robot->id().index()]->transforms->Write(tick, {&robot, 1}, by_id_);
    }
  }

  ros::RosParticipant participant_;
  std::uint64_t readers_seen_ = 0;
  int repeats_ = 0;  // still to come in this pause
  std::vector<std::unique_ptr<RosRobot>> robots_;
  RosRobots by_id_;
  std::unique_ptr<Transforms> shared_transforms_;  // null where each robot has its own
};

}  // namespace

MakeGateway MakeRosGateway(const ros::RosOptions& options) {
  return [options](const Scene& scene, const std::vector<RobotId>& robots) -> std::unique_ptr<Gateway> {
    return std::make_unique<RosGateway>(options, scene, robots);
  };
}

}  // namespace troupe
