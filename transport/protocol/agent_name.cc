#include "transport/protocol/agent_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "common/base/hash.h"

namespace troupe {

std::string AgentName(const std::vector<std::string>& robots) {
  std::vector<std::string> sorted = robots;
  std::sort(sorted.begin(), sorted.end());
  Hasher hash;
  for (const std::string& robot : sorted) hash.Add(std::string_view(robot));
  return fmt::format("{:016x}", hash.value());
}

}  // namespace troupe
