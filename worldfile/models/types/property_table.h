// The table of all properties of world files, for help and for forms: docs/world-files.md and docs/sensors.md as rows.
// Rows that are fields of a description come from its list (field_properties.h).
#pragma once

#include <string>
#include <vector>

namespace troupe {

struct PropertyHelp {
  std::string type;  // of the models that have it; "*": all; "world": the file itself
  std::string name;  // without an index
  std::string form;  // "number", "flag" (0 or 1), "text", "texts", "color", "controller", choices "a|b", names "x y z"
  std::string unit;  // "m", "deg" (as unit_length and unit_angle say), "ms" ...; empty: none
  std::string initial;  // the default, as in a file; empty: none
  std::string help;
};

// Made at the first call; valid for the program's life. Any thread may call it.
const std::vector<PropertyHelp>& PropertyTable();

}  // namespace troupe
