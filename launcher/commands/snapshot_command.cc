#include "launcher/commands/snapshot_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/distinct_files.h"
#include "common/base/file.h"
#include "common/base/print.h"
#include "common/picture/heat_map.h"
#include "common/sensing/sensor_suite.h"
#include "launcher/commands/check_command.h"
#include "launcher/commands/commands.h"
#include "library/save_picture.h"
#include "recording/recording.h"
#include "troupe/picture_options.h"
#include "troupe/simulation.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/service/requested_file.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

// Before the run: an older picture is not changed by one that fails.
Status CheckPicture(const SnapshotOptions& options) {
  LoadOverrides overrides;
  overrides.controller = options.controller;
  const auto inputs = [&] { return InputFilesOf(options.file, overrides); };
  if (Status problem = CheckDistinct({{"-o", options.output}}, inputs); !problem.ok()) return problem;
  const Status status = CheckWritable(options.output);
  return status.ok() ? status : Error{{options.output, 0, 0}, "cannot write: " + status.error().message};
}

PictureOptions ToPictureOptions(const SnapshotOptions& options) {
  PictureOptions picture;
  picture.view = options.view == "side" ? PictureView::kSide : PictureView::kTop;
  picture.width = options.width;
  picture.meters = options.meters;
  if (options.center.size() == 2) picture.center = Vec2(options.center[0], options.center[1]);
  return picture;
}

// The world without the bodies of models whose base is not at one of these heights, m: a level of a building. The
// lowest of its models that stand still is moved to the ground, and all others with it.
struct Storey {
  WorldDescription world;
  WorldState state;
};

// Parents precede their children in the list of models, so one pass finds all heights.
Storey AtHeights(WorldDescription world, WorldState state, double min, double max) {
  std::vector<std::optional<double>> moving(world.models.size());  // m, of the models of robots and objects
  for (std::size_t i = 0; i < world.robots.size(); ++i) moving[world.robots[i].root.index()] = state.robots[i].X_WR.z;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    moving[world.objects[i].index()] = state.objects[i].X_WO.z;
  }
  for (std::size_t i = 0; i < world.people.size(); ++i) moving[world.people[i].root.index()] = state.people[i].X_WP.z;
  const ShapeId nothing(world.shapes.size());
  world.shapes.emplace_back();
  std::vector<double> heights(world.models.size());
  double ground = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    ModelDescription& model = world.models[i];
    if (model.parent && moving[model.parent->index()]) moving[i] = moving[model.parent->index()];
    heights[i] = moving[i] ? *moving[i] : model.X_PM.z + (model.parent ? heights[model.parent->index()] : 0.0);
    if (heights[i] >= min && heights[i] < max) {
      if (!moving[i] && !model.parent) ground = std::min(ground, heights[i]);
      continue;
    }
    model.shape = nothing;
    model.removed = moving[i].has_value();  // then no name of a robot is shown either
  }
  if (!std::isfinite(ground)) ground = 0.0;
  for (ModelDescription& model : world.models) model.X_PM.z -= model.parent ? 0.0 : ground;
  for (RobotState& robot : state.robots) robot.X_WR.z -= ground;
  for (ObjectState& object : state.objects) object.X_WO.z -= ground;
  for (PersonState& person : state.people) person.X_WP.z -= ground;
  return {std::move(world), std::move(state)};
}

// A camera of a world.
struct FoundCamera {
  RobotId robot;
  std::size_t sensor;
};

// Finds a camera by "robot" (its first camera) or "robot/sensor".
Result<FoundCamera> FindCamera(const WorldDescription& world, const std::string& name) {
  const std::size_t slash = name.find('/');
  const std::string sensor_name = slash == std::string::npos ? "" : name.substr(slash + 1);
  const std::optional<RobotId> robot = FindRobot(world, name.substr(0, slash));
  if (!robot) return Error{{}, fmt::format("--camera: found no robot '{}'", name.substr(0, slash))};
  const std::vector<SensorDescription>& sensors = world.robot(*robot).sensors;
  std::string known;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (!std::holds_alternative<CameraParameters>(sensors[i].parameters)) continue;
    if (slash == std::string::npos || sensors[i].name == sensor_name) return FoundCamera{*robot, i};
    known += (known.empty() ? "" : ", ") + sensors[i].name;
  }
  return Error{{},
               fmt::format("--camera: found no camera '{}', expected {}", name,
                           known.empty() ? "a robot with a camera" : "one of: " + known)};
}

// The map that the options ask for, without any tick.
HeatMap MakeHeatMap(const SnapshotOptions& options) {
  HeatMap heat(FindByName<HeatKind>(options.heat).value_or(HeatKind::kRobots),
               options.cell.value_or(HeatMap::kDefaultCell));
  if (!options.heights.empty()) heat.SetHeights(options.heights[0], options.heights[1]);
  return heat;
}

// What a heat map cannot be combined with.
Status CheckHeat(const SnapshotOptions& options) {
  const auto refuse = [](const std::string& problem) { return Error{{}, problem, ErrorCode::kBadInput}; };
  if (options.heat.empty()) {
    if (options.cell) return refuse("found --cell, expected it with --heat");
    if (options.since > 0) return refuse("found --since, expected it with --heat");
    return {};
  }
  if (options.cell && (*options.cell < HeatMap::kMinCell || *options.cell > HeatMap::kMaxCell)) {
    return refuse(
        fmt::format("--cell: found {} m, expected {} to {} m", *options.cell, HeatMap::kMinCell, HeatMap::kMaxCell));
  }
  if (options.view == "side") return refuse("found --heat with --view side, expected a view from above");
  if (!options.camera.empty()) return refuse("found --heat with --camera, expected one of both");
  if (options.rays) return refuse("found --heat with --rays, expected one of both");
  if (options.tick && *options.tick <= options.since) {
    return refuse(fmt::format("found --tick {}, expected more than --since {}", *options.tick, options.since));
  }
  if (!options.tick && !IsRecordingPath(options.file)) return refuse("found --heat without --tick, expected both");
  return {};
}

// The picture of a state with a heat map.
Status SaveHeat(const WorldDescription& world, const WorldState& state, const SnapshotOptions& options,
                PictureOptions picture, const HeatMap& heat) {
  const Result<PictureFormat> format = PictureFormatOf(options.output);
  if (!format.ok()) return format.error();
  picture.format = format.value();
  if (!options.heights.empty()) {
    const Storey storey = AtHeights(world, state, options.heights[0], options.heights[1]);
    const Result<std::string> bytes = DrawPicture(storey.world, storey.state, {}, picture, {}, &heat);
    return bytes.ok() ? WriteWholeFile(options.output, bytes.value()) : bytes.error();
  }
  const Result<std::string> bytes = DrawPicture(world, state, {}, picture, {}, &heat);
  return bytes.ok() ? WriteWholeFile(options.output, bytes.value()) : bytes.error();
}

// All states of a recording up to a tick. After a rewind the map begins anew: the ticks behind it are not those of the
// run any more.
int SnapshotHeatOfRecording(const SnapshotOptions& options, const Recording& recording, const PictureOptions& picture) {
  Result<ReplayCursor> cursor = ReplayCursor::At(recording);
  if (!cursor.ok()) return Fail(cursor.error());
  if (const Status problem = CheckPicture(options); !problem.ok()) return Fail(problem.error());
  HeatMap heat = MakeHeatMap(options);
  std::optional<Tick> newest;
  for (;;) {
    const Result<bool> stepped = cursor.value().Step();
    if (!stepped.ok()) return Fail(stepped.error());
    if (!stepped.value()) break;
    const WorldState& state = cursor.value().world().state();
    if (newest && state.tick < *newest) heat.Clear();
    if (newest && state.tick > *newest && state.tick > options.since) heat.Add(cursor.value().world().world(), state);
    newest = state.tick;
    if (options.tick && state.tick == *options.tick) break;
  }
  if (options.tick && newest != *options.tick) {
    return Fail({{options.file},
                 fmt::format("found no tick {}: the recording ends at tick {}", *options.tick, newest.value_or(0))});
  }
  const ReplayedWorld& world = cursor.value().world();
  const Status saved = SaveHeat(world.world(), world.state(), options, picture, heat);
  return saved.ok() ? kExitDone : Fail(saved.error());
}

// The picture of a state, or the view of a camera in it.
// A part of the heights is a world of its own, with a scene and an index of its own: the drawing code knows no storeys.
Status SaveState(const Scene& scene, const BodyIndex& bodies, const WorldState& state, const SnapshotOptions& options,
                 const PictureOptions& picture, PictureRays rays) {
  if (!options.heights.empty()) {
    Storey storey = AtHeights(scene.world(), state, options.heights[0], options.heights[1]);
    const Scene part(std::move(storey.world));
    BodyIndex bodies_of_part(part);
    bodies_of_part.Assign(storey.state);
    return SavePicture(part, bodies_of_part, storey.state, options.output, picture, rays);
  }
  if (options.camera.empty()) return SavePicture(scene, bodies, state, options.output, picture, rays);
  const Result<FoundCamera> camera = FindCamera(scene.world(), options.camera);
  if (!camera.ok()) return camera.error();
  const std::unique_ptr<const Sensor> sensor =
      std::move(MakeSensors(scene, camera.value().robot)[camera.value().sensor]);
  const SensorReading reading = sensor->Measure({scene, bodies, &state}, state.tick);
  return SaveView(*reading.As<CameraReading>(), options.output,
                  options.depths ? CameraImage::kDepths : CameraImage::kColors);
}

Status CheckCameraFormat(const SnapshotOptions& options) {
  const Result<PictureFormat> format = PictureFormatOf(options.output);
  if (options.camera.empty() || !format.ok() || format.value() == PictureFormat::kPng) return {};
  return Error{{options.output}, "found a camera's picture as .svg, expected .png"};
}

// The state is that of the recording, so nothing about its seed or controllers could have an effect.
int SnapshotRecording(const SnapshotOptions& options, const PictureOptions& picture, PictureRays rays) {
  if (options.seed || options.controller) {
    return Fail({{options.file}, "found a recording, whose seed and controllers cannot be changed"});
  }
  const Result<Recording> recording = OpenToReplay(options.file);
  if (!recording.ok()) return Fail(recording.error());
  if (!options.heat.empty()) return SnapshotHeatOfRecording(options, recording.value(), picture);
  const Result<ReplayCursor> cursor = ReplayCursor::AtTick(recording.value(), options.tick.value_or(0));
  if (!cursor.ok()) return Fail(cursor.error());
  const ReplayedWorld& world = cursor.value().world();
  if (!options.camera.empty()) {
    if (const Result<FoundCamera> found = FindCamera(world.world(), options.camera); !found.ok()) {
      return Fail(found.error());
    }
  }
  if (const Status problem = CheckPicture(options); !problem.ok()) return Fail(problem.error());
  if (const Status problem = SaveState(*world.scene(), world.bodies(), world.state(), options, picture, rays);
      !problem.ok()) {
    return Fail(problem.error());
  }
  return kExitDone;
}

// A run is stepped tick by tick.
int SnapshotHeat(const SnapshotOptions& options, const PictureOptions& picture, Simulation& simulation) {
  HeatMap heat = MakeHeatMap(options);
  while (simulation.state().tick < options.tick.value_or(0)) {
    simulation.Step(1);
    if (simulation.state().tick > options.since) heat.Add(simulation.world(), simulation.state());
  }
  for (const std::string& failure : simulation.failures()) PrintPlain(stderr, "warning: {}\n", failure);
  const Status saved = SaveHeat(simulation.world(), simulation.state(), options, picture, heat);
  return saved.ok() ? kExitDone : Fail(saved.error());
}

}  // namespace

void AddSnapshotCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("snapshot", "Draw a world at one tick");
  const auto options = std::make_shared<SnapshotOptions>();  // lives as long as the command
  command
      ->add_option("FILE", options->file,
                   "A Stage .world file, a JSON scenario, a .building.yaml, a layout (LIF), a ROS map .yaml or a "
                   "recording (.mcap)")
      ->required()
      ->check(NotEmpty());
  command->add_option("-o,--output", options->output, "The picture; its ending, .png or .svg, selects the format")
      ->required()
      ->check(NotEmpty())
      ->type_name("FILE");
  command
      ->add_option(
          "--tick", options->tick,
          "Run to this tick first (default: 0, the world as loaded; of a heat map of a recording its last tick)")
      ->check(WholeNumber(0))
      ->type_name("N");
  command->add_option("--view", options->view, "top, or side: seen along +y (default: top)")
      ->check(OneOf({"top", "side"}))
      ->type_name("VIEW");
  command->add_option("--camera", options->camera, "The view of this camera instead: ROBOT/SENSOR, or ROBOT: its first")
      ->check(NotEmpty())
      ->type_name("CAMERA");
  command->add_flag("--depth", options->depths, "The camera's depths instead of its colours: white is near");
  command->add_flag("--rays", options->rays, "Draw the readings of all sensors");

  const char* map = "Heat map";
  command
      ->add_option("--heat", options->heat,
                   "Draw where robots or people spent their time, or where robots waited: robots, people or waits")
      ->check(OneOf({"robots", "people", "waits"}))
      ->type_name("WHAT")
      ->group(map);
  command->add_option("--since", options->since, "It begins after this tick (default: 0)")
      ->check(WholeNumber(0))
      ->type_name("N")
      ->group(map);
  command
      ->add_option("--cell", options->cell,
                   fmt::format("Side of its cells in metres (default: {})", HeatMap::kDefaultCell))
      ->check(PositiveNumber())
      ->type_name("METRES")
      ->group(map);

  const char* part = "Part of the world";
  command->add_option("--center", options->center, "Its middle, m (default: the world's middle)")
      ->expected(2)
      ->type_name("X Y")
      ->group(part);
  command->add_option("--meters", options->meters, "Its width, m; a side view shows as much to the front and back")
      ->type_name("W")
      ->group(part);
  command
      ->add_option("--heights", options->heights,
                   "Only models whose base is from MIN m to below MAX m, as those of a level of a building")
      ->expected(2)
      ->type_name("MIN MAX")
      ->group(part);
  command->add_option("--width", options->width, "Width of the picture (default: up to 1000 pixels)")
      ->check(WholeNumber(kMinPictureWidth, kMaxPictureWidth))
      ->type_name("PIXELS")
      ->group(part);

  const char* run = "Run";
  command->add_option("--seed", options->seed, "Seed of all random numbers")
      ->check(WholeNumber(0))
      ->type_name("S")
      ->group(run);
  command->add_option("--controller", options->controller, "Controller of the robots without one in the file")
      ->check(NotEmpty())
      ->type_name("NAME")
      ->group(run);
  FindOption(*command, "--depth").needs(&FindOption(*command, "--camera"));
  command->final_callback([options, &exit_status] { exit_status = SnapshotCommand(*options); });
}

// From the cheapest check to the most expensive: texts of options, the file, the camera, the output, and only then the
// ticks.
int SnapshotCommand(const SnapshotOptions& options) {
  if (const Result<PictureFormat> format = PictureFormatOf(options.output); !format.ok()) return Fail(format.error());
  if (const Status problem = CheckHeat(options); !problem.ok()) return Fail(problem.error());
  const PictureOptions picture_options = ToPictureOptions(options);
  if (const Status problem = CheckPictureOptions(picture_options); !problem.ok()) return Fail(problem.error());

  if (const Status problem = CheckCameraFormat(options); !problem.ok()) return Fail(problem.error());
  const PictureRays rays = options.rays ? PictureRays::kDrawn : PictureRays::kHidden;
  if (IsRecordingPath(options.file)) return SnapshotRecording(options, picture_options, rays);
  if (const Status problem = CheckControllers(options.file, options.controller); !problem.ok())
    return Fail(problem.error());
  SimulationOptions simulation_options;
  simulation_options.seed = options.seed;
  simulation_options.controller = options.controller;
  simulation_options.run_controllers = options.tick.value_or(0) > 0;
  Result<Simulation> loaded = Simulation::Load(options.file, simulation_options);
  if (!loaded.ok()) return Fail(loaded.error());
  Simulation& simulation = loaded.value();
  std::optional<FoundCamera> camera;
  if (!options.camera.empty()) {
    const Result<FoundCamera> found = FindCamera(simulation.world(), options.camera);
    if (!found.ok()) return Fail(found.error());
    camera = found.value();
  }
  for (const Warning& warning : simulation.warnings()) PrintPlain(stderr, "{}\n", warning.ToString());
  if (const Status problem = CheckPicture(options); !problem.ok()) return Fail(problem.error());

  if (!options.heat.empty()) return SnapshotHeat(options, picture_options, simulation);
  simulation.Step(options.tick.value_or(0));
  for (const std::string& failure : simulation.failures()) PrintPlain(stderr, "warning: {}\n", failure);
  const CameraImage image = options.depths ? CameraImage::kDepths : CameraImage::kColors;
  if (!options.heights.empty()) {
    const Scene scene(simulation.world());
    BodyIndex bodies(scene);
    bodies.Assign(simulation.state());
    const Status saved = SaveState(scene, bodies, simulation.state(), options, picture_options, rays);
    return saved.ok() ? kExitDone : Fail(saved.error());
  }
  const Status saved = camera ? simulation.SaveView(options.output, camera->robot, camera->sensor, image)
                              : simulation.SavePicture(options.output, picture_options, rays);
  return saved.ok() ? kExitDone : Fail(saved.error());
}

}  // namespace troupe
