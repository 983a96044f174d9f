// WorldPictures: the topics of the world that are large and come once: map and markers of blocks. Made on a thread of
// their own when somebody reads them, so that no tick waits, and also while nothing ticks.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/ros/ros_options.h"
#include "common/ros_dds/ros_endpoints.h"
#include "common/spatial/scene.h"

namespace troupe {

class WorldPictures {
 public:
  // The scene must outlive it.
  WorldPictures(const ros::RosNode& node, const ros::RosOptions& options, const Scene& scene);
  ~WorldPictures();

 private:
  void Run();
  void WriteMap();
  void WriteBlocks();

  const Scene& scene_;
  const ros::RosOptions options_;
  ros::RosWriter<ros::OccupancyGridMessage> map_;
  ros::RosWriter<ros::MarkerArray> blocks_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;  // last, because it uses all of these
};

}  // namespace troupe
