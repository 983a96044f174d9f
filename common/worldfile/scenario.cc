#include "common/worldfile/scenario.h"

namespace troupe {

Result<LoadedWorld> LoadScenario(const std::string& path, const LoadOverrides&) {
  return Error{{path}, "scenarios are not read yet"};
}

}  // namespace troupe
