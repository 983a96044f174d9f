// BuildingTopics: the map of a building for Open-RMF: a topic whose last message is kept for late readers, and the
// service /get_building_map.
#pragma once

#include <memory>
#include <mutex>

#include "ros/connection/ros_endpoints.h"
#include "troupe/world_description.h"
#include "world-service/observers/ros/building_map.h"

namespace troupe {

class BuildingTopics {
 public:
  // `topic`: its name.
  BuildingTopics(const ros::RosNode& node, const char* topic, std::shared_ptr<const Site> site);

  // An edit has replaced the world. One that has not the levels of the building has a map without any.
  void ChangeWorld(const WorldDescription& world);

 private:
  using Request = rmf_building_map_msgs_srv_dds__GetBuildingMap_Request_;
  using Response = rmf_building_map_msgs_srv_dds__GetBuildingMap_Response_;

  // REQUIRES: the mutex is held.
  ros::BuildingMapMessage Make(dds::WireArena& arena) const;

  const std::shared_ptr<const Site> site_;
  std::mutex mutex_;  // guards the flag
  bool is_in_building_ = true;
  ros::RosWriter<ros::BuildingMapMessage> map_;
  ros::RosService<Request, Response> service_;  // last, because its handler uses all other members
};

}  // namespace troupe
