#include "world-service/program/fleet_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "command_line/parse_command_line.h"

namespace troupe {

void AddFleetFlags(CLI::App& app, FleetOptions& options, const std::string& url_help) {
  CLI::Option* const url = AddBrokerOptions(app, options.broker, url_help);
  constexpr double kSecond = 1000.0;  // ms
  app.add_option_function<double>(
         "--vda5050-wait", [&options](double milliseconds) { options.wait_seconds = milliseconds / kSecond; },
         "After a tick in which a vehicle has sent its state, wait so long for messages of the fleet control, in "
         "milliseconds of real time (default: 0)")
      ->check(NumberFromZero())
      ->type_name("MS")
      ->group(url->get_group())
      ->needs(url);
}

std::vector<std::string> FleetArguments(const FleetOptions& options) {
  const BrokerOptions& broker = options.broker;
  std::vector<std::string> arguments;
  const std::pair<const char*, const std::string&> texts[] = {{"--vda5050", broker.url},
                                                              {"--vda5050-user", broker.credentials},
                                                              {"--vda5050-ca", broker.authorities},
                                                              {"--vda5050-cert", broker.certificate},
                                                              {"--vda5050-key", broker.key}};
  for (const auto& [name, text] : texts) {
    if (!text.empty()) arguments.push_back(std::string(name) + "=" + text);
  }
  if (options.wait_seconds > 0.0) {
    arguments.push_back(fmt::format("--vda5050-wait={}", options.wait_seconds * 1000.0));
  }
  return arguments;
}

}  // namespace troupe
