// A DDS domain and sessions that only this test process uses, and a wait for the asynchronous effects of DDS.
// Tests run in parallel, also of several checkouts on one machine: a test that finds another's participants would join
// its run.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <thread>

#include "transport/dds/binding/domain_config.h"

namespace troupe::test {

// A DDS domain that no other test process on the same network uses at the same time.
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

inline std::uint32_t TestDomain() {
  static const std::uint32_t domain = ReserveDomain();
  return domain;
}

inline std::string TestSession(const std::string& name) {
  return name + "-" + std::to_string(getpid());
}

// Participants discover each other by multicast on the loopback interface.
inline dds::DomainConfig TestConfig() {
  dds::DomainConfig config;
  config.domain = TestDomain();
  return config;
}

// True as soon as `condition` is true; false after a timeout that suits the slowest machine.
template <typename Condition>
bool Eventually(Condition condition, double seconds = 20.0) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace troupe::test
