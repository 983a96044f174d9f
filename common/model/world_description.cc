#include "troupe/world_description.h"

#include <algorithm>
#include <utility>

namespace troupe {

Shape Listed(Shape shape) {
  if (!shape.area) return shape;
  const Transform2 transform(shape.area->X_MA());
  const bool turned = shape.area->X_MA().heading != 0.0;
  shape.area->ForEach([&](const Rectangle& r) {
    if (!turned) {
      shape.rectangles.push_back(r);
      return;
    }
    Block block{{}, shape.rectangles_z};
    for (const Vec2& corner : Corners(r)) block.outline.push_back(transform * corner);
    shape.blocks.push_back(std::move(block));
  });
  if (turned) shape.rectangles_z = {};
  shape.area.reset();
  return shape;
}

Color ColorAt(const ModelDescription& model, std::int64_t time_ns, bool is_switched_on) {
  constexpr double kDark = 0.25;
  Color color = model.color;
  if (!model.blinking.is_light() || (is_switched_on && model.blinking.IsOnAt(time_ns))) return color;
  color.r *= kDark;
  color.g *= kDark;
  color.b *= kDark;
  return color;
}

bool NamesLibrary(const std::string& controller) {
  return controller.find('/') != std::string::npos || controller.ends_with(".so") || controller.ends_with(".py") ||
         ControllerFile(controller) != controller;
}

std::string ControllerFile(const std::string& controller) {
  const std::size_t colon = controller.rfind(".py:");
  return colon == std::string::npos ? controller : controller.substr(0, colon + 3);
}

bool IsInTree(const WorldDescription& world, ModelId model, ModelId root) {
  std::optional<ModelId> at = model;
  // Ends, because a parent has a lower id (Validate).
  while (at && *at != root) at = world.model(*at).parent;
  return at.has_value();
}

bool RobotExists(const WorldDescription& world, RobotId robot) {
  return !world.model(world.robot(robot).root).removed;
}

std::optional<RobotId> FindRobot(const WorldDescription& world, const std::string& name) {
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (world.robots[i].name == name && RobotExists(world, RobotId(i))) return RobotId(i);
  }
  return std::nullopt;
}

std::optional<std::size_t> FindVisitor(const WorldDescription& world, PersonId person) {
  const auto found =
      std::lower_bound(world.visitors.begin(), world.visitors.end(), person,
                       [](const VisitorDescription& visitor, PersonId id) { return visitor.person < id; });
  if (found == world.visitors.end() || found->person != person) return std::nullopt;
  return static_cast<std::size_t>(found - world.visitors.begin());
}

Vec2 TrackAt(const VisitorDescription& visitor, double seconds) {
  const auto next = std::upper_bound(visitor.track_times.begin(), visitor.track_times.end(), seconds);
  if (next == visitor.track_times.begin()) return visitor.track.front();
  if (next == visitor.track_times.end()) return visitor.track.back();
  const auto i = static_cast<std::size_t>(next - visitor.track_times.begin());
  const double part = (seconds - visitor.track_times[i - 1]) / (visitor.track_times[i] - visitor.track_times[i - 1]);
  return visitor.track[i - 1] + part * (visitor.track[i] - visitor.track[i - 1]);
}

std::vector<ModelId> FindStores(const WorldDescription& world) {
  std::vector<ModelId> stores;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    if (world.models[i].power.has_store) stores.emplace_back(i);
  }
  return stores;
}

std::vector<LightPlace> FindLights(const WorldDescription& world) {
  std::vector<LightPlace> lights;
  std::vector<std::optional<RobotId>> robot_of(world.models.size());  // parents come first
  for (std::size_t i = 0; i < world.robots.size(); ++i) robot_of[world.robots[i].root.index()] = RobotId(i);
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.parent) robot_of[i] = robot_of[model.parent->index()];
    if (robot_of[i] && model.blinking.is_light()) lights.push_back({*robot_of[i], ModelId(i)});
  }
  // By robot, then by model: the order of the rows of LightState.
  std::stable_sort(lights.begin(), lights.end(),
                   [](const LightPlace& a, const LightPlace& b) { return a.robot < b.robot; });
  return lights;
}

namespace {

template <typename Parameters>
std::vector<SensorPlace> FindSensors(const WorldDescription& world) {
  std::vector<SensorPlace> places;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const std::vector<SensorDescription>& sensors = world.robots[i].sensors;
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      if (std::holds_alternative<Parameters>(sensors[k].parameters)) places.push_back({RobotId(i), k});
    }
  }
  return places;
}

}  // namespace

std::vector<SensorPlace> FindImus(const WorldDescription& world) {
  return FindSensors<ImuParameters>(world);
}

const CameraParameters* FindCamera(const RobotDescription& robot, std::size_t sensor) {
  return sensor < robot.sensors.size() ? std::get_if<CameraParameters>(&robot.sensors[sensor].parameters) : nullptr;
}

std::vector<SensorPlace> FindCameras(const WorldDescription& world) {
  return FindSensors<CameraParameters>(world);
}

namespace {

template <typename Part>
std::optional<std::size_t> FindPart(const WorldDescription& world, const std::vector<Part>& parts,
                                    const std::string& name) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (world.model(parts[i].model).name == name) return i;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::size_t> FindDoor(const WorldDescription& world, const std::string& name) {
  return FindPart(world, world.doors, name);
}

std::optional<std::size_t> FindLift(const WorldDescription& world, const std::string& name) {
  return FindPart(world, world.lifts, name);
}

}  // namespace troupe
