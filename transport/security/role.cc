#include "transport/security/role.h"

namespace troupe {

bool IsAgentName(const std::string& name) {
  constexpr std::size_t kMaxLength = 64;
  return !name.empty() && name.size() <= kMaxLength &&
         name.find_first_not_of("0123456789abcdefghijklmnopqrstuvwxyz") == std::string::npos;
}

std::string KeyFolder(const Role& role) {
  switch (role.kind) {
    case Role::Kind::kService:
      return "service";
    case Role::Kind::kAgent:
      return "agents/" + role.agent_name;
    case Role::Kind::kOperator:
      return "operator";
    case Role::Kind::kObserver:
      return "observer";
  }
  return {};
}

}  // namespace troupe
