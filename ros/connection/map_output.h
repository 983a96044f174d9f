// MapOutput: the topic /map in the ROS domain of a single robot. A thread makes it once it has a reader, and then ends.
#pragma once

#include <memory>
#include <thread>

#include "common/spatial/scene.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/messages/ros_options.h"

namespace troupe::ros {

// Writes the section of the static bodies that the topics ask for.
void WriteMap(RosWriter<OccupancyGridMessage>& writer, const Scene& scene, const WorldTopics& topics);

class MapOutput {
 public:
  MapOutput(const RosNode& node, const WorldTopics& topics);
  ~MapOutput();

  // The static bodies have changed. REQUIRES: the scene outlives the output, or the next call.
  void ChangeWorld(const Scene& scene);
  // Call now and then.
  void Poll();

 private:
  void Join();

  RosConnection& connection_;
  const WorldTopics topics_;
  RosWriter<OccupancyGridMessage> map_;
  const Scene* scene_ = nullptr;
  bool written_ = false;
  std::thread thread_;  // last, because it uses all other members
};

}  // namespace troupe::ros
