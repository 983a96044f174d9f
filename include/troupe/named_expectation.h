// The texts by which a scenario says how its runs are judged. A run is the same with and without them; files,
// recordings and pages pass them on, and troupe/expectation.h reads them.
#pragma once

#include <optional>
#include <string>

#include "troupe/polygon.h"

namespace troupe {

// An expectation of a scenario.
struct NamedExpectation {
  std::string name;  // of an entry without one: its text
  std::string text;  // in the language of expectations
  bool operator==(const NamedExpectation&) const = default;
};

// An area that an expectation names: in(r, door).
struct NamedRegion {
  std::string name;
  Polygon outline;               // m, in W; simple
  std::optional<double> z = {};  // m, of its floor: a region of one level of a building; nothing: at any height
};

}  // namespace troupe
