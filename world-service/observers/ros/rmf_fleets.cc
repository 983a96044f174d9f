#include "world-service/observers/ros/rmf_fleets.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"

namespace troupe {
namespace {

constexpr std::int32_t kFleetDepth = 10;  // as of the adapters of Open-RMF

// Of the topic of all robots, which write in the same tick.
std::int32_t DepthFor(std::size_t robots) {
  constexpr std::size_t kTicks = 4;
  constexpr std::size_t kMaxDepth = 1'000'000;
  return static_cast<std::int32_t>(std::clamp<std::size_t>(kTicks * robots, 100, kMaxDepth));
}

}  // namespace

class RmfFleets::Topics {
 public:
  using Consume = std::function<void(ros::RmfRobot)>;

  Topics() = default;
  virtual ~Topics() = default;
  Topics(const Topics&) = delete;
  Topics& operator=(const Topics&) = delete;

  virtual bool wanted() const = 0;
  // Whether the states of robots are read.
  virtual bool reads() const = 0;
  // `robots`: whose states may come between two calls of Drain.
  virtual void StartReading(std::size_t robots) = 0;
  virtual void StopReading() = 0;
  virtual void Drain(const Consume& consume) = 0;
  virtual void Write(const std::string& fleet, const std::vector<const ros::RmfRobot*>& robots) = 0;
};

namespace {

template <typename RobotMessage, typename FleetMessage>
class TopicsOf final : public RmfFleets::Topics {
 public:
  explicit TopicsOf(const ros::RosNode& node) : node_(node), fleets_(node, "/fleet_states", ros::Stream(kFleetDepth)) {}

  bool wanted() const override { return fleets_.wanted(); }
  bool reads() const override { return robots_.has_value(); }
  void StartReading(std::size_t robots) override {
    robots_.emplace(node_, "/robot_state", ros::Stream(DepthFor(robots)));
    node_.connection->Announce();
  }
  void StopReading() override {
    robots_.reset();
    node_.connection->Announce();
  }
  void Drain(const Consume& consume) override {
    robots_->Drain([&](const RobotMessage& message) { consume(ros::FromRobotState(message)); });
  }
  void Write(const std::string& fleet, const std::vector<const ros::RmfRobot*>& robots) override {
    dds::WireArena arena;
    fleets_.Write(ros::MakeFleetState<FleetMessage>(fleet, robots, arena));
  }

 private:
  const ros::RosNode node_;
  ros::RosWriter<FleetMessage> fleets_;
  std::optional<ros::RosReader<RobotMessage>> robots_;
};

std::unique_ptr<RmfFleets::Topics> MakeTopics(const ros::RosNode& node) {
  if (node.connection->distribution() >= ros::Distribution::kKilted) {
    return std::make_unique<TopicsOf<ros::LaterRobotStateMessage, ros::LaterFleetStateMessage>>(node);
  }
  return std::make_unique<TopicsOf<ros::RobotStateMessage, ros::FleetStateMessage>>(node);
}

}  // namespace

RmfFleets::RmfFleets(const ros::RosNode& node) : topics_(MakeTopics(node)) {}

RmfFleets::~RmfFleets() = default;

void RmfFleets::ChangeWorld(const WorldDescription& world) {
  fleets_.clear();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i))) fleets_[world.robots[i].name] = ros::FleetOf(world, RobotId(i));
  }
  std::erase_if(robots_, [&](const auto& robot) { return !fleets_.contains(robot.first); });
}

void RmfFleets::OnTick(bool is_due) {
  if (!topics_->wanted()) {
    if (topics_->reads()) topics_->StopReading();
    return robots_.clear();
  }
  if (!topics_->reads()) topics_->StartReading(fleets_.size());
  topics_->Drain([&](ros::RmfRobot robot) {
    if (fleets_.contains(robot.name)) robots_[robot.name] = std::move(robot);
  });
  if (!is_due) return;
  std::map<std::string, std::vector<const ros::RmfRobot*>> members;
  for (const auto& [name, robot] : robots_) members[fleets_.at(name)].push_back(&robot);
  for (const auto& [fleet, robots] : members) topics_->Write(fleet, robots);
}

}  // namespace troupe
