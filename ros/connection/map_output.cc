#include "ros/connection/map_output.h"

#include "common/spatial/occupancy_grid.h"
#include "ros/connection/ros_qos.h"
#include "ros/messages/convert_world.h"

namespace troupe::ros {

void WriteMap(RosWriter<OccupancyGridMessage>& writer, const Scene& scene, const RosOptions& options) {
  const OccupancyGrid grid =
      MakeOccupancyGrid(scene, options.map_resolution, options.map_height.value_or(UsualMapHeight(scene)));
  dds::WireArena arena;
  writer.Write(MakeMap(grid, arena));
}

MapOutput::MapOutput(const RosNode& node, const RosOptions& options)
    : options_(options), map_(node, "/map", Latched()) {}

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
  thread_ = std::thread([this] { WriteMap(map_, *scene_, options_); });
}

}  // namespace troupe::ros
