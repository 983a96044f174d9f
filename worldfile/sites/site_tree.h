// From a Site to the models of a world, and to its named places.
//
// A tree, not a world: scenarios override the properties of buildings like the properties of any file, and
// defines are available for robots to be added. Models: a group for each level with floors, lanes and walls, with its
// doors behind it, then the doors and the cabin of each lift, then robots, in the order of the file. Heights,
// thicknesses and names follow the worlds that Open-RMF generates, so that its tools find doors and lifts by name.
//
// Names of places are unique and stable: PlaceNames, PlacesOf and the lanes (worldfile/models/lanes.h) agree on them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "worldfile/sites/site.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// Doors stand open but for doors that nothing operates and a lift's doors on the levels without its cabin. The tree has
// a define for each robot model that building files name, and refers to the site.
Result<WorldTree> SiteTree(std::shared_ptr<const Site> site);

// Reads a building file, or a layout (lif_json.h), and makes its tree.
Result<WorldTree> ReadSiteTree(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

// The name of a door's model.
std::string DoorName(const SiteLevel& level, const SiteDoor& door);

// The names of vertices as places, by level and number; empty for vertices that are none.
std::vector<std::vector<std::string>> PlaceNames(const Site& site);

// The vertices with a name or a role, tagged with their roles and level.
std::vector<NamedPlace> PlacesOf(const Site& site);

}  // namespace troupe
