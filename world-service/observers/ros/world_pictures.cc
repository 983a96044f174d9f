#include "world-service/observers/ros/world_pictures.h"

#include <chrono>
#include <utility>

#include "ros/connection/map_output.h"
#include "ros/connection/ros_qos.h"
#include "ros/messages/convert_world.h"
#include "ros/messages/robot_frames.h"
#include "ros/messages/robot_in_ros.h"

namespace troupe {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(100);

}  // namespace

WorldPictures::WorldPictures(const ros::RosNode& node, const ros::RosOptions& options,
                             std::shared_ptr<const Scene> scene)
    : options_(options),
      map_(node, "/map", ros::Latched()),
      blocks_(node, "/blocks", ros::Latched()),
      scene_(std::move(scene)),
      thread_([this] { Run(); }) {}

WorldPictures::~WorldPictures() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void WorldPictures::ChangeWorld(std::shared_ptr<const Scene> scene) {
  {
    const std::lock_guard lock(mutex_);
    scene_ = std::move(scene);
    blocks_replaced_ = blocks_replaced_ || blocks_written_;
    map_written_ = blocks_written_ = false;
  }
  wake_.notify_one();
}

void WorldPictures::Run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    const std::shared_ptr<const Scene> scene = scene_;
    const bool map_due = !std::exchange(map_written_, map_written_ || map_.wanted()) && map_written_;
    const bool blocks_due = !std::exchange(blocks_written_, blocks_written_ || blocks_.wanted()) && blocks_written_;
    const bool replaces = blocks_replaced_;
    lock.unlock();
    if (map_due) ros::WriteMap(map_, *scene, options_.world);
    if (blocks_due) WriteBlocks(*scene, replaces);
    lock.lock();
    const auto changed = [&] { return stop_ || scene_ != scene; };
    if (map_written_ && blocks_written_) {
      wake_.wait(lock, changed);
    } else {
      wake_.wait_for(lock, kPeriod, changed);
    }
  }
}

void WorldPictures::WriteBlocks(const Scene& scene, bool replaces) {
  std::vector<std::vector<std::string>> frames;
  // Namespaced frames are in separate trees, and so are those in other domains.
  for (std::size_t i = 0; i < scene.world().robots.size() && !options_.names.namespaced_tf; ++i) {
    const ros::RobotInRos robot =
        ros::FindRobotInRos(scene.world(), RobotId(i), options_.network.domain, options_.names);
    frames.emplace_back();
    if (!robot.alone) frames.back() = ros::RobotFramesOf(scene, RobotId(i), robot.frames).links;
  }
  dds::WireArena arena;
  blocks_.Write(ros::MakeBlockMarkers(scene, frames, arena, replaces));
}

}  // namespace troupe
