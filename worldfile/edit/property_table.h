// The properties of world files, for help and for forms: docs/world-files.md and docs/sensors.md as a table.
#pragma once

#include <span>
#include <string_view>

namespace troupe {

struct PropertyHelp {
  std::string_view type;     // of the models that have it; "*": all; "world": the file itself
  std::string_view name;     // without an index
  std::string_view form;     // "number", "flag" (0 or 1), "text", "texts", a list of choices "a|b", or names: "x y z"
  std::string_view unit;     // "m", "deg" (as unit_length and unit_angle say), "ms" ...; empty: none
  std::string_view initial;  // the default, as in a file; empty: none
  std::string_view help;
};

std::span<const PropertyHelp> PropertyTable();

}  // namespace troupe
