// The key "zones" of a scenario: areas that robots heed, drawn as regions or read from the masks of Nav2.
//
// Two steps, as for people: entries are read with the scenario, and masks and lanes once the world is built.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/json_tree.h"
#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/models/build_world.h"
#include "worldfile/scenario/people_entries.h"

namespace troupe {

// A zone whose outline is known, or those of a mask.
struct ZoneEntry {
  ZoneDescription zone;
  SourceLocation where;                  // of its name
  std::vector<PeopleEntry::Goal> exits;  // of an evacuation zone
  std::optional<std::string> mask;
  SourceLocation mask_where;
  // Of a speed mask: a limit is base + multiplier * number, in m/s, or in percent of the zone's speed_limit if that is
  // above 0; 0 is none.
  double base = 0.0;
  double multiplier = 0.01;
};

// REQUIRES: the tree is valid by the schema.
Result<std::vector<ZoneEntry>> ReadZoneEntries(const JsonTree& tree, const JsonNode& root);

// Adds the zones to the world; a mask of one area is a zone of its name, one of several has zones NAME.1, NAME.2, ...
// The lanes through a one_way zone lead in its direction alone, in the world and in its site: those against it are left
// out. `path`: of the scenario.
Status AddZones(const std::vector<ZoneEntry>& entries, const std::string& path, const AllowedPaths& allowed,
                LoadedWorld& loaded);

}  // namespace troupe
