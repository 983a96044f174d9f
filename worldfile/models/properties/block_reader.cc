#include "worldfile/models/properties/block_reader.h"

#include <charconv>

#include "worldfile/models/properties/unused_properties.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

constexpr std::int64_t kMaxPoints = 1'000;

// The i of "point[i]", if the name is one.
std::optional<std::size_t> PointIndex(const std::string& name) {
  constexpr std::string_view kStart = "point[";
  if (name.compare(0, kStart.size(), kStart) != 0) return std::nullopt;
  std::size_t index = 0;
  const std::from_chars_result read = std::from_chars(name.data() + kStart.size(), name.data() + name.size(), index);
  if (read.ec != std::errc() || std::string_view(read.ptr) != "]") return std::nullopt;
  return index;
}

// The corners by their indices, in any order in the file.
std::optional<Polygon> ReadPoints(PropertyReader& reader) {
  if (reader.node().Find("points") == nullptr) {
    reader.diagnostics().Fail(reader.node().where, "found a block without 'points', expected their number");
    return std::nullopt;
  }
  const auto count = static_cast<std::size_t>(reader.Integer("points", 0, 3, kMaxPoints));
  std::vector<std::string> names(count);
  for (const Property& property : reader.node().properties) {
    const std::optional<std::size_t> index = PointIndex(property.name);
    if (index && *index < count) names[*index] = property.name;
  }
  Polygon outline;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) {
      reader.diagnostics().Fail(reader.node().where, "found a block of " + std::to_string(count) +
                                                         " points without 'point[" + std::to_string(i) +
                                                         "]', expected all of them");
      return std::nullopt;
    }
    const std::optional<std::vector<double>> numbers = reader.Numbers(names[i], 2);
    if (!numbers) return std::nullopt;
    outline.push_back({(*numbers)[0] * reader.units().length, (*numbers)[1] * reader.units().length});
  }
  return outline;
}

}  // namespace

std::optional<Block> ReadBlock(const WorldNode& node, const Units& units, Diagnostics& diagnostics) {
  PropertyReader reader(node, units, diagnostics);
  std::optional<Polygon> outline = ReadPoints(reader);
  Block block;
  if (const auto z = reader.Numbers("z", 2)) {
    block.z = {(*z)[0] * units.length, (*z)[1] * units.length};
    if (block.z.min > block.z.max) {
      diagnostics.Fail(reader.Where("z"),
                       "found z from " + NumberText((*z)[0]) + " to " + NumberText((*z)[1]) + ", expected [min max]");
    }
  }
  WarnOfUnusedInBlock(reader);
  if (!node.children.empty()) {
    diagnostics.Fail(node.children.front().where,
                     "found " + Quoted(node.children.front().type) + " inside a block, expected only properties");
  }
  if (!outline || diagnostics.failed()) return std::nullopt;
  Result<Polygon> normalized = Normalized(std::move(*outline));
  if (!normalized.ok()) {
    diagnostics.Fail(node.where, "found a block that is no simple polygon: " + normalized.error().message);
    return std::nullopt;
  }
  block.outline = std::move(normalized).value();
  if (!(block.z.max > block.z.min)) {
    diagnostics.Warn(reader.Where("z"),
                     "this block has no height (its 'z' is missing or empty), so nothing can touch it");
  }
  return block;
}

}  // namespace troupe
