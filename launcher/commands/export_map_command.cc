#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/distinct_files.h"
#include "common/base/file.h"
#include "common/base/json_tree.h"
#include "common/base/print.h"
#include "common/spatial/occupancy_grid.h"
#include "common/spatial/scene.h"
#include "launcher/commands/commands.h"
#include "world-service/service/requested_file.h"
#include "worldfile/load_world.h"
#include "worldfile/map/zone_mask.h"
#include "worldfile/sites/building_text.h"
#include "worldfile/sites/lif_json.h"
#include "worldfile/sites/opentcs_xml.h"
#include "worldfile/sites/route_graph.h"

namespace troupe {
namespace {

constexpr std::uint64_t kMaxCells = 400'000'000;
// Of the files of a map, behind its name.
constexpr const char* kImageEnding = ".pgm";
constexpr const char* kMapEnding = ".yaml";
constexpr const char* kLanesEnding = ".lif.json";
constexpr const char* kBuildingEnding = ".building.yaml";
constexpr const char* kPlantEnding = ".opentcs.xml";
constexpr const char* kRouteGraphEnding = ".geojson";
constexpr const char* kFiltersEnding = ".filters.yaml";
// Of the masks of zones, before the endings of a map.
constexpr std::array kMaskKinds = {std::pair{ZoneKind::kKeepout, ".keepout"}, std::pair{ZoneKind::kSpeed, ".speed"}};

struct ExportMapOptions {
  std::string file;
  std::string output;
  std::optional<double> resolution;
  std::optional<double> height;
  bool lanes = false;
  bool building = false;
  bool plant = false;
  bool zones = false;
  bool route_graph = false;
};

// Of the lanes and places of a building, beside its map.
Status WriteLanes(const ExportMapOptions& options, const Site* site) {
  if (site == nullptr) return Error{{options.file}, "found no lanes, expected a building (.building.yaml) or a layout"};
  const std::string now = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  return WriteWholeFile(options.output + kLanesEnding, LayoutText(*site, now));
}

// The robots that can be vehicles of VDA 5050: those with its controller, and those without one.
std::vector<PlantVehicle> PlantVehiclesOf(const WorldDescription& world) {
  std::vector<PlantVehicle> vehicles;
  for (const RobotDescription& robot : world.robots) {
    const bool is_vehicle = robot.controller.name == "vda5050";
    if (!is_vehicle && robot.controller.name != "idle") continue;
    PlantVehicle vehicle = {robot.name, "uagv", "Troupe", robot.name, ""};
    const Result<JsonTree> parameters = JsonTree::Parse(robot.controller.parameters, "");
    if (is_vehicle && parameters.ok()) {
      const JsonNode& root = parameters.value().root();
      const auto read = [&](const char* name, std::string& value) {
        const JsonNode* const node = root.Find(name);
        if (node != nullptr && node->is_string()) value = node->text;
      };
      read("interface", vehicle.interface_name);
      read("manufacturer", vehicle.manufacturer);
      read("serial_number", vehicle.serial_number);
      read("map", vehicle.map_id);
    }
    const Shape& shape = world.shape(world.model(robot.root).shape);
    std::vector<Vec2> corners;
    double height = 0.0;
    for (const Block& block : shape.blocks) {
      corners.insert(corners.end(), block.outline.begin(), block.outline.end());
      height = std::max(height, block.z.max);
    }
    if (!corners.empty()) {
      const Rectangle box = BoundingBox(corners);
      vehicle.length = box.max_x - box.min_x;
      vehicle.width = box.max_y - box.min_y;
      vehicle.height = height;
    }
    vehicles.push_back(std::move(vehicle));
  }
  return vehicles;
}

// The lanes with the vehicles for openTCS, beside its map.
Status WritePlant(const ExportMapOptions& options, const LoadedWorld& loaded) {
  if (loaded.site == nullptr) {
    return Error{{options.file},
                 "found no lanes, expected a building (.building.yaml), a layout, or a scenario in one"};
  }
  return WriteWholeFile(options.output + kPlantEnding, PlantModelText(*loaded.site, PlantVehiclesOf(loaded.world)));
}

// The lanes of the first graph on the level of the map for Nav2's route server, beside the map.
Status WriteRouteGraph(const ExportMapOptions& options, const WorldDescription& world, double height) {
  if (world.lane_graphs.empty()) return Error{{options.file}, "found no lanes, expected a world with lanes"};
  const std::vector<LevelDescription>& levels = world.levels;
  double z = 0.0;
  for (const LevelDescription& level : levels) {
    if (level.name == LevelAt(levels, height)) z = level.z;
  }
  return WriteWholeFile(options.output + kRouteGraphEnding, RouteGraphText(world.lane_graphs.front(), z));
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

// The cells of the map, or of the area of all zones in a world without a map.
OccupancyGrid CellsOfMasks(const OccupancyGrid& map, const WorldDescription& world, std::optional<double> resolution) {
  if (!map.empty()) return map;
  Rectangle box = BoundingBox(world.zones.front().outline);
  for (const ZoneDescription& zone : world.zones) {
    const Rectangle own = BoundingBox(zone.outline);
    box = {std::min(box.min_x, own.min_x), std::min(box.min_y, own.min_y), std::max(box.max_x, own.max_x),
           std::max(box.max_y, own.max_y)};
  }
  OccupancyGrid grid;
  grid.resolution = resolution.value_or(kDefaultGridResolution);
  grid.origin_x = box.min_x;
  grid.origin_y = box.min_y;
  const auto cells = [&](double length) {
    return static_cast<std::uint32_t>(std::min(20'000.0, std::max(1.0, std::ceil(length / grid.resolution - 1e-9))));
  };
  grid.width = cells(box.max_x - box.min_x);
  grid.height = cells(box.max_y - box.min_y);
  return grid;
}

// Masks of the zones that are on at load, and the parameters of Nav2 with their types, topics and numbers.
Status WriteZones(const ExportMapOptions& options, const WorldDescription& world, double height,
                  const OccupancyGrid& map) {
  if (world.zones.empty()) return Error{{options.file}, "found no zones, expected a scenario with 'zones'"};
  const OccupancyGrid grid = CellsOfMasks(map, world, options.resolution);
  std::string filters =
      "# The parameters of Nav2's nodes map_server and costmap_filter_info_server for these masks, and of its "
      "costmaps.\n";
  for (const auto& [kind, ending] : kMaskKinds) {
    const std::string name = options.output + ending;
    const std::string file = std::filesystem::path(name).filename().string();
    const ZoneMask mask = MakeZoneMask(world, kind, height, grid, file + kImageEnding);
    Status failure = WriteBoth(name + kImageEnding, mask.image, name + kMapEnding, mask.yaml);
    if (!failure.ok()) return failure;
    const std::string prefix = NameOf(kind);
    filters += fmt::format(
        "{0}_filter_mask_server:\n  ros__parameters:\n    yaml_filename: {1}\n    topic_name: {0}_filter_mask\n"
        "    frame_id: map\n{0}_costmap_filter_info_server:\n  ros__parameters:\n    type: {2}\n"
        "    filter_info_topic: {0}_costmap_filter_info\n    mask_topic: {0}_filter_mask\n    base: 0.0\n"
        "    multiplier: {3:.2f}\n",
        prefix, file + kMapEnding, kind == ZoneKind::kSpeed ? 2 : 0, mask.multiplier);
  }
  for (const char* costmap : {"global_costmap", "local_costmap"}) {
    filters += fmt::format(
        "{0}:\n  {0}:\n    ros__parameters:\n      filters: [keepout_filter, speed_filter]\n      keepout_filter:\n"
        "        plugin: nav2_costmap_2d::KeepoutFilter\n        enabled: true\n"
        "        filter_info_topic: keepout_costmap_filter_info\n      speed_filter:\n"
        "        plugin: nav2_costmap_2d::SpeedFilter\n        enabled: true\n"
        "        filter_info_topic: speed_costmap_filter_info\n        speed_limit_topic: speed_limit\n",
        costmap);
  }
  if (Status failure = WriteWholeFile(options.output + kFiltersEnding, filters); !failure.ok()) return failure;
  std::vector<std::string> left_out;
  for (const ZoneDescription& zone : world.zones) {
    const bool has_mask = zone.kind == ZoneKind::kKeepout || zone.kind == ZoneKind::kSpeed;
    if (!has_mask || !zone.is_on) left_out.push_back(zone.name);
  }
  if (!left_out.empty()) {
    PrintPlain(stdout, "not in the masks, which have keepout and speed zones that are on at load: {}\n",
               fmt::join(left_out, ", "));
  }
  return Status();
}

// The grid is made last: it may take seconds, and what can fail without it has failed before.
int ExportMapCommand(const ExportMapOptions& options) {
  std::vector<OutputName> outputs;
  for (const char* ending : {kImageEnding, kMapEnding}) outputs.push_back({"-o", options.output + ending});
  if (options.lanes) outputs.push_back({"--lanes", options.output + kLanesEnding});
  if (options.building) outputs.push_back({"--building", options.output + kBuildingEnding});
  if (options.zones) {
    for (const auto& [kind, ending] : kMaskKinds) {
      for (const char* part : {kImageEnding, kMapEnding})
        outputs.push_back({"--zones", options.output + ending + part});
    }
    outputs.push_back({"--zones", options.output + kFiltersEnding});
  }
  if (options.route_graph) outputs.push_back({"--route-graph", options.output + kRouteGraphEnding});
  if (options.plant) outputs.push_back({"--opentcs", options.output + kPlantEnding});
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
  if (options.plant) {
    if (Status failure = WritePlant(options, loaded.value()); !failure.ok()) return Fail(failure.error());
  }
  const Scene scene(std::move(loaded.value().world));
  const double height = options.height.value_or(UsualMapHeight(scene));
  const OccupancyGrid grid = MakeOccupancyGrid(scene, options.resolution, height, kMaxCells);
  if (options.route_graph) {
    if (Status failure = WriteRouteGraph(options, scene.world(), height); !failure.ok()) return Fail(failure.error());
  }
  if (options.zones) {
    if (Status failure = WriteZones(options, scene.world(), height, grid); !failure.ok()) return Fail(failure.error());
  }
  if (grid.empty() && (options.route_graph || options.zones || options.lanes || options.building || options.plant)) {
    PrintPlain(stdout, "{}: no static model and no ROS map, so no map is written\n", options.file);
    return kExitDone;
  }
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
  command->add_flag("--opentcs", options->plant,
                    "Also write the lanes and the vehicles as a plant model of openTCS, NAME.opentcs.xml");
  command->add_flag("--route-graph", options->route_graph,
                    "Also write the lanes of the level as a graph of Nav2's route server, NAME.geojson");
  command->add_flag("--zones", options->zones,
                    "Also write the zones as masks of Nav2, NAME.keepout.yaml and NAME.speed.yaml with their images, "
                    "and its parameters for them, NAME.filters.yaml");
  command->add_flag("--building", options->building,
                    "Also write the building itself, in metres, as NAME.building.yaml of Open-RMF");
  command->final_callback([options, &exit_status] { exit_status = ExportMapCommand(*options); });
}

}  // namespace troupe
