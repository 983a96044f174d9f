// A DDS domain and sessions that only this test process uses, and a wait for the asynchronous effects of DDS.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include "tests/support/reserved_domain.h"
#include "transport/dds/binding/domain_config.h"

namespace troupe::test {

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
