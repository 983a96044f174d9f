#include "world-service/ros/world_pictures.h"

#include <chrono>

#include "common/ros/convert_world.h"
#include "common/ros/names.h"
#include "common/ros/robot_frames.h"
#include "common/ros_dds/ros_qos.h"

namespace troupe {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(100);

}  // namespace

WorldPictures::WorldPictures(const ros::RosNode& node, const ros::RosOptions& options, const Scene& scene)
    : scene_(scene),
      options_(options),
      map_(node, "/map", ros::Latched()),
      blocks_(node, "/blocks", ros::Latched()),
      thread_([this] { Run(); }) {}

WorldPictures::~WorldPictures() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void WorldPictures::Run() {
  bool map_written = false;
  bool blocks_written = false;
  std::unique_lock lock(mutex_);
  while (!stop_ && !(map_written && blocks_written)) {
    lock.unlock();
    if (!map_written && map_.wanted()) {
      WriteMap();
      map_written = true;
    }
    if (!blocks_written && blocks_.wanted()) {
      WriteBlocks();
      blocks_written = true;
    }
    lock.lock();
    wake_.wait_for(lock, kPeriod, [this] { return stop_; });
  }
}

void WorldPictures::WriteMap() {
  const OccupancyGrid grid =
      MakeOccupancyGrid(scene_, options_.map_resolution, options_.map_height.value_or(UsualMapHeight(scene_)));
  dds::WireArena arena;
  map_.Write(ros::MakeMap(grid, arena));
}

void WorldPictures::WriteBlocks() {
  std::vector<std::vector<std::string>> frames;
  const std::vector<std::string> names = ros::RobotNames(scene_.world());
  for (std::size_t i = 0; i < names.size() && !options_.namespaced_tf; ++i) {  // their frames are in trees of their own
    frames.push_back(ros::RobotFramesOf(scene_, RobotId(i), ros::FramesOf(names[i], true)).links);
  }
  dds::WireArena arena;
  blocks_.Write(ros::MakeBlockMarkers(scene_, frames, arena));
}

}  // namespace troupe
