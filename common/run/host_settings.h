// HostSettings: the hosts of a scenario.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

struct HostSettings {
  std::string name;     // in messages
  std::string address;  // by which the other hosts reach it
  // Shell command that starts a process there; docs/scenarios.md has its placeholders. Empty: by ssh.
  std::string start;
  std::string programs;           // the folder of Troupe's programs there; empty: the same as here
  std::string network_interface;  // name, address or "auto"; empty: the one that has `address`
  bool service = false;           // the world service runs there
  // The robots there: those with these names (with wildcards * and ?), or this number of the robots that no host names.
  // Neither: an equal share of the other robots.
  std::vector<std::string> robot_names;
  std::optional<std::uint32_t> robot_count;
  SourceLocation where;
};

// The distribution of a scenario over hosts.
struct HostsOfScenario {
  std::vector<HostSettings> hosts;  // none: this host only
  std::string network;              // a profile of transport/dds/binding/domain_config.h; empty: the default
};

}  // namespace troupe
