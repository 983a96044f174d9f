// The built-in controllers; docs/controllers.md says what each does and what its parameters mean.
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "robot-agent/controller/controller.h"

namespace troupe {

struct BuiltInController {
  const char* name;
  // "" or what is wrong with the parameters.
  std::string (*check)(const std::string& parameters);
  // The error is for people, and names the controller.
  Result<std::unique_ptr<Controller>> (*create)(const RobotInfo& info);
};

BuiltInController Idle();
BuiltInController Wander();
BuiltInController Expand();
BuiltInController Script();
BuiltInController Fetch();

}  // namespace troupe
