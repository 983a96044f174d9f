// What a vehicle of VDA 5050 knows of itself and of the things around it: its loads, its energy and its place, for its
// state; its size and abilities, for its factsheet.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fleet/vehicle.h"
#include "fleet/vehicle_settings.h"
#include "robot-agent/controller/vehicle_path.h"
#include "robot-agent/navigation/surroundings.h"
#include "troupe/controller.h"
#include "troupe/rectangle.h"

namespace troupe {

// An object that the vehicle carries, or that it can take.
struct VehicleLoad {
  ModelId model;  // its root
  ObjectId object;
  std::string name;
  Vec2 position{0.0, 0.0};  // m, W
};

// The objects that rest on the robot, or that its grippers hold, in id order.
std::vector<VehicleLoad> LoadsOf(const Surroundings& around, RobotId robot);
// The object that is named `name`, or that of an empty name: the nearest one to `place`, of those within kLoadReach of
// the robot that nothing holds or carries and nothing rests on. Nothing: there is none.
std::optional<VehicleLoad> FindLoad(const Surroundings& around, RobotId robot, const Vec2& place,
                                    const std::string& name);
// The place of a station: a model or a vertex of lanes of that name.
std::optional<Vec2> FindStation(const Surroundings& around, const std::string& name);
// The box around a body without its joints' motions, along the axes of its frame. Empty: it has none.
Rectangle BoxOf(const Surroundings& around, BodyId body);

fleet::VehicleReadings MakeReadings(const Surroundings& around, const Observation& observation, RobotId robot,
                                    const fleet::VehicleSettings& settings);

// m, from the floor to the top of the vehicle and of what it carries.
double HeightOf(const Surroundings& around, RobotId robot);

// The way along the base as a curve of degree 1, at most 100 points of it.
fleet::Trajectory TrajectoryOf(const VehicleWay& way);

// Adds the way along the base as the paths that a vehicle of 3.0 shows, at most 100 points of it; `speed`: m/s.
// `now_ms`: ms since 1970.
void AddPaths(const VehicleWay& way, const fleet::VehicleMemory& memory, double speed, std::int64_t now_ms,
              fleet::VehicleReadings& readings);

// `has_battery`: the robot has a store of energy.
fleet::VehicleProfile MakeProfile(const Surroundings& around, const RobotInfo& info,
                                  const fleet::VehicleSettings& settings, bool has_battery);

}  // namespace troupe
