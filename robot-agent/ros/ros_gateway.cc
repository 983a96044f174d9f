#include "robot-agent/ros/ros_gateway.h"

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robot-agent/ros/command_input.h"
#include "robot-agent/ros/manipulator_port.h"
#include "robot-agent/ros/robot_output.h"
#include "robot-agent/ros/slotcar_port.h"
#include "ros/connection/node_services.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/world_topics.h"
#include "ros/link/host_connection.h"
#include "ros/messages/convert.h"
#include "ros/messages/names.h"

namespace troupe {
namespace {

struct RobotInGroup {
  RobotId id;
  ros::RobotInRos in_ros;
};

// RobotGroup: the robots of an agent in one ROS domain: one connection, a node for each robot, and the transforms that
// they share. A robot in a domain of its own has a group of its own, with /clock and /map.
class RobotGroup {
 public:
  // REQUIRES: `robots` is not empty, all in one domain; the scene outlives the group.
  RobotGroup(const ros::RosOptions& options, const Scene& scene, const std::vector<RobotInGroup>& robots);
  ~RobotGroup();

  ExternalCommand CommandFor(RobotId id, const WorldState& state);
  void AwaitPublished() { connection_.AwaitSent(); }
  // Once for each tick, before Show.
  void PublishActions(const RobotView& robot);
  // `robots`: of the process, in the order of their ids.
  void Show(Tick tick, std::span<const RobotView* const> robots);
  // The same for the topics whose readers have come since that time; for all, if the program of the host asks for it.
  void Repeat(Tick tick, std::span<const RobotView* const> robots, std::chrono::steady_clock::time_point since);
  void ChangeWorld(const Scene& scene);
  void Restart();
  // The messages for the log of the run; also writes them to /rosout.
  std::vector<std::string> DrainReports();

 private:
  class Transforms;
  struct Member;

  Member* Find(RobotId id);
  void Settle();
  void ShowRobots(Tick tick, std::span<const RobotView* const> robots);
  // Those from the index `first` on, as lines of the robot's node.
  void Log(const Member& robot, const std::vector<std::string>& reports, std::size_t first);

  ros::HostConnection connection_;
  std::vector<std::unique_ptr<Member>> members_;
  std::vector<Member*> by_id_;  // null for all other robots of the world
  std::optional<ros::RosLog> log_;
  std::unique_ptr<SlotcarPort> rmf_;               // null: the world has nothing for Open-RMF
  std::unique_ptr<Transforms> shared_transforms_;  // null where each robot has its own
  std::optional<ros::ClockOutput> clock_;          // these two in a domain of its own
  std::optional<ros::MapOutput> map_;
  std::int64_t interval_ns_ = 0;
  bool is_settled_ = false;
  bool shown_ = false;  // Show was called
};

constexpr std::int32_t kTransformDepth = 100;
// In a domain with more robots, their nodes have no services for parameters and types: those are fourteen endpoints
// each, which every tool discovers. One service alone is of no use: tools wait for all six of a node.
constexpr std::size_t kMaxRobotsWithParameters = 100;
constexpr const char* kNodeName = "robot";

// The topics tf and tf_static: of one robot, or of all robots of the group.
class RobotGroup::Transforms {
 public:
  Transforms(const ros::RosNode& node, const std::string& prefix)
      : moving_(node, prefix + "tf", ros::Stream(kTransformDepth)),
        fixed_(node, prefix + "tf_static", ros::Latched()) {}

  void Write(Tick tick, const std::vector<std::pair<const RobotView*, RobotOutput*>>& robots);

 private:
  ros::RosWriter<ros::TfMessage> moving_;
  ros::RosWriter<ros::TfMessage> fixed_;
  bool fixed_written_ = false;
};

void RobotGroup::Transforms::Write(Tick tick, const std::vector<std::pair<const RobotView*, RobotOutput*>>& robots) {
  if (!fixed_written_) {
    // One message for all robots, because only the last one is kept for late readers.
    fixed_written_ = true;
    dds::WireArena arena;
    std::vector<ros::TransformStamped> fixed;
    for (const auto& [view, output] : robots) {
      const auto of_robot = output->StaticTransforms(*view, arena);
      fixed.insert(fixed.end(), of_robot.begin(), of_robot.end());
    }
    fixed_.Write(ros::MakeTfMessage(fixed, arena));
  }
  if (!moving_.is_addressed()) return;
  dds::WireArena arena;
  std::vector<ros::TransformStamped> moving;
  for (const auto& [view, output] : robots) {
    const auto of_robot = output->MovingTransforms(tick, *view, arena);
    moving.insert(moving.end(), of_robot.begin(), of_robot.end());
  }
  if (moving.empty()) return;
  moving_.Write(ros::MakeTfMessage(moving, arena));
}

struct RobotGroup::Member {
  Member(const ros::RosNode& node_of_robot, const ros::RosOptions& options, const Scene& scene,
         const RobotInGroup& robot)
      : node(node_of_robot),
        input(node, options.robots, scene.world().robot(robot.id), scene.world().interval_seconds()),
        output(node, options.robots, scene, robot.id, robot.in_ros),
        manipulator(node, scene, robot.id),
        radios(node, scene, robot.id) {
    if (options.names.namespaced_tf) transforms = std::make_unique<Transforms>(node, "");
    if (!robot.in_ros.alone && scene.world().robots.size() > kMaxRobotsWithParameters) return;
    parameters =
        std::make_unique<ros::ParameterServices>(node, kNodeName,
                                                 ros::Parameters{{"use_sim_time", true},
                                                                 {"command_timeout", options.robots.command_timeout},
                                                                 {"robot", scene.world().robot(robot.id).name}});
    type_descriptions = std::make_unique<ros::TypeDescriptionService>(node, kNodeName);
  }

  ros::RosNode node;
  CommandInput input;
  RobotOutput output;
  ManipulatorPort manipulator;
  RadioPort radios;
  std::unique_ptr<Transforms> transforms;  // null where robots share them
  // Null where there are many robots.
  std::unique_ptr<ros::ParameterServices> parameters;
  std::unique_ptr<ros::TypeDescriptionService> type_descriptions;
};

RobotGroup::RobotGroup(const ros::RosOptions& options, const Scene& scene, const std::vector<RobotInGroup>& robots)
    : connection_(options.network.distribution, options.socket, robots.front().in_ros.domain,
                  ros::HostConnection::Sending::kByFlush),
      by_id_(scene.world().robots.size()),
      interval_ns_(scene.world().interval_ns) {
  // Not by each process of a domain, because all would report the same.
  const bool alone = robots.front().in_ros.alone;
  if (alone || robots.front().id.index() == 0) connection_.WatchDistributions();
  for (const RobotInGroup& robot : robots) {
    const ros::RosNode node = ros::MakeNode(connection_, robot.in_ros.node_namespace, kNodeName);
    members_.push_back(std::make_unique<Member>(node, options, scene, robot));
    by_id_[robot.id.index()] = members_.back().get();
    if (!log_) log_.emplace(node);
  }
  const ros::RosNode& first = members_.front()->node;
  if (!options.names.namespaced_tf) shared_transforms_ = std::make_unique<Transforms>(first, "/");
  if (ros::HasRmf(scene.world())) {
    std::vector<RobotId> ids;
    for (const RobotInGroup& robot : robots) ids.push_back(robot.id);
    rmf_ = std::make_unique<SlotcarPort>(first, scene, ids);
  }
  if (alone) {
    clock_.emplace(first, options.world.clock_rate);
    map_.emplace(first, options.world);
    map_->ChangeWorld(scene);
  }
  connection_.Announce();
}

RobotGroup::~RobotGroup() = default;

RobotGroup::Member* RobotGroup::Find(RobotId id) {
  return id.index() < by_id_.size() ? by_id_[id.index()] : nullptr;
}

ExternalCommand RobotGroup::CommandFor(RobotId id, const WorldState& state) {
  const Tick tick = state.tick;
  Settle();
  connection_.Receive();
  Member& robot = *Find(id);
  ExternalCommand external;
  if (rmf_) {
    if (const std::optional<Command> motion = rmf_->CommandFor(id, state)) external = {*motion, true};
  }
  if (const std::optional<Command> motion = robot.input.CommandAt(tick)) external = {*motion, true};
  external.command = robot.manipulator.WithCommands(tick, std::move(external.command));
  robot.radios.AddMessages(external.command.messages);
  return external;
}

void RobotGroup::PublishActions(const RobotView& robot) {
  Member* const member = Find(robot.id());
  if (member == nullptr) return;
  member->output.AddMotion(robot);
  member->manipulator.PublishActions(robot.world_state());
  member->radios.Publish(robot);
}

// An agent that is started again has readers from its first tick on, and commands that the one before was sent.
void RobotGroup::Settle() {
  if (!std::exchange(is_settled_, true)) connection_.AwaitSettled();
}

void RobotGroup::Show(Tick tick, std::span<const RobotView* const> robots) {
  Settle();
  // Until the first reader comes: to ask all writers in vain would take an agent among many a quarter of its time,
  // because each has a place of its own in memory. The first call writes the static transforms.
  if (!std::exchange(shown_, true) || connection_.had_reader()) ShowRobots(tick, robots);
  if (clock_) clock_->Show(tick, interval_ns_, false);
  if (map_) map_->Poll();
  connection_.Flush();
}

void RobotGroup::Repeat(Tick tick, std::span<const RobotView* const> robots,
                        std::chrono::steady_clock::time_point since) {
  connection_.Receive();
  const bool is_asked = connection_.ConsumeShowAgain();
  connection_.AddressReadersSince(is_asked ? std::chrono::steady_clock::time_point::min() : since);
  ShowRobots(tick, robots);
  connection_.AddressReadersSince(std::nullopt);
  if (!is_asked) return connection_.Flush();
  connection_.AwaitSent();
  connection_.ConfirmShown();
}

void RobotGroup::ShowRobots(Tick tick, std::span<const RobotView* const> robots) {
  std::vector<std::pair<const RobotView*, Member*>> shown;
  for (const RobotView* robot : robots) {
    if (Member* const member = Find(robot->id())) shown.emplace_back(robot, member);
  }
  // First the transforms: a node that transforms a scan at its stamp need not wait for them.
  std::vector<std::pair<const RobotView*, RobotOutput*>> together;
  for (const auto& [robot, member] : shown) {
    if (member->transforms) {
      member->transforms->Write(tick, {{robot, &member->output}});
    } else {
      together.emplace_back(robot, &member->output);
    }
  }
  if (shared_transforms_) shared_transforms_->Write(tick, together);
  if (rmf_) rmf_->Publish(robots, connection_.addresses_newcomers());
  for (const auto& [robot, member] : shown) {
    member->output.Publish(tick, *robot);
    member->manipulator.PublishStates(robot->world_state());
  }
}

void RobotGroup::ChangeWorld(const Scene& scene) {
  if (map_) map_->ChangeWorld(scene);
  if (rmf_) rmf_->ChangeWorld(scene);
  for (const auto& robot : members_) robot->radios.ChangeWorld(scene);
}

void RobotGroup::Restart() {
  if (rmf_) rmf_->Restart();
  for (const auto& robot : members_) {
    robot->input.Restart();
    robot->radios.Restart();
  }
}

std::vector<std::string> RobotGroup::DrainReports() {
  std::vector<std::string> reports = connection_.DrainMismatches();
  if (rmf_) {
    for (std::string& report : rmf_->DrainReports()) reports.push_back(std::move(report));
  }
  Log(*members_.front(), reports, 0);
  for (const auto& robot : members_) {
    const std::size_t logged = reports.size();
    if (std::optional<std::string> report = robot->input.DrainReport()) reports.push_back(*std::move(report));
    for (std::string& report : robot->manipulator.DrainReports()) reports.push_back(std::move(report));
    for (std::string& report : robot->radios.DrainReports()) reports.push_back(std::move(report));
    Log(*robot, reports, logged);
  }
  connection_.Flush();
  return reports;
}

void RobotGroup::Log(const Member& robot, const std::vector<std::string>& reports, std::size_t first) {
  for (std::size_t i = first; i < reports.size(); ++i) {
    log_->Write(ros::LogLevel::kWarning, robot.node.Resolve(kNodeName), reports[i]);
  }
}

// A reader may need that long to discover its writer in turn; in a pause it gets the tick again meanwhile.
constexpr auto kDiscovery = std::chrono::seconds(1);

class RosGateway final : public Gateway {
 public:
  RosGateway(const ros::RosOptions& options, const Scene& scene, const std::vector<RobotId>& robots)
      : group_of_(scene.world().robots.size(), nullptr) {
    std::map<std::uint32_t, std::vector<RobotInGroup>> by_domain;
    for (const RobotId robot : robots) {
      const ros::RobotInRos in_ros = ros::FindRobotInRos(scene.world(), robot, options.network.domain, options.names);
      by_domain[in_ros.domain].push_back({robot, in_ros});
    }
    for (const auto& [domain, members] : by_domain) {
      groups_.push_back(std::make_unique<RobotGroup>(options, scene, members));
      for (const RobotInGroup& member : members) group_of_[member.id.index()] = groups_.back().get();
    }
  }

  ExternalCommand CommandFor(RobotId id, const WorldState& state) override {
    return group_of_[id.index()]->CommandFor(id, state);
  }

  void Publish(Tick tick, std::span<const RobotView* const> robots) override {
    for (const RobotView* robot : robots) group_of_[robot->id().index()]->PublishActions(*robot);
    for (const auto& group : groups_) group->Show(tick, robots);
  }

  void AwaitPublished() override {
    for (const auto& group : groups_) group->AwaitPublished();
  }

  void Repeat(Tick tick, std::span<const RobotView* const> robots) override {
    const auto since = std::chrono::steady_clock::now() - kDiscovery;
    for (const auto& group : groups_) group->Repeat(tick, robots, since);
  }

  void ChangeWorld(const Scene& scene) override {
    for (const auto& group : groups_) group->ChangeWorld(scene);
  }
  void Restart() override {
    for (const auto& group : groups_) group->Restart();
  }

  std::vector<std::string> DrainReports() override {
    std::vector<std::string> reports;
    for (const auto& group : groups_) {
      for (std::string& report : group->DrainReports()) reports.push_back(std::move(report));
    }
    return reports;
  }

 private:
  std::vector<std::unique_ptr<RobotGroup>> groups_;  // by ROS domain
  std::vector<RobotGroup*> group_of_;                // by robot; null for robots of other agents
};

}  // namespace

MakeGateway MakeRosGateway(const ros::RosOptions& options) {
  return [options](const Scene& scene, const std::vector<RobotId>& robots) -> std::unique_ptr<Gateway> {
    return std::make_unique<RosGateway>(options, scene, robots);
  };
}

}  // namespace troupe
