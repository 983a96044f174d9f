#include "command_line/network_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "command_line/option_checks.h"

namespace troupe {
namespace {

void AddDomainFlag(CLI::App& app, NetworkSettings& settings, const std::string& group) {
  const std::string help =
      fmt::format("DDS domain of the simulation, 0 to {} (default: {})", kMaxDomain, settings.domain);
  app.add_option("--domain", settings.domain, help)
      ->check(DdsDomain())
      ->type_name("D")
      ->envname("TROUPE_DOMAIN")
      ->group(group);
}

void AddInterfaceFlag(CLI::App& app, NetworkSettings& settings, const std::string& default_interface,
                      const std::string& group) {
  const std::string help =
      "Name or IPv4 address of the network interface; auto: chosen by DDS (default: " + default_interface + ")";
  app.add_option("--interface", settings.network_interface, help)
      ->check(InterfaceValue())
      ->type_name("NAME")
      ->group(group);
}

void AddSecurityFlag(CLI::App& app, NetworkSettings& settings, const std::string& automatic, const std::string& group) {
  app.add_option("--security", settings.security,
                 "Folder of keys (see 'troupe keys'); off: any program of the network is a peer; auto: " + automatic +
                     " (default: auto)")
      ->check(NotEmpty())
      ->type_name("DIR|on|auto|off")
      ->group(group);
}

void AddDataSharingFlag(CLI::App& app, NetworkSettings& settings, const std::string& group) {
  const auto set = [&settings](const std::string& text) { settings.data_sharing = text == "on"; };
  app.add_option_function<std::string>("--data-sharing", set,
                                       "Frames and proposals between processes of one machine: on: in shared memory; "
                                       "off: over the network (default: on)")
      ->check(OneOf({"on", "off"}))
      ->type_name("on|off")
      ->group(group);
}

}  // namespace

CLI::Option* AddSessionFlag(CLI::App& app, NetworkSettings& settings, const std::string& help,
                            const std::string& group) {
  return app.add_option("--session", settings.session, help)
      ->check(SessionName())
      ->type_name("NAME")
      ->envname("TROUPE_SESSION")
      ->group(group);
}

void AddServiceAddressFlag(CLI::App& app, NetworkSettings& settings, const std::string& help) {
  app.add_option("--service", settings.service_address, help)->type_name("HOST[:PORT]");
}

void AddProcessNetworkFlags(CLI::App& app, NetworkSettings& settings, const std::string& default_interface,
                            const std::string& security, const std::string& group) {
  AddDomainFlag(app, settings, group);
  AddInterfaceFlag(app, settings, default_interface, group);
  app.add_option("--network", settings.network_profile,
                 "Network profile: one-host, lan (with multicast) or unicast (default: one-host on the loopback "
                 "interface, lan on others)")
      ->check(NetworkName())
      ->type_name("NAME")
      ->group(group);
  AddSecurityFlag(app, settings, security, group);
  AddDataSharingFlag(app, settings, group);
  app.add_option("--lease", settings.lease_seconds,
                 fmt::format("Seconds of silence after which a process is lost, from {} to {} (default: {})",
                             kShortestLeaseSeconds, kLongestLeaseSeconds, settings.lease_seconds))
      ->check(LeaseValue())
      ->type_name("SECONDS")
      ->group(group);
}

void AddToolNetworkFlags(CLI::App& app, NetworkSettings& settings) {
  AddDomainFlag(app, settings, "Options");
  AddInterfaceFlag(app, settings, settings.network_interface, "Options");
  AddServiceAddressFlag(app, settings, "Address of a world service that multicast does not reach");
  AddSecurityFlag(app, settings, "the keys of your own runs on this host, if they have any", "Options");
}

}  // namespace troupe
