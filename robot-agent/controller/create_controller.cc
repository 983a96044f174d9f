#include "robot-agent/controller/create_controller.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>

#include "common/base/paths.h"
#include "common/base/text.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/gripper/manipulator.h"
#include "robot-agent/navigation/steering.h"
#include "robot-agent/navigation/surroundings.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

std::array<BuiltInController, 21> BuiltIns() {
  return {Dynamic(),   Expand(),
          Fasr(),      Fasr2(),
          FasrPlan(),  Fetch(),
          Flock(),     Follow(),
          GoTo(),      Idle(),
          Lanes(),     LaserNoise(),
          Patrol(),    Flocking(),
          Rasterize(), Script(),
          Sink(),      SlotcarController(),
          Source(),    Vda5050Controller(),
          Wander()};
}

std::optional<BuiltInController> FindBuiltIn(const std::string& name) {
  for (const BuiltInController& built_in : BuiltIns()) {
    if (name == built_in.name) return built_in;
  }
  return std::nullopt;
}

Error UnknownName(const std::string& name) {
  return {{},
          fmt::format("unknown controller '{}', expected one of: {}, or the path of a shared library (.so){}", name,
                      fmt::join(BuiltInControllers(), ", "), DidYouMean(name, BuiltInControllers()))};
}

// The library of the package troupe for Python that runs its controllers: in the package itself (pip), in a folder of
// the build, or where python3-troupe is installed. Empty if there is none.
std::string FindPythonHost() {
  Dl_info code{};
  std::error_code failure;
  std::filesystem::path folder;
  if (dladdr(reinterpret_cast<const void*>(&FindPythonHost), &code) != 0 &&
      std::string_view(code.dli_fname).find(".so") != std::string_view::npos) {
    folder = std::filesystem::canonical(code.dli_fname, failure).parent_path();
  } else if (const Result<std::string> programs = ProgramFolder(); programs.ok()) {
    folder = programs.value();
  }
  for (const char* place : {".", "../python/troupe", "../lib/python3/dist-packages/troupe",
                            "../python3/dist-packages/troupe", "python3/dist-packages/troupe"}) {
    const std::filesystem::path host = (folder / place / "python_controllers.so").lexically_normal();
    if (std::filesystem::exists(host, failure)) return host.string();
  }
  return {};
}

Error LibraryError(const std::string& path, const std::string& message) {
  return {{}, fmt::format("controller library {}: {}", path, message)};
}

// Opens a library and returns its function `factory`, of another type; its function `abi` returns the version of the
// interface. The library stays open until the program ends, because exceptions and objects of its types may live as
// long. `path` is for messages.
Result<void*> OpenLibrary(const std::string& file, const char* abi, const char* factory, const std::string& path) {
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) return LibraryError(path, fmt::format("cannot be opened: {}", dlerror()));
  using AbiFunction = int();
  auto* version = reinterpret_cast<AbiFunction*>(dlsym(library, abi));
  void* create = dlsym(library, factory);
  if (version == nullptr || create == nullptr) {
    return LibraryError(path,
                        fmt::format("is not a controller: it lacks {} or {}, expected TROUPE_CONTROLLER(Type) in its "
                                    "source",
                                    abi, factory));
  }
  if (const int found = version(); found != TROUPE_CONTROLLER_ABI) {
    return LibraryError(path, fmt::format("found interface version {}, expected {}: build it against this version of "
                                          "Troupe",
                                          found, TROUPE_CONTROLLER_ABI));
  }
  return create;
}

// The controller that `create`, a function of a library, makes.
template <typename Create>
Result<std::unique_ptr<Controller>> CallFactory(const std::string& path, const Create& create) {
  try {
    std::unique_ptr<Controller> controller(create());
    if (controller == nullptr) return LibraryError(path, "made no controller");
    return controller;
  } catch (const std::exception& exception) {
    return LibraryError(path, exception.what());
  } catch (...) {
    return LibraryError(path, "threw something that is not a std::exception");
  }
}

// Of a file that exists: a class in Python, in the library of the package for Python.
Result<std::unique_ptr<Controller>> CreatePythonController(const std::string& name, const std::string& file,
                                                           const RobotInfo& info) {
  const std::string host = FindPythonHost();
  if (host.empty()) {
    return LibraryError(name, "needs the package for Python, expected python3-troupe to be installed");
  }
  const Result<void*> factory =
      OpenLibrary(host, "troupe_python_controller_abi", "troupe_create_python_controller", host);
  if (!factory.ok()) return factory.error();
  using CreateFunction = Controller*(const RobotInfo&, const char*);
  auto* create = reinterpret_cast<CreateFunction*>(factory.value());
  return CallFactory(name, [&] { return create(info, file.c_str()); });
}

// Uses the file of the controller (a relative path starts at the working directory), if `allowed` allows it.
Result<std::unique_ptr<Controller>> CreateLibraryController(const std::string& name, const RobotInfo& info,
                                                            const AllowedPaths& allowed) {
  const std::string path = ControllerFile(name);
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
  if (path != name) return CreatePythonController(name, absolute, info);
  const Result<void*> factory = OpenLibrary(absolute, "troupe_controller_abi", "troupe_create_controller", path);
  if (!factory.ok()) return factory.error();
  using CreateFunction = Controller*(const RobotInfo&);
  auto* create = reinterpret_cast<CreateFunction*>(factory.value());
  return CallFactory(path, [&] { return create(info); });
}

// dynamic: a body that moves to and fro, for worlds whose obstacles change.

constexpr double kDefaultTurn = 0.8;  // rad/s, of a recovery

struct DynamicParameters {
  double speed = 0.4;     // m/s
  double distance = 2.0;  // m, of each way
  double pause = 1.0;     // s, at the end of each way
};

Result<DynamicParameters> ParseDynamic(const std::string& text) {
  DynamicParameters p;
  Parameters reader("dynamic", text);
  p.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.speed);
  p.distance = reader.ReadNumber("distance", {0.01, 10000.0}).value_or(p.distance);
  p.pause = reader.ReadNumber("pause", {0.0, 1e6}).value_or(p.pause);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class DynamicController final : public Controller {
 public:
  DynamicController(const RobotInfo& info, const DynamicParameters& parameters)
      : parameters_(parameters),
        car_(info.robot->drive.type == DriveType::kCar),
        recovery_(info.robot->drive, {parameters.speed, kDefaultTurn}) {}

  Command Update(const Observation& observation) override {
    traveled_ += std::abs(observation.twist.vx) * observation.interval;
    const bool is_stalled = observation.stalled && observation.time >= wait_until_;
    const bool is_stuck = is_stalled && traveled_ == 0.0 && last_traveled_ == 0.0;  // in both directions
    // A body between two obstacles: neither way is free.
    const double patience = is_stuck ? Recovery::kPatience : Recovery::kNever;
    if (const std::optional<Command> recovery = recovery_.Update(observation, patience)) {
      last_traveled_ = parameters_.distance;
      return *recovery;
    }
    // An obstacle ends the way, too.
    if (traveled_ >= parameters_.distance || is_stalled) {
      last_traveled_ = traveled_;
      traveled_ = 0.0;
      direction_ = -direction_;
      wait_until_ = observation.time + parameters_.pause;
    }
    Command command;
    if (observation.time < wait_until_) return command;
    const double speed = direction_ * parameters_.speed;
    if (car_) {
      command.speed = speed;
    } else {
      command.twist.vx = speed;
    }
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<DynamicController>(*this); }

 private:
  DynamicParameters parameters_;
  bool car_;
  Recovery recovery_;
  double direction_ = 1.0;                                          // 1: ahead
  double traveled_ = 0.0;                                           // m, on this way
  double last_traveled_ = std::numeric_limits<double>::infinity();  // m, on the previous way
  double wait_until_ = 0.0;                                         // s, simulated
};

Status CheckDynamic(const std::string& parameters) {
  const Result<DynamicParameters> parsed = ParseDynamic(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateDynamic(const RobotInfo& info) {
  const Result<DynamicParameters> parameters = ParseDynamic(info.parameters);
  if (!parameters.ok()) return parameters.error();
  return std::unique_ptr<Controller>(std::make_unique<DynamicController>(info, parameters.value()));
}

// idle: stands still.

class IdleController final : public Controller {
 public:
  Command Update(const Observation&) override { return {}; }
  std::unique_ptr<Controller> Clone() const override { return std::make_unique<IdleController>(*this); }
};

Status CheckIdle(const std::string& parameters) {
  return Parameters("idle", parameters).Finish();
}

Result<std::unique_ptr<Controller>> CreateIdle(const RobotInfo& info) {
  if (Status status = CheckIdle(info.parameters); !status.ok()) return status.error();
  return std::unique_ptr<Controller>(std::make_unique<IdleController>());
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
  const std::optional<BuiltInController> built_in = FindBuiltIn(name);
  return built_in ? built_in->create(info) : UnknownName(name);
}

Status CheckController(const std::string& name, const std::string& parameters) {
  if (NamesLibrary(name)) {
    if (name.ends_with(".py") || name.ends_with(".py:")) {
      return LibraryError(name, "names no class, expected FILE.py:CLASS");
    }
    // The library alone knows its keys.
    return Parameters(fmt::format("controller library {}", name), parameters).status();
  }
  const std::optional<BuiltInController> built_in = FindBuiltIn(name);
  return built_in ? built_in->check(parameters) : UnknownName(name);
}

RobotInfo InfoInWorld(const WorldDescription& world, RobotId robot, const Manipulator& manipulator,
                      std::span<const LightPlace> lights) {
  const RobotDescription& description = world.robot(robot);
  RobotInfo info{.id = robot, .robot = &description, .parameters = description.controller.parameters};
  info.joints = manipulator.joints();
  info.grippers = manipulator.grippers();
  for (const LightPlace& light : lights) {
    std::string_view name = world.model(light.model).name;
    if (name.starts_with(description.name + ".")) name.remove_prefix(description.name.size() + 1);
    info.lights.push_back({light.model, name});
  }
  for (const DoorDescription& door : world.doors) info.doors.push_back({.name = world.model(door.model).name});
  for (const LiftDescription& lift : world.lifts) {
    LiftInfo& seen = info.lifts.emplace_back();
    seen.name = world.model(lift.model).name;
    for (const LiftFloor& floor : lift.floors) {
      seen.floors.push_back(floor.name);
      seen.doors.push_back(floor.doors);
    }
  }
  info.start = world.model(description.root).X_PM;
  info.lane_graphs = world.lane_graphs;
  return info;
}

Status CheckControllerNeeds(const WorldDescription& world, std::span<const RobotId> robots) {
  const std::vector<LightPlace> lights = FindLights(world);
  const auto is_before = [](const LightPlace& a, const LightPlace& b) { return a.robot < b.robot; };
  for (const RobotId robot : robots) {
    const RobotDescription& description = world.robot(robot);
    const std::optional<BuiltInController> controller = FindBuiltIn(description.controller.name);
    if (!controller || controller->check_in_world == nullptr) continue;
    const auto [first, last] = std::equal_range(lights.begin(), lights.end(), LightPlace{robot, {}}, is_before);
    const std::span<const LightPlace> own = std::span(lights).subspan(static_cast<std::size_t>(first - lights.begin()),
                                                                      static_cast<std::size_t>(last - first));
    RobotInfo info = InfoInWorld(world, robot, Manipulator(world, robot), own);
    for (const SensorDescription& sensor : description.sensors) info.sensors.push_back({&sensor, {}});
    if (Status status = controller->check_in_world(info); !status.ok()) {
      return Error{{}, fmt::format("robot '{}': {}", description.name, status.error().message)};
    }
  }
  return Status();
}

Status CheckGoalOfController(const Scene& scene, RobotId robot, const Pose& X_WR, const Goal& goal) {
  const WorldDescription& world = WorldIn(scene);
  constexpr double kLevel = 1.0;  // m: a goal on a table is on the level of the floor
  const std::optional<BuiltInController> controller = FindBuiltIn(world.robot(robot).controller.name);
  if (!controller) return Status();
  if (controller->check_goal != nullptr) {
    return controller->check_goal(InfoInWorld(world, robot, Manipulator(world, robot), {}), X_WR, goal);
  }
  for (const double z : goal.heights) {
    if (std::fabs(z - X_WR.z) <= kLevel) continue;
    return BadInput(
        fmt::format("the goal is at a height of {:.2f} m and the robot at {:.2f} m, and controller {} stays "
                    "on its level",
                    z, X_WR.z, controller->name));
  }
  return controller->check_way != nullptr ? controller->check_way(scene, robot, X_WR, goal) : Status();
}

BuiltInController Dynamic() {
  return {"dynamic", CheckDynamic, CreateDynamic};
}

BuiltInController Idle() {
  return {"idle", CheckIdle, CreateIdle};
}

}  // namespace troupe
