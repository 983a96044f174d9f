// Validity: the time during which a certificate or a document counts.
#pragma once

#include <string>

namespace troupe {

// UTC, as "2030-12-31T23:59:59".
struct Validity {
  std::string not_before;
  std::string not_after;
};

}  // namespace troupe
