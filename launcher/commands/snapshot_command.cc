#include "launcher/commands/snapshot_command.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
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
#include "common/spatial/occupancy_grid.h"
#include "launcher/commands/check_command.h"
#include "launcher/commands/commands.h"
#include "library/save_picture.h"
#include "recording/recording.h"
#include "troupe/picture_options.h"
#include "troupe/simulation.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/service/requested_file.h"
#include "worldfile/load_world.h"
#include "worldfile/sites/building_text.h"
#include "worldfile/sites/lif_json.h"

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

constexpr std::uint64_t kMaxCells = 400'000'000;
// Of the files of a map, behind its name.
constexpr const char* kImageEnding = ".pgm";
constexpr const char* kMapEnding = ".yaml";
constexpr const char* kLanesEnding = ".lif.json";
constexpr const char* kBuildingEnding = ".building.yaml";

struct ExportMapOptions {
  std::string file;
  std::string output;
  std::optional<double> resolution;
  std::optional<double> height;
  bool lanes = false;
  bool building = false;
};

// Of the lanes and places of a building, beside its map.
Status WriteLanes(const ExportMapOptions& options, const Site* site) {
  if (site == nullptr) return Error{{options.file}, "found no lanes, expected a building (.building.yaml) or a layout"};
  const std::string now = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  return WriteWholeFile(options.output + kLanesEnding, LayoutText(*site, now));
}

// The whole site, beside its map.
Status WriteBuilding(const ExportMapOptions& options, const Site* site) {
  if (site == nullptr) {
    return Error{{options.file}, "found no building, expected one (.building.yaml), a layout, or a scenario in one"};
  }
  return WriteWholeFile(options.output + kBuildingEnding, BuildingText(*site));
}

// Both or none: the image of one map beside the scale of another would be a wrong map.
Status WriteBoth(const std::string& image_path, const std::string& image, const std::string& yaml_path,
                 const std::string& yaml) {
  Result<FileReplacement> new_image = FileReplacement::Prepare(image_path, image);
  if (!new_image.ok()) return new_image.error();
  Result<FileReplacement> new_yaml = FileReplacement::Prepare(yaml_path, yaml);
  if (!new_yaml.ok()) return new_yaml.error();
  if (Status failure = new_image.value().Commit(); !failure.ok()) return failure;
  return new_yaml.value().Commit();
}

// Rows from the largest y down, as pictures have them.
// Unknown cells, which a map of a real robot has, do not occur: a world is known everywhere.
std::string Pgm(const OccupancyGrid& grid) {
  constexpr char kOccupied = 0;
  constexpr char kFree = '\xfe';  // 254, as map_saver writes it
  std::string image = fmt::format("P5\n{} {}\n255\n", grid.width, grid.height);
  image.reserve(image.size() + grid.occupied.size());
  for (std::uint32_t row = grid.height; row-- > 0;) {
    for (std::uint32_t column = 0; column < grid.width; ++column) {
      image += grid.occupied[std::size_t{row} * grid.width + column] ? kOccupied : kFree;
    }
  }
  return image;
}

// The thresholds are those of map_saver; with pixels of two values any others would read the same.
std::string Yaml(const OccupancyGrid& grid, const std::string& image) {
  return fmt::format(
      "image: {}\nmode: trinary\nresolution: {}\norigin: [{}, {}, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: "
      "0.25\n",
      image, grid.resolution, grid.origin_x, grid.origin_y);
}

// The grid is made last: it may take seconds, and what can fail without it has failed before.
int ExportMapCommand(const ExportMapOptions& options) {
  std::vector<OutputName> outputs;
  for (const char* ending : {kImageEnding, kMapEnding}) outputs.push_back({"-o", options.output + ending});
  if (options.lanes) outputs.push_back({"--lanes", options.output + kLanesEnding});
  if (options.building) outputs.push_back({"--building", options.output + kBuildingEnding});
  const auto inputs = [&] { return InputFilesOf(options.file, {}); };
  if (Status problem = CheckDistinct(outputs, inputs); !problem.ok()) return Fail(problem.error());
  Result<LoadedWorld> loaded = LoadWorld(options.file, {});
  if (!loaded.ok()) return Fail(loaded.error());
  if (options.building) {
    if (Status failure = WriteBuilding(options, loaded.value().site.get()); !failure.ok()) return Fail(failure.error());
  }
  if (options.lanes) {
    if (Status failure = WriteLanes(options, loaded.value().site.get()); !failure.ok()) return Fail(failure.error());
  }
  const Scene scene(std::move(loaded.value().world));
  const double height = options.height.value_or(UsualMapHeight(scene));
  const OccupancyGrid grid = MakeOccupancyGrid(scene, options.resolution, height, kMaxCells);
  if (grid.empty()) return Fail({{}, options.file + ": found no static model and no ROS map, so it has no map"});
  const std::string image = options.output + kImageEnding;
  const std::string name = std::filesystem::path(image).filename().string();
  if (Status failure = WriteBoth(image, Pgm(grid), options.output + kMapEnding, Yaml(grid, name)); !failure.ok()) {
    return Fail(failure.error());
  }
  PrintPlain(stdout, "{} x {} cells of {} m, at a height of {:.3g} m: {}.yaml\n", grid.width, grid.height,
             grid.resolution, height, options.output);
  return kExitDone;
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

void AddExportMapCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("export-map", "Write the map of a world as files for ROS's map_server");
  auto options = std::make_shared<ExportMapOptions>();
  AddWorldFile(*command, options->file);
  command->add_option("-o,--output", options->output, "Name of the map: NAME.yaml and NAME.pgm are written")
      ->required()
      ->check(NotEmpty())
      ->type_name("NAME");
  command
      ->add_option(
          "--resolution", options->resolution,
          fmt::format("Side of a cell in metres (default: that of the world's ROS map, or {})", kDefaultGridResolution))
      ->check(PositiveNumber())
      ->type_name("METRES");
  command
      ->add_option("--height", options->height,
                   "Height of the horizontal section that is written, in metres (default: that of the lowest ranger)")
      ->check(NumberFromZero())
      ->type_name("METRES");
  command->add_flag("--lanes", options->lanes, "Also write the lanes of a building as a layout (LIF), NAME.lif.json");
  command->add_flag("--building", options->building,
                    "Also write the building itself, in metres, as NAME.building.yaml of Open-RMF");
  command->final_callback([options, &exit_status] { exit_status = ExportMapCommand(*options); });
}

}  // namespace troupe
