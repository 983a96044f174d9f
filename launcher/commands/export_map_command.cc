#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "command_line/exit_status.h"
#include "command_line/option_checks.h"
#include "command_line/run_flags.h"
#include "common/base/file_replacement.h"
#include "common/base/print.h"
#include "common/spatial/occupancy_grid.h"
#include "launcher/commands/commands.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

constexpr std::uint64_t kMostCells = 400'000'000;

struct ExportMapOptions {
  std::string file;
  std::string output;
  std::optional<double> resolution;
  std::optional<double> height;
};

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

std::string Yaml(const OccupancyGrid& grid, const std::string& image) {
  return fmt::format(
      "image: {}\nmode: trinary\nresolution: {}\norigin: [{}, {}, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: "
      "0.25\n",
      image, grid.resolution, grid.origin_x, grid.origin_y);
}

int ExportMapCommand(const ExportMapOptions& options) {
  Result<LoadedWorld> loaded = LoadWorld(options.file, {});
  if (!loaded.ok()) return Fail(loaded.error());
  const Scene scene(std::move(loaded.value().world));
  const double height = options.height.value_or(UsualMapHeight(scene));
  const OccupancyGrid grid = MakeOccupancyGrid(scene, options.resolution, height, kMostCells);
  if (grid.empty()) return Fail({{}, options.file + ": found no static model and no ROS map, so it has no map"});
  const std::string image = options.output + ".pgm";
  const std::string name = std::filesystem::path(image).filename().string();
  if (Status failure = WriteBoth(image, Pgm(grid), options.output + ".yaml", Yaml(grid, name)); !failure.ok()) {
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
  command->final_callback([options, &exit_status] { exit_status = ExportMapCommand(*options); });
}

}  // namespace troupe
