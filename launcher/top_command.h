// `troupe top`: what runs in a domain, and how.
#pragma once

#include <cstdint>
#include <string>

namespace troupe {

struct TopOptions {
  std::uint32_t domain = 42;
  std::string session;  // empty: all
  std::string network_interface = "lo";
  std::string service_address;  // of a service that multicast does not reach: "host" or "host:port"
  bool once = false;            // print one table and end
};

// Returns the exit status.
int TopCommand(const TopOptions& options);

}  // namespace troupe
