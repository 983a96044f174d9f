#include "robot-agent/program/command_line.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <iostream>

#include "common/base/version.h"

namespace troupe {
namespace {

CLI::Validator Seconds(bool zero_allowed) {
  return CLI::Validator(
      [zero_allowed](std::string& text) {
        double number = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool good = error == std::errc() && end == text.data() + text.size() && std::isfinite(number) &&
                          (zero_allowed ? number >= 0.0 : number > 0.0);
        const char* expected = zero_allowed ? "expected seconds, 0 or more" : "expected seconds, more than 0";
        return good ? std::string() : "found \"" + text + "\", " + expected;
      },
      "SECONDS");
}

CLI::Validator Domain() {
  return CLI::Validator(
      [](std::string& text) {
        std::uint32_t number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool good = error == std::errc() && end == text.data() + text.size() && number <= 230;
        return good ? std::string() : "found \"" + text + "\", expected a whole number from 0 to 230";
      },
      "N");
}

// A DDS partition that matches only itself.
CLI::Validator SessionName() {
  return CLI::Validator(
      [](std::string& text) {
        const bool good = !text.empty() && text.size() <= 64 &&
                          text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") ==
                              std::string::npos;
        return good ? std::string() : "found \"" + text + "\", expected 1 to 64 letters, digits, '.', '-' or '_'";
      },
      "NAME");
}

CLI::Validator NotEmpty() {
  return CLI::Validator([](std::string& text) { return std::string(text.empty() ? "found nothing" : ""); }, "NAME");
}

void AddOptions(CLI::App& app, CommandLine& line, std::string& faults) {
  app.add_option("--session", line.session, "name of the run to join")->check(SessionName())->required();
  app.add_option("--robot", line.agent.robots, "a robot to take up; may be given several times")
      ->check(NotEmpty())
      ->required()
      ->allow_extra_args(false);
  app.add_option("--domain", line.domain, "DDS domain")->check(Domain())->capture_default_str();
  app.add_option("--service", line.service_address, "where the world service is; default: this machine")
      ->type_name("HOST[:PORT]");
  app.add_option("--interface", line.network_interface, "network interface, or auto; default: lo, with --service auto")
      ->type_name("NAME");
  app.add_option("--lease", line.lease_seconds, "who is silent for longer is lost")
      ->check(Seconds(false))
      ->capture_default_str();
  app.add_option("--scans", line.agent.scan_log, "write all scans of its robots, as JSON lines")->type_name("FILE");
  app.add_option("--session-timeout", line.agent.session_timeout_seconds,
                 "for the world service to appear; 0: wait for ever")
      ->check(Seconds(true))
      ->capture_default_str();
  app.add_option("--faults", faults, "for tests: lose, delay, double and reorder what arrives")
      ->type_name("SPEC")
      ->check([](const std::string& text) {
        const Result<Faults> parsed = ParseFaults(text);
        return parsed.ok() ? std::string() : parsed.error().message;
      });
  app.add_option("--start-delay", line.start_delay_seconds, "for tests: wait before joining")->check(Seconds(true));
  app.set_version_flag("--version", std::string("robot-agent ") + VersionText());
}

}  // namespace

std::variant<CommandLine, int> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  std::string faults;
  CLI::App app("Simulates robots of a run: their sensors, controllers and drives.", "robot-agent");
  AddOptions(app, line, faults);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    std::cerr << "error: " << error.what() << "\n";
    return kExitBadInput;
  }
  if (!faults.empty()) line.faults = ParseFaults(faults).value();
  if (line.network_interface.empty()) line.network_interface = line.service_address.empty() ? "lo" : "auto";
  return line;
}

}  // namespace troupe
