#include "robot-agent/navigation/recovery.h"

#include <array>
#include <cmath>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

// A robot that has moved by less rests.
constexpr double kRestDistance = 0.01;  // m
constexpr double kRestAngle = 0.02;     // rad
// Of a motion without a contact: as random as its direction, so that no two robots block each other for ever.
constexpr double kShortestMotion = 0.5;  // s
constexpr double kLongestMotion = 2.0;   // s

}  // namespace

void Recovery::ObserveMotion(const Observation& observation) {
  const Pose& X_ER = observation.pose_estimate;
  const bool was_away = observation.time - called_at_ > 1.5 * observation.interval;
  called_at_ = observation.time;
  if (rest_ && !was_away &&
      (X_ER.translation() - rest_->translation()).squaredNorm() <= kRestDistance * kRestDistance &&
      std::abs(WrapAngle(X_ER.heading - rest_->heading)) <= kRestAngle) {
    return;
  }
  rest_ = X_ER;
  rest_since_ = observation.time;
}

// Half of the motions lead ahead or back, by which a robot gets farther away than by a turn.
Command Recovery::RandomMotion(const Observation& observation) const {
  const double speed = observation.Random(16) < 0.5 ? 0.5 * settings_.speed : -0.5 * settings_.speed;
  const double side = observation.Random(17) < 0.5 ? 1.0 : -1.0;
  const double draw = observation.Random(18);
  Command command;
  if (drive_.type == DriveType::kCar) {
    command.speed = speed;
    command.steering = draw < 0.5 ? 0.0 : 0.5 * side;
  } else if (draw < 0.5) {
    command.twist.vx = speed;
  } else if (draw < 0.75 && drive_.type == DriveType::kOmni) {
    command.twist.vy = side * std::abs(speed);
  } else {
    command.twist.wz = side * settings_.turn_rate;
  }
  return command;
}

std::optional<Command> Recovery::Update(const Observation& observation, double patience) {
  ObserveMotion(observation);
  const double now = observation.time;
  if (motion_ && now >= motion_until_ && !observation.stalled) {
    motion_.reset();
    rest_since_ = now;
  }
  const bool begins = !motion_ && now - rest_since_ >= patience;
  if (begins || (motion_ && observation.stalled)) {
    motion_ = RandomMotion(observation);
    motion_until_ = now + kShortestMotion + (kLongestMotion - kShortestMotion) * observation.Random(19);
  }
  return motion_;
}

}  // namespace troupe
