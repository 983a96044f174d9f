// Worlds of the Stage project, which are not part of this one: tests that need them skip without.
#pragma once

#include <cstdlib>
#include <string>

namespace troupe::test {

// Their folder: TROUPE_STAGE_WORLDS, or beside the checkout. It may be missing.
inline std::string StageWorldsFolder() {
  if (const char* folder = std::getenv("TROUPE_STAGE_WORLDS")) return folder;
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  return std::string(source != nullptr ? source : ".") + "/../shared/stage-worlds";
}

}  // namespace troupe::test
