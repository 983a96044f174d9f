#include "world-service/observers/ros/building_topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"

namespace troupe {

BuildingTopics::BuildingTopics(const ros::RosNode& node, const char* topic, std::shared_ptr<const Site> site,
                               std::string world_name, const AllowedPaths& files, const WorldDescription& world,
                               const std::function<void(const std::string&)>& report)
    : site_(std::move(site)),
      world_name_(std::move(world_name)),
      is_in_building_(IsOfBuilding(world)),
      topic_(node, topic, ros::Latched()),
      service_(
          node, "/get_building_map",
          [this](const ros::RosCaller& caller, const Request&) {
            Response response{};
            {
              const std::lock_guard lock(mutex_);
              response.building_map = map();
            }
            service_.Respond(caller, response);
          },
          ros::Service(), ros::Serving::kWhenStarted) {
  std::vector<std::string> left_out;
  building_ = ros::MakeBuildingMap(*site_, files, arena_, left_out);
  empty_.name = arena_.Copy("");
  if (!left_out.empty()) {
    report(fmt::format("the map of the building is without {} of its drawings: {}{}", left_out.size(), left_out.front(),
                       left_out.size() > 1 ? "; and others" : ""));
  }
  topic_.Write(map());
  service_.Start();
}

// Other buildings may have levels of the same names.
bool BuildingTopics::IsOfBuilding(const WorldDescription& world) const {
  return world.name == world_name_ &&
         std::all_of(site_->levels.begin(), site_->levels.end(), [&](const SiteLevel& level) {
           return std::any_of(world.models.begin(), world.models.end(), [&](const ModelDescription& model) {
             return !model.parent && !model.removed && model.name == level.name;
           });
         });
}

void BuildingTopics::ChangeWorld(const WorldDescription& world) {
  const bool is_in_building = IsOfBuilding(world);
  const std::lock_guard lock(mutex_);
  if (std::exchange(is_in_building_, is_in_building) != is_in_building) topic_.Write(map());
}

}  // namespace troupe
