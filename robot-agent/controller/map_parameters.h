// The parameters of controllers that make a map.
#pragma once

#include <fmt/format.h>

#include "robot-agent/navigation/mapped_route.h"
#include "troupe/parameters.h"

namespace troupe {

// `map_size` and `cell`, both in m.
inline MappedRoute::Settings ReadMapSettings(Parameters& reader, double clearance) {
  MappedRoute::Settings settings;
  settings.clearance = clearance;
  settings.side = reader.ReadNumber("map_size", {1.0, 10000.0}).value_or(settings.side);
  settings.cell = reader.ReadNumber("cell", {0.02, 10.0}).value_or(settings.cell);
  if (settings.side / settings.cell > EvidenceGrid::kMostCells) {
    reader.Fail(fmt::format("a map of {:g} m with cells of {:g} m has more than {:g} cells along a side", settings.side,
                            settings.cell, EvidenceGrid::kMostCells));
  }
  return settings;
}

}  // namespace troupe
