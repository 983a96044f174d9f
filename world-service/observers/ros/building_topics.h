// BuildingTopics: the map of a building for Open-RMF: a topic whose last message is kept for late readers, and the
// service /get_building_map.
//
// The message is made once, in the constructor, which may take seconds for large drawings; an edit only chooses between
// it and an empty map. Any thread may call ChangeWorld; the service answers on the connection's thread.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "ros/connection/ros_endpoints.h"
#include "troupe/world_description.h"
#include "world-service/observers/ros/building_map.h"

namespace troupe {

class BuildingTopics {
 public:
  // `topic`: its name. `world_name`: of the world of the building; `world`: the one of now, because a run that is
  // continued may have left the building. `files`: that ROS may see. `report`: a line about drawings that are left out.
  BuildingTopics(const ros::RosNode& node, const char* topic, std::shared_ptr<const Site> site, std::string world_name,
                 const AllowedPaths& files, const WorldDescription& world,
                 const std::function<void(const std::string&)>& report);

  // An edit has replaced the world. One that is not of the building has a map without any level.
  void ChangeWorld(const WorldDescription& world);

 private:
  using Request = rmf_building_map_msgs_srv_dds__GetBuildingMap_Request_;
  using Response = rmf_building_map_msgs_srv_dds__GetBuildingMap_Response_;

  bool IsOfBuilding(const WorldDescription& world) const;
  // Of now, with strings and sequences that live as long as this.
  const ros::BuildingMapMessage& map() const { return is_in_building_ ? building_ : empty_; }

  const std::shared_ptr<const Site> site_;
  const std::string world_name_;
  dds::WireArena arena_;
  ros::BuildingMapMessage building_{};
  ros::BuildingMapMessage empty_{};
  std::mutex mutex_;  // guards the flag
  bool is_in_building_;
  ros::RosWriter<ros::BuildingMapMessage> topic_;
  ros::RosService<Request, Response> service_;  // last, because its handler uses all other members
};

}  // namespace troupe
