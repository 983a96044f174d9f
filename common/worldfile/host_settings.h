// The machines that a scenario runs on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace troupe {

struct HostSettings {
  std::string name;     // in messages
  std::string address;  // by which the other machines reach it
  // How to start a process there, for a shell: docs/scenarios.md has its placeholders. Empty: by ssh.
  std::string start;
  std::string programs;           // the folder of Troupe's programs there; empty: the same as here
  std::string network_interface;  // name, address or "auto"; empty: the one that has `address`
  bool service = false;           // the world service runs there
  // Which robots run there: those with these names (* and ? stand for others), or this many of those that no host
  // names. Neither: an equal share of the rest.
  std::vector<std::string> robot_names;
  std::optional<std::uint32_t> robot_count;
  SourceLocation where;
};

// How a scenario is spread over a network.
struct HostsOfScenario {
  std::vector<HostSettings> hosts;  // none: this machine only
  std::string network;              // a profile of common/dds/domain_config.h; empty: not said
};

}  // namespace troupe
