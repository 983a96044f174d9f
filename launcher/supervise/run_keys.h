// RunKeys: the keys of a run's processes (docs/security.md), made by the launcher for this run alone or read from a
// folder of the user's.
//
// On the loopback interface a random token is enough, which all processes of the run know. With DDS Security each agent
// gets an identity of its own, never the authority that signs identities: an agent on a host that was broken into
// cannot make keys for another robot. Identities of agents are made when they start, so an agent that is added by an
// edit has one, too.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "launcher/hosts/host.h"
#include "transport/security/key_authority.h"
#include "transport/security/session_keys.h"
#include "troupe/result.h"

namespace troupe {

class RunKeys {
 public:
  RunKeys() = default;  // a run without security

  // As network.security says. Keys of the run alone are in a folder that only this user can read, which is deleted with
  // this object.
  static Result<RunKeys> Make(const NetworkSettings& network);

  // The run's participants authenticate each other by DDS Security.
  bool secured() const { return !folder_.empty() && !token_; }

  // The value of --security for the world service, with keys for it and for tools, or for the agent of these robots, on
  // the process' host: "off" or a folder there. Copies the keys to a remote host.
  Result<std::string> ForService(Host& host) const;
  Result<std::string> ForAgent(Host& host, const std::vector<std::string>& robots) const;
  // The folder of keys for a tool on the launcher's host.
  std::string ForTools() const { return folder_.empty() ? kSecurityOff : folder_; }

 private:
  Result<std::string> PlaceOn(Host& host, const std::vector<std::string>& folders) const;

  RunKeysFolder own_;                      // of keys for this run alone
  std::string folder_;                     // empty: no security
  bool token_ = false;                     // the folder has a token, and no keys of DDS Security
  std::optional<KeyAuthority> authority_;  // makes the keys of agents when they start
};

}  // namespace troupe
