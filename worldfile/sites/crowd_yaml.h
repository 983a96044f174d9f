// The people of a building file: its key `crowd_sim`.
#pragma once

#include "worldfile/sites/site.h"
#include "worldfile/text/yaml_reader.h"

namespace troupe {

// An empty crowd for a missing value. Faults are reported to `yaml`.
SiteCrowd ReadCrowd(YamlReader& yaml, const YamlNode& node);

}  // namespace troupe
