// Colours by name, as X11's rgb.txt has them: "red", "LightBlue", "gray30". The file is compiled in, so that a world
// looks alike on every machine. Channels from 0 to 1. Lookup by binary search in a constant table; any thread.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "troupe/world_description.h"
#include "worldfile/models/properties/property_reader.h"

namespace troupe {

struct NamedColor {
  std::string_view name;
  unsigned char r, g, b;
};

// All of them, sorted by name.
std::span<const NamedColor> NamedColors();

// Exact spelling; nothing if there is no such colour.
std::optional<Color> FindColor(std::string_view name);

// A model's colour: the properties `color` and `color_rgba`.
// `otherwise` is the type's colour. A random colour is a function of `seed` and the model's id.
Color ReadColor(PropertyReader& reader, const Color& otherwise, std::uint64_t seed, ModelId model);

}  // namespace troupe
