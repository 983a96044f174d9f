// The built-in controllers; docs/controllers.md describes their behaviour and parameters.
#pragma once

#include <memory>
#include <string>

#include "troupe/controller.h"
#include "troupe/result.h"

namespace troupe {

struct BuiltInController {
  const char* name;
  // Checks the parameters. The error names the controller.
  Status (*check)(const std::string& parameters);
  // The error names the controller.
  Result<std::unique_ptr<Controller>> (*create)(const RobotInfo& info);
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
BuiltInController LaserNoise();
BuiltInController Rasterize();
BuiltInController Dynamic();

}  // namespace troupe
