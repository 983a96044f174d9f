#include "worldfile/models/build_world.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>

#include "worldfile/models/model_builder.h"
#include "worldfile/models/properties/build_context.h"
#include "worldfile/models/properties/unused_properties.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

Units ReadUnits(PropertyReader& reader) {
  Units units;
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
  return units;
}

// The world's own properties, without models.
WorldDescription ReadWorldProperties(PropertyReader& reader) {
  WorldDescription world;
  const std::string file = std::filesystem::path(reader.node().where.file).filename().string();
  world.name = reader.Text("name", file);
  world.interval_ns = std::llround(reader.Number("interval_sim", 100.0, 0.001, 1'000'000.0) * 1e6);
  world.gravity = reader.Number("gravity", 9.81, 0.0, 1000.0);
  return world;
}

// The ticks of the property `quit_time`; nothing without one.
std::optional<std::uint64_t> ReadTicks(PropertyReader& reader, std::int64_t interval_ns) {
  const double quit_seconds = reader.Number("quit_time", 0.0, 0.0, 1e9);
  if (!(quit_seconds > 0.0)) return std::nullopt;
  const std::int64_t quit_ns = std::llround(quit_seconds * 1e9);
  return static_cast<std::uint64_t>((quit_ns + interval_ns - 1) / interval_ns);
}

}  // namespace

Result<LoadedWorld> BuildWorld(const WorldTree& tree, const LoadOverrides& overrides, const BuildOptions& options) {
  BuildContext context(tree, overrides.allowed, options.images);
  context.without_bitmaps = options.without_bitmaps;
  context.default_controller = overrides.controller;
  context.check_controller = overrides.check_controller;
  PropertyReader reader(tree.world, context.units, context.diagnostics);
  context.units = ReadUnits(reader);
  context.world = ReadWorldProperties(reader);
  context.world.seed = overrides.seed.value_or(0);
  LoadedWorld loaded;
  if (const auto ticks = ReadTicks(reader, context.world.interval_ns)) loaded.settings.ticks = *ticks;
  WarnOfUnusedInWorld(reader);
  ModelBuilder builder(context);
  builder.BuildTree();
  if (context.diagnostics.failed()) return *context.diagnostics.error();

  loaded.world = std::move(context.world);
  std::sort(loaded.world.grippers.begin(), loaded.world.grippers.end(),
            [](const GripperDescription& a, const GripperDescription& b) { return a.model < b.model; });
  loaded.placed_alone = builder.placed_alone();
  loaded.files = tree.files;
  const std::vector<std::string> bitmaps = context.bitmaps.Paths();
  loaded.files.insert(loaded.files.end(), bitmaps.begin(), bitmaps.end());
  std::tie(loaded.map_width, loaded.map_height) = context.bitmaps.LargestSize();
  loaded.warnings = tree.warnings;
  const std::vector<Warning>& warnings = context.diagnostics.warnings();
  loaded.warnings.insert(loaded.warnings.end(), warnings.begin(), warnings.end());
  return loaded;
}

}  // namespace troupe
