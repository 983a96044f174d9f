#include "common/worldfile/build_world.h"

#include <cmath>
#include <filesystem>
#include <tuple>

#include "common/worldfile/build_context.h"
#include "common/worldfile/model_builder.h"
#include "common/worldfile/property_catalogue.h"
#include "common/worldfile/quote.h"

namespace troupe {
namespace {

void ReadUnits(PropertyReader& reader, Units& units) {
  const std::string length = reader.Text("unit_length", "m");
  if (length == "cm") {
    units.length = 0.01;
  } else if (length == "mm") {
    units.length = 0.001;
  } else if (length != "m") {
    reader.diagnostics().Warn(reader.Where("unit_length"),
                              "unit_length " + Quoted(length) + " is not \"m\", \"cm\" or \"mm\"; metres are used");
  }
  const std::string angle = reader.Text("unit_angle", "degrees");
  units.degrees = angle != "radians";
  if (angle != "radians" && angle != "degrees") {
    reader.diagnostics().Warn(reader.Where("unit_angle"),
                              "unit_angle " + Quoted(angle) + " is not \"degrees\" or \"radians\"; degrees are used");
  }
}

void ReadWorldProperties(PropertyReader& reader, LoadedWorld& loaded) {
  const std::string file = std::filesystem::path(reader.entity().where.file).filename().string();
  loaded.world.name = reader.Text("name", file);
  loaded.world.interval_ns = std::llround(reader.Number("interval_sim", 100.0, 0.001, 1'000'000.0) * 1e6);
  loaded.world.gravity = reader.Number("gravity", 9.81, 0.0, 1000.0);
  const double quit_seconds = reader.Number("quit_time", 0.0, 0.0, 1e9);
  if (quit_seconds > 0.0) {
    const std::int64_t quit_ns = std::llround(quit_seconds * 1e9);
    loaded.settings.ticks =
        static_cast<std::uint64_t>((quit_ns + loaded.world.interval_ns - 1) / loaded.world.interval_ns);
  }
}

}  // namespace

Result<LoadedWorld> BuildWorld(const WorldTree& tree, const LoadOverrides& overrides, const BuildOptions& options) {
  BuildContext context(tree, overrides, options);
  LoadedWorld& loaded = context.loaded;
  loaded.world.seed = overrides.seed.value_or(0);
  PropertyReader reader(tree.world, context.units, context.diagnostics);
  ReadUnits(reader, context.units);
  ReadWorldProperties(reader, loaded);
  WarnOfUnused(reader, "world");
  ModelBuilder(context).BuildTree();
  if (context.diagnostics.failed()) return *context.diagnostics.error();

  loaded.files = tree.files;
  const std::vector<std::string> bitmaps = context.bitmaps.Paths();
  loaded.files.insert(loaded.files.end(), bitmaps.begin(), bitmaps.end());
  std::tie(loaded.map_width, loaded.map_height) = context.bitmaps.LargestSize();
  loaded.warnings = tree.warnings;
  std::vector<Warning>& warnings = context.diagnostics.warnings();
  loaded.warnings.insert(loaded.warnings.end(), warnings.begin(), warnings.end());
  return std::move(loaded);
}

}  // namespace troupe
