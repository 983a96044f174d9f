#include "robot-agent/controller/create_controller.h"

#include <fmt/format.h>

#include <array>

#include "common/base/closest_name.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/library_controller.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

std::array<BuiltInController, 18> BuiltIns() {
  return {Dynamic(), Expand(),     Fasr(),   Fasr2(),    FasrPlan(),  Fetch(),  Flock(), Follow(), GoTo(),
          Idle(),    LaserNoise(), Patrol(), Flocking(), Rasterize(), Script(), Sink(),  Source(), Wander()};
}

Error UnknownName(const std::string& name) {
  return {{},
          fmt::format("unknown controller '{}', expected one of: {}, or the path of a shared library (.so){}", name,
                      fmt::join(BuiltInControllers(), ", "), DidYouMean(name, BuiltInControllers()))};
}

}  // namespace

std::vector<std::string> BuiltInControllers() {
  std::vector<std::string> names;
  for (const BuiltInController& built_in : BuiltIns()) names.emplace_back(built_in.name);
  return names;
}

Result<std::unique_ptr<Controller>> CreateController(const RobotInfo& info, const AllowedPaths& libraries) {
  const std::string& name = info.robot->controller.name;
  if (NamesLibrary(name)) return CreateLibraryController(name, info, libraries);
  for (const BuiltInController& built_in : BuiltIns()) {
    if (name == built_in.name) return built_in.create(info);
  }
  return UnknownName(name);
}

Status CheckController(const std::string& name, const std::string& parameters) {
  if (NamesLibrary(name)) {
    // The library alone knows its keys.
    return Parameters(fmt::format("controller library {}", name), parameters).status();
  }
  for (const BuiltInController& built_in : BuiltIns()) {
    if (name == built_in.name) return built_in.check(parameters);
  }
  return UnknownName(name);
}

}  // namespace troupe
