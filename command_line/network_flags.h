// The options by which the processes of a run, and its tools, find each other. The defaults that the help texts state
// are the values of `settings` at the time of the call; `settings` must outlive the parsing.
#pragma once

#include <string>

#include "common/run/network_settings.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace troupe {

// --session NAME, or the variable TROUPE_SESSION of the environment. Likewise --domain below and TROUPE_DOMAIN.
CLI::Option* AddSessionFlag(CLI::App& app, NetworkSettings& settings, const std::string& help,
                            const std::string& group = "Options");

// --service HOST[:PORT]
void AddServiceAddressFlag(CLI::App& app, NetworkSettings& settings, const std::string& help);

// For a process of a run: --domain, --interface, --network, --security, --data-sharing and
// --lease. `default_interface` and `security`
// (the meaning of "auto") are parts of help texts.
void AddProcessNetworkFlags(CLI::App& app, NetworkSettings& settings, const std::string& default_interface,
                            const std::string& security, const std::string& group = "Options");

// For a tool that observes or controls runs: --domain, --interface, --service and --security.
void AddToolNetworkFlags(CLI::App& app, NetworkSettings& settings);

}  // namespace troupe
