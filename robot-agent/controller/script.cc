// script: a timed list of commands.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/parameters.h"

namespace troupe {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A command is due at its time up to this much rounding in the tick's time, s.
constexpr double kTimeTolerance = 1e-9;

struct TimedCommand {
  double at = 0.0;  // s, simulated
  Command command;
  bool for_car = false;     // it gives speed or steering
  bool for_others = false;  // it gives vx, vy or wz
};

struct ScriptParameters {
  std::vector<TimedCommand> commands;
  double period = 0.0;  // s; 0: no repetition
};

TimedCommand ParseCommand(const nlohmann::json& json, std::size_t number, double earliest, Parameters& script) {
  TimedCommand timed;
  Parameters reader(fmt::format("script: command {}", number), json);
  if (!reader.ReadNumber("at", {0.0, kInfinity}, timed.at)) reader.Fail("'at' is missing, expected a time in seconds");
  const Interval any{-kInfinity, kInfinity};
  Command& command = timed.command;
  for (const auto& [key, value] : {std::pair<const char*, double*>{"vx", &command.twist.vx},
                                   {"vy", &command.twist.vy},
                                   {"wz", &command.twist.wz}}) {
    if (reader.ReadNumber(key, any, *value)) timed.for_others = true;
  }
  for (const auto& [key, value] :
       {std::pair<const char*, double*>{"speed", &command.speed}, {"steering", &command.steering}}) {
    if (reader.ReadNumber(key, any, *value)) timed.for_car = true;
  }
  if (timed.for_car && timed.for_others) {
    reader.Fail("gives both a twist (vx, vy, wz) and a car's command (speed, steering), expected one of them");
  }
  if (number > 1 && timed.at <= earliest) {
    reader.Fail(fmt::format("'at' is {}, expected a time after that of the command before it, {}", timed.at, earliest));
  }
  if (const std::string error = reader.Finish(); !error.empty())
    script.Fail(error.substr(std::string("script: ").size()));
  return timed;
}

std::string Parse(const std::string& json, ScriptParameters& p) {
  Parameters reader("script", json);
  for (const nlohmann::json& command : reader.ReadArray("commands")) {
    const double earliest = p.commands.empty() ? 0.0 : p.commands.back().at;
    p.commands.push_back(ParseCommand(command, p.commands.size() + 1, earliest, reader));
  }
  bool repeat = false;
  reader.ReadBool("repeat", repeat);
  double period = p.commands.empty() ? 0.0 : p.commands.back().at;
  const double shortest = period;
  const bool has_period = reader.ReadNumber("period", {0.0, kInfinity}, period);
  if (p.commands.empty()) reader.Fail("'commands' is missing or empty, expected a list of {\"at\": seconds, ...}");
  if (has_period && !repeat) reader.Fail("'period' is given without \"repeat\": true");
  if (repeat && period < shortest) {
    reader.Fail(fmt::format("'period' is {}, expected at least {}, the time of the last command", period, shortest));
  }
  if (repeat && period == 0.0) {
    reader.Fail("nothing to repeat: the last command is at 0 and there is no 'period', expected one of them above 0");
  }
  if (repeat) p.period = period;
  return reader.Finish();
}

class ScriptController final : public Controller {
 public:
  explicit ScriptController(ScriptParameters parameters) : parameters_(std::move(parameters)) {}

  Command Update(const Observation& observation) override {
    double time = observation.time + kTimeTolerance;
    if (parameters_.period > 0.0) time = std::fmod(time, parameters_.period);
    Command command;  // before the first command it stands still
    for (const TimedCommand& timed : parameters_.commands) {
      if (timed.at > time) break;
      command = timed.command;
    }
    return command;
  }

 private:
  ScriptParameters parameters_;
};

std::string Check(const std::string& parameters) {
  ScriptParameters ignored;
  return Parse(parameters, ignored);
}

// What a command asks for that the drive does not have; "" if nothing.
std::string Misfit(DriveType drive, const TimedCommand& timed) {
  switch (drive) {
    case DriveType::kCar:
      return timed.for_others ? "a car is driven by 'speed' and 'steering', not by 'vx', 'vy' and 'wz'" : "";
    case DriveType::kDifferential:
      if (timed.command.twist.vy != 0.0) return "a differential drive has no 'vy'";
      [[fallthrough]];
    case DriveType::kOmni:
      return timed.for_car ? "only a car is driven by 'speed' and 'steering', expected 'vx', 'vy' and 'wz'" : "";
  }
  return "";
}

Result<std::unique_ptr<Controller>> Create(const RobotInfo& info) {
  ScriptParameters parameters;
  if (const std::string error = Parse(info.parameters, parameters); !error.empty()) return Error{{}, error};
  for (std::size_t i = 0; i < parameters.commands.size(); ++i) {
    const std::string misfit = Misfit(info.robot->drive.type, parameters.commands[i]);
    if (!misfit.empty()) return Error{{}, fmt::format("script: command {}: {}", i + 1, misfit)};
  }
  return std::unique_ptr<Controller>(std::make_unique<ScriptController>(std::move(parameters)));
}

}  // namespace

BuiltInController Script() {
  return {"script", Check, Create};
}

}  // namespace troupe
