#include "common/base/local_address.h"

#include <algorithm>
#include <cstddef>

namespace troupe {

std::optional<LocalAddress> MakeLocalAddress(const std::string& name) {
  LocalAddress result;
  result.address.sun_family = AF_UNIX;
  if (name.empty() || name.size() + 1 > sizeof result.address.sun_path) return std::nullopt;
  std::copy(name.begin(), name.end(), result.address.sun_path + 1);  // after a zero
  result.length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return result;
}

}  // namespace troupe
