#include "robot-agent/controller/create_controller.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <exception>
#include <filesystem>
#include <system_error>

#include "common/base/closest_name.h"
#include "robot-agent/controller/built_in.h"
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

Error LibraryError(const std::string& path, const std::string& message) {
  return {{}, fmt::format("controller library {}: {}", path, message)};
}

// Opens the library (a relative path starts at the working directory), if `allowed` allows it, and calls its factory of
// a controller. The library stays open until the program ends, because exceptions and objects of its types may live as
// long.
Result<std::unique_ptr<Controller>> CreateLibraryController(const std::string& path, const RobotInfo& info,
                                                            const AllowedPaths& allowed) {
  // The path comes with the description of the world, which another process may have sent.
  const std::optional<std::string> resolved = allowed.Resolve(path);
  if (!resolved) {
    return LibraryError(path,
                        "is not allowed, expected a library that the owner of the run has allowed "
                        "(--allow-controllers)");
  }
  // dlopen would search the system's library folders for a bare name.
  std::error_code ignored;
  const std::string absolute = std::filesystem::absolute(*resolved, ignored).string();
  if (!std::filesystem::exists(absolute, ignored)) return LibraryError(path, "no such file: " + absolute);
  void* library = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) return LibraryError(path, fmt::format("cannot be opened: {}", dlerror()));

  using AbiFunction = int();
  using CreateFunction = Controller*(const RobotInfo&);
  auto* abi = reinterpret_cast<AbiFunction*>(dlsym(library, "troupe_controller_abi"));
  auto* create = reinterpret_cast<CreateFunction*>(dlsym(library, "troupe_create_controller"));
  if (abi == nullptr || create == nullptr) {
    return LibraryError(path,
                        "is not a controller: it lacks troupe_controller_abi or troupe_create_controller, expected "
                        "TROUPE_CONTROLLER(Type) in its source");
  }
  if (const int found = abi(); found != TROUPE_CONTROLLER_ABI) {
    return LibraryError(path, fmt::format("found interface version {}, expected {}: build it against this version of "
                                          "Troupe",
                                          found, TROUPE_CONTROLLER_ABI));
  }
  try {
    std::unique_ptr<Controller> controller(create(info));
    if (controller == nullptr) return LibraryError(path, "made no controller");
    return controller;
  } catch (const std::exception& exception) {
    return LibraryError(path, exception.what());
  } catch (...) {
    return LibraryError(path, "threw something that is not a std::exception");
  }
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
