// A model's colour: the properties `color` and `color_rgba`.
#pragma once

#include "troupe/world_description.h"
#include "worldfile/models/properties/property_reader.h"

namespace troupe {

// `otherwise` is the type's colour. A random colour is a function of `seed` and the model's id.
Color ReadColor(PropertyReader& reader, const Color& otherwise, std::uint64_t seed, ModelId model);

}  // namespace troupe
