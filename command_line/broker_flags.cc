#include "command_line/broker_flags.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "command_line/parse_command_line.h"

namespace troupe {

void AddBrokerFlags(CLI::App& app, mqtt::BrokerFiles& files, const std::string& group) {
  const auto add = [&](const char* name, std::string& file, const char* help) {
    app.add_option(name, file, help)->check(NotEmpty())->type_name("FILE")->group(group);
  };
  add("--mqtt-ca", files.ca, "With mqtts: certificates of the authorities of the broker (default: the system's)");
  add("--mqtt-cert", files.certificate, "With mqtts: certificate of the client; needs --mqtt-key");
  add("--mqtt-key", files.key, "With mqtts: key of the client's certificate");
  add("--mqtt-user", files.credentials, "File whose first line is USER:PASSWORD for the broker");
}

std::vector<std::string> BrokerArguments(const mqtt::BrokerFiles& files) {
  std::vector<std::string> arguments;
  const std::pair<const char*, const std::string&> options[] = {{"--mqtt-ca", files.ca},
                                                                {"--mqtt-cert", files.certificate},
                                                                {"--mqtt-key", files.key},
                                                                {"--mqtt-user", files.credentials}};
  for (const auto& [name, file] : options) {
    if (!file.empty()) arguments.push_back(std::string(name) + "=" + file);
  }
  return arguments;
}

}  // namespace troupe
