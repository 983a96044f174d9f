// A DDS domain that no other test process on the same network uses at the same time.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace troupe::test {

// A free domain, reserved until this process ends by the name of a Unix socket in the abstract namespace:
// such names end with their process, by whatever cause, and belong to one network namespace, as the loopback
// interface is.
inline std::uint32_t ReserveDomain() {
  // From 1, because 0 is the default of all programs; to so low a limit, because higher domains use ports of the range
  // that Linux assigns to any socket.
  constexpr std::uint32_t kDomains = 100;
  const int holder = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  for (std::uint32_t i = 0; i < kDomains; ++i) {
    const std::uint32_t domain = 1 + (static_cast<std::uint32_t>(getpid()) + i) % kDomains;
    const std::string name = "troupe-test-domain-" + std::to_string(domain);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(name.begin(), name.end(), address.sun_path + 1);  // the first byte stays 0: abstract
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (bind(holder, reinterpret_cast<const sockaddr*>(&address), size) == 0) return domain;
  }
  throw std::runtime_error("no DDS domain can be reserved for this test");
}

}  // namespace troupe::test
