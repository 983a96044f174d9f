// Open-RMF's building files (`.building.yaml`, of rmf_traffic_editor) to a Site.
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
