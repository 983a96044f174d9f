#include "robot-agent/ros/ros_gateway.h"

#include <chrono>
#include <map>
#include <memory>
#include <utility>

#include "robot-agent/ros/robot_group.h"

namespace troupe {
namespace {

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

  ExternalCommand CommandFor(RobotId id, Tick tick) override { return group_of_[id.index()]->CommandFor(id, tick); }

  void Publish(Tick tick, std::span<const RobotView* const> robots) override {
    for (const RobotView* robot : robots) group_of_[robot->id().index()]->PublishActions(*robot);
    for (const auto& group : groups_) group->Show(tick, robots);
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
  std::vector<RobotGroup*> group_of_;                // by robot; null for those of other agents
};

}  // namespace

MakeGateway MakeRosGateway(const ros::RosOptions& options) {
  return [options](const Scene& scene, const std::vector<RobotId>& robots) -> std::unique_ptr<Gateway> {
    return std::make_unique<RosGateway>(options, scene, robots);
  };
}

}  // namespace troupe
