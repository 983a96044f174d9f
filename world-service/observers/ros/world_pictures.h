// WorldPictures: the large topics of the world, which are sent once: the map and the markers of the blocks. A thread of
// its own makes them as soon as they have a reader, so that no tick waits for them, and a paused run sends them too.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "common/spatial/scene.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/messages/ros_options.h"

namespace troupe {

class WorldPictures {
 public:
  WorldPictures(const ros::RosNode& node, const ros::RosOptions& options, std::shared_ptr<const Scene> scene);
  ~WorldPictures();

  // An edit has replaced the world: both topics are sent again.
  void ChangeWorld(std::shared_ptr<const Scene> scene);

 private:
  void Run();
  void WriteBlocks(const Scene& scene, bool replaces);

  const ros::RosOptions options_;
  ros::RosWriter<ros::OccupancyGridMessage> map_;
  ros::RosWriter<ros::MarkerArray> blocks_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::shared_ptr<const Scene> scene_;
  bool map_written_ = false;
  bool blocks_written_ = false;
  bool blocks_replaced_ = false;  // viewers may show markers of the world before
  std::thread thread_;            // last, because it uses all other members
};

}  // namespace troupe
