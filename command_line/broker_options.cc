#include "command_line/broker_options.h"

#include <CLI/CLI.hpp>

#include "command_line/parse_command_line.h"

namespace troupe {

CLI::Option* AddBrokerOptions(CLI::App& command, BrokerOptions& options, const std::string& help) {
  const char* group = "Broker";
  CLI::Option* const url = command.add_option("--vda5050", options.url, help)->check(NotEmpty())->type_name("URL");
  url->group(group);
  const auto add = [&](const char* name, std::string& file, const char* text) {
    return command.add_option(name, file, text)->check(NotEmpty())->type_name("FILE")->group(group)->needs(url);
  };
  add("--vda5050-user", options.credentials, "Its first line is USER:PASSWORD for the broker");
  add("--vda5050-ca", options.authorities,
      "The certificates that may have signed the broker's (default: the system's)");
  CLI::Option* const certificate = add("--vda5050-cert", options.certificate, "The certificate of this client");
  CLI::Option* const key = add("--vda5050-key", options.key, "The key of that certificate");
  certificate->needs(key);
  key->needs(certificate);
  return url;
}

Result<mqtt::Broker> BrokerOf(const BrokerOptions& options) {
  Result<mqtt::Broker> broker = mqtt::ParseBrokerUrl(options.url);
  if (!broker.ok()) return Error{{}, "--vda5050: " + broker.error().message};
  broker.value().ca_file = options.authorities;
  broker.value().certificate_file = options.certificate;
  broker.value().key_file = options.key;
  if (!options.credentials.empty()) {
    if (Status status = mqtt::ReadCredentials(options.credentials, broker.value()); !status.ok()) return status.error();
  }
  return broker;
}

}  // namespace troupe
