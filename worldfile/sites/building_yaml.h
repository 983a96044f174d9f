// Open-RMF's building files (`.building.yaml`, of rmf_traffic_editor) to a Site.
//
// The scales and the alignment of levels follow rmf_building_map_tools, so that coordinates agree with a running
// Open-RMF. Furniture is left out, because a building file has names of meshes only. Levels are moved apart vertically
// where a plan has them at one height: x and y are shared, and bodies must not overlap.
//
// An error for a broken reference or number; a warning, once per kind, for a part without effect. A pure function of
// the text; files of strangers are limited in size (yaml_reader.h), levels and lifts.
#pragma once

#include <string>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/sites/site.h"

namespace troupe {

// True if a file of this name is a building.
inline bool IsBuildingPath(const std::string& path) {
  return path.ends_with(".building.yaml") || path.ends_with(".building.yml");
}

// Reads a building. The site's warnings name once each part without effect or simulation.
Result<Site> ReadBuilding(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

// The same from text; `path` names it in messages.
Result<Site> ReadBuildingText(const std::string& text, const std::string& path);

}  // namespace troupe
