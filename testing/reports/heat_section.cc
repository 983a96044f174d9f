#include "testing/reports/heat_section.h"

#include <nlohmann/json.hpp>

#include "common/model/states.h"
#include "common/picture/draw_picture.h"
#include "testing/cases/heat_json.h"

namespace troupe {

nlohmann::json ToJson(const TestHeat& heat) {
  nlohmann::json kinds = nlohmann::json::array();
  for (const HeatKind kind : heat.kinds) kinds.push_back(NameOf(kind));
  return {{"of", std::move(kinds)}, {"cell", heat.cell}};
}

TestHeat ReadTestHeat(const JsonReader& reader) {
  TestHeat heat;
  heat.kinds = reader.Get<std::vector<HeatKind>>("of");
  heat.cell = reader.Number("cell", HeatMap::kMinCell, HeatMap::kMaxCell).value_or(heat.cell);
  return heat;
}

void HeatSection::Add(const std::vector<HeatMap>& maps) {
  for (std::size_t i = 0; i < maps.size() && i < maps_.size(); ++i) maps_[i].Add(maps[i]);
}

Status HeatSection::Merge(const JsonReader& reader) {
  EncodedWorld world;
  if (const auto encoded = reader.Find("world")) {
    world = {encoded->Get<std::uint64_t>("bytes"), encoded->Get<std::string>("zstd")};
  }
  const std::optional<JsonReader> list = reader.Find("heat_maps");
  const std::vector<HeatMap> maps = list ? ReadHeatMaps(*list) : std::vector<HeatMap>();
  if (!reader.ok()) return reader.status();
  bool same = maps.size() == maps_.size();
  for (std::size_t i = 0; same && i < maps.size(); ++i) {
    same = maps[i].kind() == maps_[i].kind() && maps[i].smallest_cell() == maps_[i].smallest_cell();
  }
  if (!same) return BadInput("found heat maps of another test, expected those that its line names");
  if (const Result<WorldDescription> decoded = Decode(world); !decoded.ok()) return decoded.error();
  if (merged_++ == 0) world_ = std::move(world);
  Add(maps);
  return {};
}

std::string HeatSection::FileName(const HeatMap& map) {
  return "-heat-" + std::string(NameOf(map.kind())) + ".png";
}

Result<std::string> HeatSection::Draw(const HeatMap& map, std::uint64_t runs) const {
  const Result<WorldDescription> world = Decode(world_);
  if (!world.ok()) return world.error();
  HeatMap shown = map;
  shown.SetRuns(runs);
  PictureOptions options;
  options.format = PictureFormat::kPng;
  return DrawPicture(world.value(), PlacedState(world.value()), {}, options, {}, &shown);
}

nlohmann::json ToJson(const HeatSection& section) {
  return {{"heat_maps", ToJson(section.maps())},
          {"world", {{"bytes", section.world().bytes}, {"zstd", section.world().zstd}}}};
}

}  // namespace troupe
