// dynamic: a body that moves to and fro, for worlds whose obstacles change.
#include <cmath>
#include <limits>
#include <optional>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/recovery.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

constexpr double kDefaultTurn = 0.8;  // rad/s, of a recovery

struct DynamicParameters {
  double speed = 0.4;     // m/s
  double distance = 2.0;  // m, of each way
  double pause = 1.0;     // s, at the end of each way
};

Result<DynamicParameters> ParseDynamic(const std::string& text) {
  DynamicParameters p;
  Parameters reader("dynamic", text);
  p.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.speed);
  p.distance = reader.ReadNumber("distance", {0.01, 10000.0}).value_or(p.distance);
  p.pause = reader.ReadNumber("pause", {0.0, 1e6}).value_or(p.pause);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class DynamicController final : public Controller {
 public:
  DynamicController(const RobotInfo& info, const DynamicParameters& parameters)
      : parameters_(parameters),
        car_(info.robot->drive.type == DriveType::kCar),
        recovery_(info.robot->drive, {parameters.speed, kDefaultTurn}) {}

  Command Update(const Observation& observation) override {
    traveled_ += std::abs(observation.twist.vx) * observation.interval;
    const bool is_stalled = observation.stalled && observation.time >= wait_until_;
    const bool is_stuck = is_stalled && traveled_ == 0.0 && last_traveled_ == 0.0;  // in both directions
    const double patience = is_stuck ? Recovery::kPatience : Recovery::kNever;
    if (const std::optional<Command> recovery = recovery_.Update(observation, patience)) {
      last_traveled_ = parameters_.distance;
      return *recovery;
    }
    // An obstacle ends the way, too.
    if (traveled_ >= parameters_.distance || is_stalled) {
      last_traveled_ = traveled_;
      traveled_ = 0.0;
      direction_ = -direction_;
      wait_until_ = observation.time + parameters_.pause;
    }
    Command command;
    if (observation.time < wait_until_) return command;
    const double speed = direction_ * parameters_.speed;
    if (car_) {
      command.speed = speed;
    } else {
      command.twist.vx = speed;
    }
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<DynamicController>(*this); }

 private:
  DynamicParameters parameters_;
  bool car_;
  Recovery recovery_;
  double direction_ = 1.0;                                          // 1: ahead
  double traveled_ = 0.0;                                           // m, on this way
  double last_traveled_ = std::numeric_limits<double>::infinity();  // m, on the way before
  double wait_until_ = 0.0;                                         // s, simulated
};

Status CheckDynamic(const std::string& parameters) {
  const Result<DynamicParameters> parsed = ParseDynamic(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateDynamic(const RobotInfo& info) {
  const Result<DynamicParameters> parameters = ParseDynamic(info.parameters);
  if (!parameters.ok()) return parameters.error();
  return std::unique_ptr<Controller>(std::make_unique<DynamicController>(info, parameters.value()));
}

}  // namespace

BuiltInController Dynamic() {
  return {"dynamic", CheckDynamic, CreateDynamic};
}

}  // namespace troupe
