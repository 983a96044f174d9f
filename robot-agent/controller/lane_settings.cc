#include "robot-agent/controller/lane_settings.h"

#include <fmt/format.h>

#include <cstdint>
#include <vector>

#include "common/base/json_reader.h"
#include "common/base/text.h"

namespace troupe {

// Bounds are wide: they exclude values without sense, not unusual robots.
Result<LaneSettings> ParseLaneSettings(const std::string& text) {
  LaneSettings settings;
  const JsonReader reader = JsonReader::OfText(text, "lanes");
  if (reader.Number("graph", 0.0, 1e6)) reader.Read("graph", settings.graph);
  reader.Read("places", settings.places);
  reader.Read("repeat", settings.repeat);
  reader.Read("close_doors", settings.close_doors);
  reader.Read("planned", settings.planned);
  reader.Read("goods", settings.goods);
  reader.Read("keep_place", settings.keep_place);
  const auto read = [&](const char* key, double& value, double least, double most) {
    value = reader.Number(key, least, most).value_or(value);
  };
  read("wait", settings.wait, 0.0, 1e6);
  read("speed", settings.speed, 0.01, 100.0);
  read("dock_speed", settings.dock_speed, 0.01, 100.0);
  read("turn_rate", settings.turn_rate, 0.01, 100.0);
  read("tolerance", settings.tolerance, 0.02, 1.0);
  read("gap", settings.gap, 0.02, 10.0);
  read("charge_below", settings.charge_below, 0.0, 1.0);
  read("charge_to", settings.charge_to, 0.0, 1.0);
  read("delay_probability", settings.delay_probability, 0.0, 1.0);
  read("delay_min", settings.delay_min, 0.0, 1e6);
  read("delay_max", settings.delay_max, 0.0, 1e6);
  if (settings.delay_max < settings.delay_min) reader.FailWith("'delay_max' is below 'delay_min'");
  if (settings.charge_to < settings.charge_below) reader.FailWith("'charge_to' is below 'charge_below'");
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return settings;
}

// Checked when the controller is made, so that a misspelt place is an error of the file and not of the run.
Result<const LaneGraph*> FindLanes(const LaneSettings& settings, const RobotInfo& info) {
  if (info.lane_graphs.empty()) {
    return Error{{}, "lanes: the world has no lanes, expected a building or a layout with some"};
  }
  const LaneGraph* const graph =
      settings.graph ? FindGraph(info.lane_graphs, *settings.graph) : GraphAt(info.lane_graphs, info.start);
  if (graph == nullptr || graph->vertices.empty()) {
    std::vector<std::uint32_t> numbers;
    for (const LaneGraph& each : info.lane_graphs) numbers.push_back(each.number);
    return Error{{},
                 fmt::format("lanes: found no lanes of graph {}, expected one of: {}", settings.graph.value_or(0),
                             fmt::join(numbers, ", "))};
  }
  std::vector<std::string> names;
  for (const LaneVertex& vertex : graph->vertices) {
    if (!vertex.name.empty()) names.push_back(vertex.name);
  }
  for (const std::string& place : settings.places) {
    if (graph->Find(place)) continue;
    return Error{{},
                 fmt::format("lanes: the lanes have no place '{}', expected one of: {}{}", place,
                             fmt::join(names, ", "), DidYouMean(place, names))};
  }
  return graph;
}

}  // namespace troupe
