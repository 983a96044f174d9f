#include "worldfile/sites/site_robots.h"

#include <array>
#include <utility>
#include <vector>

#include "troupe/world_description.h"
#include "worldfile/sites/node_maker.h"

namespace troupe {
namespace {

// Lengths in m, angles in degrees, as in world files. The speeds are along x and about z.
struct SiteRobotModel {
  const char* name;
  const char* color;
  std::array<double, 3> size;
  double origin_x;
  double min_speed;
  double max_speed;
  double max_turn_rate;
  double max_acceleration;
  double max_turn_acceleration;
  double lidar_x;
  double lidar_z;  // from the top
  bool is_car = false;
};

// The robots of rmf_demos, by their names there.
constexpr SiteRobotModel kModels[] = {
    {"SiteRobot", "SteelBlue", {0.6, 0.6, 0.5}, 0.0, -0.5, 0.5, 34.4, 0.75, 114.6, 0.25, -0.3},
    {"TinyRobot", "SteelBlue", {0.45, 0.42, 0.3}, -0.1, -0.5, 0.5, 34.4, 0.75, 114.6, 0.05, -0.1},
    {"DeliveryRobot", "DarkOrange", {0.7, 0.7, 1.0}, 0.0, -0.7, 0.7, 34.4, 0.75, 114.6, 0.3, -0.8},
    {"CleanerBotA", "SeaGreen", {1.3, 0.8, 1.3}, 0.46, 0.0, 0.7, 22.9, 0.5, 57.3, 1.05, -1.1},
    {"CleanerBotE", "OliveDrab", {1.1, 0.7, 1.1}, 0.35, 0.0, 0.7, 22.9, 0.5, 57.3, 0.85, -0.9},
    {"HospitalRobot", "MediumPurple", {0.8, 0.6, 1.2}, 0.0, -0.7, 0.7, 34.4, 0.75, 114.6, 0.35, -1.0},
    {"Caddy", "firebrick", {2.3, 1.34, 1.8}, -0.25, -2.0, 2.0, 34.4, 1.0, 57.3, 0.8, -1.4, true},
};

Define DefineOf(WorldNode node) {
  return {std::move(node.type), std::move(node.properties), std::move(node.children), std::move(node.where)};
}

Define MakeLidar(const SourceLocation& where) {
  NodeMaker sensor("sensor", where);
  sensor.Numbers("range", {0.05, 8.0}).Number("fov", 270.0).Number("samples", 181.0);
  NodeMaker ranger("ranger", where);
  ranger.Numbers("size", {0.06, 0.06, 0.06}).Text("color", "black").Number("obstacle_return", 0.0);
  return DefineOf(std::move(ranger.Child(std::move(sensor.node)).node));
}

Define MakeRobot(const SiteRobotModel& model, const SourceLocation& where) {
  const auto symmetric = [](double x, double heading) {
    return std::vector<double>{-x, x, 0.0, 0.0, 0.0, 0.0, -heading, heading};
  };
  std::vector<double> velocity = symmetric(model.max_speed, model.max_turn_rate);
  velocity[0] = model.min_speed;
  NodeMaker robot("position", where);
  robot.Text("drive", StageWordOf(model.is_car ? DriveType::kCar : DriveType::kDifferential));
  if (model.is_car) robot.Number("wheelbase", 1.3);
  robot.Numbers("size", {model.size.begin(), model.size.end()})
      .Numbers("origin", {model.origin_x, 0.0, 0.0, 0.0})
      .Text("color", model.color);
  robot.Numbers("velocity_bounds", velocity);
  robot.Numbers("acceleration_bounds", symmetric(model.max_acceleration, model.max_turn_acceleration));
  NodeMaker lidar("SiteLidar", where);
  lidar.At({model.lidar_x, 0.0, model.lidar_z, 0.0});
  return DefineOf(std::move(robot.Child(std::move(lidar.node)).node));
}

}  // namespace

// Defines and not models: a site, a scenario or a spawn request makes robots of them.
std::map<std::string, Define> SiteRobots(const SourceLocation& where) {
  std::map<std::string, Define> defines;
  defines.emplace("SiteLidar", MakeLidar(where));
  for (const SiteRobotModel& model : kModels) defines.emplace(model.name, MakeRobot(model, where));
  return defines;
}

}  // namespace troupe
