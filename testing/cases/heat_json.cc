#include "testing/cases/heat_json.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace troupe {

nlohmann::json ToJson(const std::vector<HeatMap>& maps) {
  nlohmann::json list = nlohmann::json::array();
  for (const HeatMap& map : maps) {
    const HeatMap::Times& times = map.times();
    nlohmann::json cells = nlohmann::json::array();
    for (const auto& [place, time] : times.cells) {
      cells.push_back(place.first);
      cells.push_back(place.second);
      cells.push_back(time);
    }
    list.push_back({{"of", NameOf(map.kind())},
                    {"cell", map.smallest_cell()},
                    {"joined", times.joined},
                    {"unit_ns", times.unit},
                    {"cells", std::move(cells)}});
  }
  return list;
}

std::vector<HeatMap> ReadHeatMaps(const JsonReader& list) {
  std::vector<HeatMap> maps;
  for (const JsonReader& each : list.Items()) {
    const auto kind = each.Get<HeatKind>("of");
    const auto cell = each.Get<double>("cell");
    HeatMap::Times times;
    times.joined = each.Get<int>("joined");
    times.unit = each.Get<std::int64_t>("unit_ns");
    const std::vector<JsonReader> cells = each.ItemsOf("cells");
    if (cells.size() % 3 != 0) each.Fail("a column, a row and a time of each cell");
    for (std::size_t i = 0; list.ok() && i < cells.size(); i += 3) {
      std::pair<std::int64_t, std::int64_t> place;
      cells[i].To(place.first);
      cells[i + 1].To(place.second);
      cells[i + 2].To(times.cells[place]);
    }
    Result<HeatMap> map = HeatMap::Of(kind, cell, std::move(times));
    if (!map.ok()) each.FailWith(map.error().message);
    if (!list.ok()) break;
    maps.push_back(std::move(map).value());
  }
  return maps;
}

}  // namespace troupe
