// RunKeys: the keys of a run's processes (docs/security.md), made by the launcher for this run alone or taken from a
// folder of the user's.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/run/network_settings.h"
#include "common/security/key_authority.h"
#include "launcher/hosts/host.h"

namespace troupe {

class RunKeys {
 public:
  RunKeys() = default;  // a run without security

  // As network.security says. Keys of the run alone are in a folder that only this user can read, which is deleted with
  // this object, together with those that launchers have left which were killed.
  static Result<RunKeys> Make(const NetworkSettings& network);

  RunKeys(RunKeys&& other) noexcept;
  RunKeys& operator=(RunKeys&& other) noexcept;
  ~RunKeys();

  bool any() const { return !folder_.empty(); }

  // The value of --security for the world service, with keys for it and for tools, or for the agent of these robots, on
  // the process' host: "off" or a folder there. Copies the keys to a remote host.
  Result<std::string> ForService(Host& host) const;
  Result<std::string> ForAgent(Host& host, const std::vector<std::string>& robots) const;

 private:
  Result<std::string> PlaceOn(Host& host, const std::vector<Role>& roles) const;

  std::string folder_;                     // empty: no security
  bool temporary_ = false;                 // deleted at the end
  std::optional<KeyAuthority> authority_;  // makes the keys of agents when they start
};

}  // namespace troupe
