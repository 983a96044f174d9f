// The built-in controllers; docs/controllers.md describes their behaviour and parameters.
//
// Each controller is one source (pairs that share code are one), and a function that returns its entry of the table;
// create_controller.cc lists the functions. `check` reads parameters without a robot, for loaders and forms; `create`
// reads the same with the robot, and finds the sensors that it needs. Both errors begin with the controller's name.
//
// All of them follow the rules of troupe/controller.h: no clock, no random numbers but Observation::Random, and the
// mathematics of troupe/deterministic_math.h. They are values (Clone is a copy), so that snapshots and branches
// continue them.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "robot-agent/navigation/mapped_route.h"
#include "troupe/controller.h"
#include "troupe/parameters.h"
#include "troupe/result.h"

namespace troupe {

class Scene;

struct BuiltInController {
  const char* name;
  // Checks the parameters. The error names the controller.
  Status (*check)(const std::string& parameters);
  // The error names the controller.
  Result<std::unique_ptr<Controller>> (*create)(const RobotInfo& info);
  // Checks what the controller needs of the robot and the world, by an info without poses of sensors, break beams and
  // places of doors and lifts (InfoInWorld). Null: nothing.
  Status (*check_in_world)(const RobotInfo& info) = nullptr;
  // Checks that the robot can reach a goal from its pose. The error is the reason. Null: a goal on its level.
  Status (*check_goal)(const RobotInfo& info, const Pose& X_WR, const Goal& goal) = nullptr;
  // Checks, of a goal that passed, that a way leads there. The error is the reason. Null: nothing.
  Status (*check_way)(const Scene& scene, RobotId robot, const Pose& X_WR, const Goal& goal) = nullptr;
};

BuiltInController Idle();
BuiltInController Wander();
BuiltInController Expand();
BuiltInController Script();
BuiltInController Fetch();
BuiltInController Follow();
BuiltInController GoTo();
BuiltInController Patrol();
BuiltInController Fasr();
BuiltInController Fasr2();
BuiltInController FasrPlan();
BuiltInController Source();
BuiltInController Sink();
BuiltInController Flock();
BuiltInController Flocking();
BuiltInController Lanes();
BuiltInController LaserNoise();
BuiltInController Rasterize();
BuiltInController Dynamic();
BuiltInController SlotcarController();
BuiltInController Vda5050Controller();

// The parameters of controllers that make a map.
// `map_size` and `cell`, both in m.
inline MappedRoute::Settings ReadMapSettings(Parameters& reader, double clearance) {
  MappedRoute::Settings settings;
  settings.clearance = clearance;
  settings.side = reader.ReadNumber("map_size", {1.0, 10000.0}).value_or(settings.side);
  settings.cell = reader.ReadNumber("cell", {0.02, 10.0}).value_or(settings.cell);
  if (settings.side / settings.cell > EvidenceGrid::kMaxCells) {
    reader.Fail(fmt::format("a map of {:g} m with cells of {:g} m has more than {:g} cells along a side", settings.side,
                            settings.cell, EvidenceGrid::kMaxCells));
  }
  return settings;
}

}  // namespace troupe
