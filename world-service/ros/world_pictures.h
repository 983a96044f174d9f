// WorldPictures: the topics of the world that are large and come once: map and markers of blocks. Made on a thread of
// their own when somebody reads them, so that no tick waits, and also while nothing ticks.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "common/ros/ros_options.h"
#include "common/ros_dds/ros_endpoints.h"
#include "common/spatial/scene.h"

namespace troupe {

class WorldPictures {
 public:
  WorldPictures(const ros::RosNode& node, const ros::RosOptions& options, std::shared_ptr<const Scene> scene);
  ~WorldPictures();

  // They are written again, of another world.
  void ChangeWorld(std::shared_ptr<const Scene> scene);

 private:
  void Run();
  void WriteMap(const Scene& scene);
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
  bool blocks_replaced_ = false;  // there may be markers of another world
  std::thread thread_;  // last, because it uses all of these
};

}  // namespace troupe
