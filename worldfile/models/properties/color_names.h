// Colours by name, as X11's rgb.txt has them: "red", "LightBlue", "gray30".
#pragma once

#include <optional>
#include <string_view>

#include "troupe/world_description.h"

namespace troupe {

// Exact spelling; nothing if there is no such colour.
std::optional<Color> FindColor(std::string_view name);

}  // namespace troupe
