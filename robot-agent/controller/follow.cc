// follow: drives behind a model that its fiducial finder sees.
#include <algorithm>
#include <cmath>
#include <optional>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/recovery.h"
#include "robot-agent/navigation/steer_to_point.h"
#include "troupe/deterministic_math.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

struct FollowParameters {
  SteerSettings steer;
  double distance = 1.0;  // m, that it keeps
  double id = 0.0;        // of the model; 0: the nearest of all
};

Result<FollowParameters> ParseFollow(const std::string& text) {
  FollowParameters p;
  Parameters reader("follow", text);
  p.id = reader.ReadNumber("id", {-1e9, 1e9}).value_or(p.id);
  p.distance = reader.ReadNumber("distance", {0.0, 1000.0}).value_or(p.distance);
  p.steer.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.steer.speed);
  p.steer.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.steer.turn_rate);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class FollowController final : public Controller {
 public:
  FollowController(const RobotInfo& info, const FollowParameters& parameters, std::size_t finder)
      : parameters_(parameters), drive_(info.robot->drive), recovery_(drive_, parameters.steer), finder_(finder) {}

  std::vector<std::size_t> Subscriptions() const override { return {finder_}; }

  Command Update(const Observation& observation) override {
    const FiducialReading* const reading = observation.sensors[finder_].As<FiducialReading>();
    if (reading == nullptr) return {};
    const double patience = observation.stalled ? Recovery::kPatience : Recovery::kNever;
    if (const std::optional<Command> recovery = recovery_.Update(observation, patience)) return *recovery;
    const Fiducial* const leader = FindLeader(*reading);
    if (leader == nullptr) return Search();
    const Vec2 p_R = (reading->X_RS * leader->X_SF).translation();
    side_ = p_R.y() >= 0.0 ? 1.0 : -1.0;
    const double rest = std::sqrt(p_R.squaredNorm()) - parameters_.distance;
    if (drive_.type == DriveType::kCar && rest <= 0.0) return {};
    return SteerToPoint(drive_, parameters_.steer, p_R, std::min(std::max(rest, 0.0), BrakingSpeed(drive_, rest)));
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<FollowController>(*this); }

 private:
  // Null if it sees none.
  const Fiducial* FindLeader(const FiducialReading& reading) const {
    const Fiducial* nearest = nullptr;
    for (const Fiducial& fiducial : reading.fiducials) {
      if (parameters_.id != 0.0 && static_cast<double>(fiducial.id) != parameters_.id) continue;
      if (nearest == nullptr || fiducial.range < nearest->range) nearest = &fiducial;
    }
    return nearest;
  }

  // It turns to the side on which it saw the leader last. A car waits.
  Command Search() const {
    Command command;
    if (drive_.type != DriveType::kCar) command.twist.wz = 0.5 * side_ * parameters_.steer.turn_rate;
    return command;
  }

  FollowParameters parameters_;
  DriveDescription drive_;
  Recovery recovery_;
  std::size_t finder_;
  double side_ = 1.0;  // 1: left
};

Status CheckFollow(const std::string& parameters) {
  const Result<FollowParameters> parsed = ParseFollow(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateFollow(const RobotInfo& info) {
  const Result<FollowParameters> parameters = ParseFollow(info.parameters);
  if (!parameters.ok()) return parameters.error();
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (!std::holds_alternative<FiducialParameters>(info.sensors[i].description->parameters)) continue;
    return std::unique_ptr<Controller>(std::make_unique<FollowController>(info, parameters.value(), i));
  }
  return Error{{}, "follow: the robot has no fiducial finder, expected one"};
}

}  // namespace

BuiltInController Follow() {
  return {"follow", CheckFollow, CreateFollow};
}

}  // namespace troupe
