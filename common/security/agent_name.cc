#include "common/security/agent_name.h"

#include <fmt/format.h>

#include <string_view>

#include "common/base/hash.h"

namespace troupe {

std::string AgentName(const std::vector<std::string>& robots) {
  Hasher hash;
  for (const std::string& robot : robots) hash.Add(std::string_view(robot));
  return fmt::format("{:016x}", hash.value());
}

}  // namespace troupe
