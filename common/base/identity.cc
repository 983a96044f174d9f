#include "common/base/identity.h"

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <random>

namespace troupe {

const char* VersionText() {
  return TROUPE_VERSION;
}

std::string HostName() {
  char name[256] = "";
  if (gethostname(name, sizeof name - 1) != 0 || name[0] == '\0') return "localhost";
  return name;
}

std::uint64_t MakeRandomId() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

std::optional<LocalAddress> MakeLocalAddress(const std::string& name) {
  LocalAddress result;
  result.address.sun_family = AF_UNIX;
  if (name.empty() || name.size() + 1 > sizeof result.address.sun_path) return std::nullopt;
  std::copy(name.begin(), name.end(), result.address.sun_path + 1);  // after a zero
  result.length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return result;
}

}  // namespace troupe
