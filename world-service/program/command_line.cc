#include "world-service/program/command_line.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <map>

#include "common/base/version.h"

namespace troupe {
namespace {

// The text as a number, if all of it is one.
std::optional<double> ParseNumber(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

CLI::Validator Seconds(bool zero_allowed) {
  const std::string expected = zero_allowed ? "expected seconds, 0 or more" : "expected seconds, more than 0";
  return CLI::Validator(
      [zero_allowed, expected](std::string& text) {
        const std::optional<double> number = ParseNumber(text);
        const bool good = number && (zero_allowed ? *number >= 0.0 : *number > 0.0);
        return good ? std::string() : "found \"" + text + "\", " + expected;
      },
      "SECONDS");
}

CLI::Validator WholeNumber(std::uint64_t max) {
  return CLI::Validator(
      [max](std::string& text) {
        std::uint64_t number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool good = error == std::errc() && end == text.data() + text.size() && number <= max;
        return good ? std::string()
                    : "found \"" + text + "\", expected a whole number from 0 to " + std::to_string(max);
      },
      "N");
}

CLI::Validator SpeedValue() {
  return CLI::Validator(
      [](std::string& text) {
        const std::optional<double> number = ParseNumber(text);
        const bool good = text == "max" || (number && *number > 0.0);
        return good ? std::string() : "found \"" + text + "\", expected a multiple of real time above 0, or max";
      },
      "X|max");
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

// One of the words in `values`, to its value.
template <typename Value>
void AddChoice(CLI::App& app, const std::string& name, std::optional<Value>& target,
               const std::map<std::string, Value>& values, const std::string& description) {
  std::string words;
  for (const auto& [word, value] : values) words += (words.empty() ? "" : "|") + word;
  app.add_option_function<std::string>(
         name, [&target, values](const std::string& word) { target = values.at(word); }, description)
      ->type_name(words)
      ->check([values, words](const std::string& word) {
        return values.contains(word) ? std::string() : "found \"" + word + "\", expected " + words;
      });
}

void AddOptions(CLI::App& app, CommandLine& line, std::string& speed, std::string& faults) {
  constexpr std::uint64_t kAny = std::numeric_limits<std::int64_t>::max();
  app.add_option("file", line.file, "a Stage world (.world), a scenario (.json) or a ROS map (.yaml)")->required();
  app.add_option("--ticks", line.ticks, "end after this many ticks; otherwise run until stopped")
      ->check(WholeNumber(kAny));
  app.add_option("--seed", line.overrides.seed, "seed of everything random")->check(WholeNumber(kAny));
  AddChoice<Mode>(app, "--mode", line.mode, {{"lockstep", Mode::kLockstep}, {"realtime", Mode::kRealtime}},
                  "lockstep waits for every robot; realtime does not, and is not repeatable");
  app.add_option("--speed", speed, "multiple of real time, or max")->check(SpeedValue());
  app.add_option("--controller", line.overrides.controller, "controller of robots that have none");
  app.add_option("--session", line.session, "name of the run; agents join by it")
      ->check(SessionName())
      ->capture_default_str();
  app.add_option("--domain", line.domain, "DDS domain")->check(WholeNumber(230))->capture_default_str();
  app.add_option("--interface", line.network_interface, "network interface, or auto")->capture_default_str();
  AddChoice<OnAgentLoss>(
      app, "--on-agent-loss", line.on_agent_loss,
      {{"freeze", OnAgentLoss::kFreeze}, {"pause", OnAgentLoss::kPause}, {"abort", OnAgentLoss::kAbort}},
      "what becomes of a robot whose agent is lost, and of the run");
  app.add_option("--hash-log", line.service.outputs.hash_log, "write the state hash of every tick");
  app.add_option("--poses", line.service.outputs.poses, "write all poses at every tick, as CSV");
  app.add_option("--record", line.service.outputs.record, "write states and events of every tick, as JSON lines");
  app.add_option("--lease", line.service.lease_seconds, "an agent that is silent for longer is lost")
      ->check(Seconds(false))
      ->capture_default_str();
  app.add_option("--start-timeout", line.service.start_timeout_seconds, "for all robots to join; 0: wait for ever")
      ->check(Seconds(true))
      ->capture_default_str();
  app.add_option("--faults", faults, "for tests: lose, delay, double and reorder what arrives")
      ->check([](const std::string& text) {
        const Result<Faults> parsed = ParseFaults(text);
        return parsed.ok() ? std::string() : parsed.error().message;
      });
  app.add_option("--report-fd", line.report_fd, "descriptor to report to, as JSON lines, for a launcher")
      ->check(WholeNumber(1 << 20));
  app.set_version_flag("--version", std::string("world-service ") + VersionText());
}

}  // namespace

void CommandLine::ApplyTo(RunSettings& settings) const {
  if (ticks) settings.ticks = ticks;
  if (mode) settings.mode = *mode;
  if (speed || speed_max) settings.speed = speed;
  if (on_agent_loss) settings.on_agent_loss = *on_agent_loss;
}

std::variant<CommandLine, int> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  std::string speed;
  std::string faults;
  CLI::App app("Runs a world: waits for the agents of its robots, and decides what happens at each tick.",
               "world-service");
  AddOptions(app, line, speed, faults);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    std::cerr << "error: " << error.what() << "\n";
    return kExitBadInput;
  }
  line.speed_max = speed == "max";
  if (!line.speed_max) line.speed = ParseNumber(speed);
  line.faults = ParseFaults(faults).value();
  line.service.session = line.session;
  return line;
}

}  // namespace troupe
