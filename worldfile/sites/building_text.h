// A Site as the text of a building file.
#pragma once

#include <string>

#include "worldfile/sites/site.h"

namespace troupe {

// In metres (`cartesian_meters`), without drawings and furniture but with workcells: ReadBuildingText makes the same
// levels, walls, floors, doors, lifts, lanes, vertices with their roles, robots and people of it.
std::string BuildingText(const Site& site);

}  // namespace troupe
