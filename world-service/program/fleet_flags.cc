#include "world-service/program/fleet_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "command_line/broker_flags.h"
#include "command_line/parse_command_line.h"

namespace troupe {

void AddFleetFlags(CLI::App& app, FleetOptions& options, const std::string& url_help, const std::string& group) {
  CLI::Option* const url =
      app.add_option("--vda5050", options.url, url_help)->check(NotEmpty())->type_name("URL")->group(group);
  constexpr double kSecond = 1000.0;  // ms
  app.add_option_function<double>(
         "--vda-wait", [&options](double milliseconds) { options.wait_seconds = milliseconds / kSecond; },
         "After a tick in which a vehicle has sent its state, wait so long for messages of the fleet control, in "
         "milliseconds of real time (default: 0)")
      ->check(NumberFromZero())
      ->type_name("MS")
      ->needs(url)
      ->group(group);
  AddBrokerFlags(app, options.files, group);
  for (const char* const name : {"--mqtt-ca", "--mqtt-cert", "--mqtt-key", "--mqtt-user"}) {
    FindOption(app, name).needs(url);
  }
}

std::vector<std::string> FleetArguments(const FleetOptions& options) {
  if (options.url.empty()) return {};
  std::vector<std::string> arguments = {"--vda5050=" + options.url};
  if (options.wait_seconds > 0.0) arguments.push_back(fmt::format("--vda-wait={}", options.wait_seconds * 1000.0));
  for (std::string& argument : BrokerArguments(options.files)) arguments.push_back(std::move(argument));
  return arguments;
}

}  // namespace troupe
