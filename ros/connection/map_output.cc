#include "ros/connection/map_output.h"

#include "common/spatial/occupancy_grid.h"
#include "ros/connection/ros_qos.h"
#include "ros/messages/convert_world.h"

namespace troupe::ros {

void WriteMap(RosWriter<OccupancyGridMessage>& writer, const Scene& scene, const WorldTopics& topics) {
  const OccupancyGrid grid =
      MakeOccupancyGrid(scene, topics.map_resolution, topics.map_height.value_or(UsualMapHeight(scene)));
  dds::WireArena arena;
  writer.Write(MakeMap(grid, arena));
}

MapOutput::MapOutput(const RosNode& node, const WorldTopics& topics)
    : connection_(*node.connection), topics_(topics), map_(node, "/map", Latched()) {}

MapOutput::~MapOutput() {
  Join();
}

void MapOutput::Join() {
  if (thread_.joinable()) thread_.join();
}

void MapOutput::ChangeWorld(const Scene& scene) {
  Join();
  scene_ = &scene;
  written_ = false;
}

void MapOutput::Poll() {
  if (written_ || scene_ == nullptr || !map_.wanted()) return;
  written_ = true;
  Join();
  thread_ = std::thread([this] {
    WriteMap(map_, *scene_, topics_);
    connection_.Flush();
  });
}

}  // namespace troupe::ros
