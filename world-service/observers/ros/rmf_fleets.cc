#include "world-service/observers/ros/rmf_fleets.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
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
  constexpr std::size_t kMost = 1'000'000;
  return static_cast<std::int32_t>(std::clamp<std::size_t>(kTicks * robots, 100, kMost));
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
  virtual bool reads() const = 0;
  // `robots`: whose states may come between two calls of Drain.
  virtual void Read(bool reads, std::size_t robots) = 0;
  virtual void Drain(const Consume& consume) = 0;
  virtual void Write(const std::string& fleet, const std::vector<const ros::RmfRobot*>& robots) = 0;
};

namespace {

template <typename RobotMessage, typename FleetMessage>
class TopicsOf final : public RmfFleets::Topics {
 public:
  explicit TopicsOf(const ros::RosNode& node) : node_(node), fleets_(node, "/fleet_states", ros::Stream(kFleetDepth)) {}

  bool wanted() const override { return fleets_.wanted(); }
  bool reads() const override {
    const std::lock_guard lock(mutex_);
    return robots_ != nullptr;
  }
  void Read(bool reads, std::size_t robots) override {
    std::unique_ptr<Reader> reader;  // the one before ends without the mutex
    if (reads) reader = std::make_unique<Reader>(node_, "/robot_state", ros::Stream(DepthFor(robots)));
    const std::lock_guard lock(mutex_);
    reader.swap(robots_);
  }
  void Drain(const Consume& consume) override {
    const std::lock_guard lock(mutex_);
    if (robots_) robots_->Drain([&](const RobotMessage& message) { consume(ros::FromRobotState(message)); });
  }
  void Write(const std::string& fleet, const std::vector<const ros::RmfRobot*>& robots) override {
    dds::WireArena arena;
    fleets_.Write(ros::MakeFleetState<FleetMessage>(fleet, robots, arena));
  }

 private:
  using Reader = ros::RosReader<RobotMessage>;

  const ros::RosNode node_;
  ros::RosWriter<FleetMessage> fleets_;
  mutable std::mutex mutex_;        // guards the pointer
  std::unique_ptr<Reader> robots_;  // null: nothing is wanted
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
  robot_count_ = fleets_.size();
  std::erase_if(robots_, [&](const auto& robot) { return !fleets_.contains(robot.first); });
}

bool RmfFleets::IsToFollow() const {
  return topics_->wanted() != topics_->reads();
}

void RmfFleets::Follow() {
  topics_->Read(topics_->wanted(), robot_count_);
}

void RmfFleets::OnTick(bool is_due) {
  if (!topics_->reads()) return robots_.clear();
  topics_->Drain([&](ros::RmfRobot robot) {
    if (fleets_.contains(robot.name)) robots_[robot.name] = std::move(robot);
  });
  if (!is_due || !topics_->wanted()) return;
  std::map<std::string, std::vector<const ros::RmfRobot*>> members;
  for (const auto& [name, robot] : robots_) members[fleets_.at(name)].push_back(&robot);
  for (const auto& [fleet, robots] : members) topics_->Write(fleet, robots);
}

}  // namespace troupe
