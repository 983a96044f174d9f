// The people of a building file: its key `crowd_sim`.
//
// Names are checked here, so that users of a SiteCrowd may look them up without a test. The profiles' parameters of
// ORCA (neighbours, horizons) are kept for the export only: the world service has its own.
#pragma once

#include "worldfile/sites/site.h"
#include "worldfile/text/yaml_reader.h"

namespace troupe {

// An empty crowd for a missing value. Faults are reported to `yaml`.
SiteCrowd ReadCrowd(YamlReader& yaml, const YamlNode& node);

}  // namespace troupe
