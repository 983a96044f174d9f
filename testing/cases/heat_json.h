// Heat maps as JSON, for the processes of a session and for reports.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "common/base/json_reader.h"
#include "common/picture/heat_map.h"

namespace troupe {

// The maps in their order: of the cells only those with time in them, by column and row. Heights and runs are left out.
nlohmann::json ToJson(const std::vector<HeatMap>& maps);
// Other JSON is an error of the reader.
std::vector<HeatMap> ReadHeatMaps(const JsonReader& list);

}  // namespace troupe
