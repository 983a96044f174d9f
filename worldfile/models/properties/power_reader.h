// The energy of a model in a file.
#pragma once

#include "troupe/world_description.h"
#include "worldfile/models/properties/property_reader.h"

namespace troupe {

// `joules`, `kjoules`, `joules_capacity`, `kjoules_capacity`, `watts`, `mass`, `give_watts` and `take_watts`. One of
// the first four makes a store; a store of negative `joules` is endless.
PowerDescription ReadPower(PropertyReader& reader);

}  // namespace troupe
