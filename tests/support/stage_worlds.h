// The sample worlds of the Stage project, which are not part of this one. Tests that need them are skipped without
// them.
#pragma once

#include <cstdlib>
#include <string>

namespace troupe::test {

// Their folder, which may not exist: TROUPE_STAGE_WORLDS, or one beside the checkout.
inline std::string StageWorldsFolder() {
  if (const char* folder = std::getenv("TROUPE_STAGE_WORLDS")) return folder;
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  return std::string(source != nullptr ? source : ".") + "/../shared/stage-worlds";
}

}  // namespace troupe::test
