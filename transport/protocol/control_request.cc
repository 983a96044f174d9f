#include "transport/protocol/control_request.h"

#include <cmath>

namespace troupe::control {
namespace {

Error Malformed(const std::string& found, const std::string& expected) {
  return {{}, "found " + found + ", expected " + expected};
}

Status CheckName(const std::string& name) {
  return name.empty() ? Status(Malformed("no name", "that of a robot, an object or a model")) : Status();
}

struct Check {
  template <typename Kind>
  Status operator()(const Kind&) const {
    return {};
  }
  Status operator()(const Step& step) const {
    return step.ticks > 0 ? Status() : Status(Malformed("0 ticks to step", "at least 1"));
  }
  Status operator()(const Reset& reset) const {
    constexpr std::uint8_t kKnown = kResetTime | kResetState | kResetSpawned;
    if (reset.scopes == kResetAll || (reset.scopes != 0 && (reset.scopes & ~kKnown) == 0)) return {};
    return Malformed("the scopes " + std::to_string(reset.scopes), "1 to 7, or 255");
  }
  Status operator()(const Delete& removal) const { return CheckName(removal.name); }
  Status operator()(const SetPose& move) const { return CheckName(move.name); }
  Status operator()(const Restore& restore) const { return CheckName(restore.source); }
  Status operator()(const SetTwist& turn) const { return CheckName(turn.name); }
  Status operator()(const Lift& call) const { return CheckName(call.name); }
  Status operator()(const Light& light) const { return CheckName(light.name); }
  Status operator()(const Door& door) const {
    if (!(door.opening >= 0.0 && door.opening <= 1.0)) return Malformed("an opening of a door", "0 to 1");
    return CheckName(door.name);
  }
  Status operator()(const Speed& speed) const {
    if (!speed.speed || (*speed.speed > 0.0 && std::isfinite(*speed.speed))) return {};
    return Error{{}, "found a speed that is not a positive number"};
  }
  Status operator()(const CommandRobot& command) const {
    if (command.ticks == 0 || command.ticks > kMaxCommandTicks) {
      return Malformed("a command for " + std::to_string(command.ticks) + " ticks",
                       "1 to " + std::to_string(kMaxCommandTicks));
    }
    return CheckName(command.name);
  }
};

}  // namespace

Status CheckRequest(const Request& request) {
  return std::visit(Check(), request);
}

}  // namespace troupe::control
