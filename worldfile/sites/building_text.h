// A Site as the text of a building file.
//
// Round trip: positions are written with all their digits (the shortest text that reads as the same number), so that a
// building that is read, written and read again is the same building. Not a general writer of YAML: strings are JSON
// strings, which are YAML, too.
#pragma once

#include <string>

#include "worldfile/sites/site.h"

namespace troupe {

// In metres (`cartesian_meters`), without drawings and furniture but with workcells: ReadBuildingText makes the same
// levels, walls, floors, doors, lifts, lanes, vertices with their roles, robots and people of it.
std::string BuildingText(const Site& site);

}  // namespace troupe
