#include "world-service/program/fleet_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <utility>

#include "command_line/parse_command_line.h"

namespace troupe {
namespace {

constexpr char kLockstep[] = "lockstep";
constexpr double kSecond = 1000.0;  // ms

CLI::Validator WaitValue() {
  auto check = [](const std::string& text) -> std::string {
    if (text == kLockstep || NumberFromZero()(text).empty()) return "";
    return "found '" + text + "', expected a number from 0, or lockstep";
  };
  return CLI::Validator(check, "");
}

}  // namespace

void AddFleetFlags(CLI::App& app, FleetOptions& options, const std::string& url_help) {
  CLI::Option* const url = AddBrokerOptions(app, options.broker, url_help);
  app.add_option_function<std::string>(
         "--vda5050-wait",
         [&options](const std::string& text) {
           options.wait.is_lockstep = text == kLockstep;
           double milliseconds = 0.0;
           std::from_chars(text.data(), text.data() + text.size(), milliseconds);  // in any locale
           options.wait.quiet_seconds = milliseconds / kSecond;
         },
         "After a tick in which a vehicle has sent its state, wait until no message of the fleet control has come for "
         "so many milliseconds of real time; lockstep: after each tick in which a vehicle has sent a message, until "
         "the fleet control says that it has answered (default: 0)")
      ->check(WaitValue())
      ->type_name("MS|lockstep")
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
  if (options.wait.is_lockstep) {
    arguments.push_back(fmt::format("--vda5050-wait={}", kLockstep));
  } else if (options.wait.quiet_seconds > 0.0) {
    arguments.push_back(fmt::format("--vda5050-wait={}", options.wait.quiet_seconds * kSecond));
  }
  return arguments;
}

}  // namespace troupe
