#include "world-service/observers/ros/building_topics.h"

#include <algorithm>
#include <utility>

#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"

namespace troupe {

BuildingTopics::BuildingTopics(const ros::RosNode& node, const char* topic, std::shared_ptr<const Site> site)
    : site_(std::move(site)),
      map_(node, topic, ros::Latched()),
      service_(
          node, "/get_building_map",
          [this](const ros::RosCaller& caller, const Request&) {
            dds::WireArena arena;
            Response response{};
            {
              const std::lock_guard lock(mutex_);
              response.building_map = Make(arena);
            }
            service_.Respond(caller, response);
          },
          ros::Service(), ros::Serving::kWhenStarted) {
  dds::WireArena arena;
  map_.Write(Make(arena));
  service_.Start();
}

void BuildingTopics::ChangeWorld(const WorldDescription& world) {
  const bool is_in_building = std::all_of(site_->levels.begin(), site_->levels.end(), [&](const SiteLevel& level) {
    return std::any_of(world.models.begin(), world.models.end(), [&](const ModelDescription& model) {
      return !model.parent && !model.removed && model.name == level.name;
    });
  });
  const std::lock_guard lock(mutex_);
  if (std::exchange(is_in_building_, is_in_building) == is_in_building) return;
  dds::WireArena arena;
  map_.Write(Make(arena));
}

ros::BuildingMapMessage BuildingTopics::Make(dds::WireArena& arena) const {
  if (is_in_building_) return ros::MakeBuildingMap(*site_, arena);
  ros::BuildingMapMessage empty{};
  empty.name = arena.Copy("");
  return empty;
}

}  // namespace troupe
