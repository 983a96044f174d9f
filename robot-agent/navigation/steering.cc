#include "robot-agent/navigation/steering.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kTurnGain = 2.0;  // 1/s: turn rate for each radian of bearing

Command SteerCar(const DriveDescription& drive, const SteerSettings& settings, const Vec2& p_R, double speed) {
  const double square = std::max(p_R.squaredNorm(), 1e-6);
  Command command;
  if (p_R.x() > 0.0 || square > 16.0 * drive.wheelbase * drive.wheelbase) {
    command.speed = speed;
    command.steering = Atan2(2.0 * drive.wheelbase * p_R.y(), square);
    if (p_R.x() <= 0.0) command.steering = p_R.y() >= 0.0 ? 0.5 * kPi : -0.5 * kPi;  // as far as it can
  } else {
    // A point beside or behind that is too near to turn to: it backs off, turning its front to the point.
    command.speed = -0.5 * std::min(speed, settings.speed);
    command.steering = p_R.y() >= 0.0 ? -0.5 * kPi : 0.5 * kPi;
  }
  command.steering = drive.velocity.heading.Clamp(command.steering);
  return command;
}

// A robot that has moved by less rests.
constexpr double kRestDistance = 0.01;  // m
constexpr double kRestAngle = 0.02;     // rad
constexpr double kPlaceRadius = 0.05;   // m: within it all stalls are at one place
constexpr double kCalmTime = 5.0;       // s without a stall, after which the next one is another one
// Of a motion without a contact: as random as its direction, so that no two robots block each other for ever.
constexpr double kMinMotion = 0.5;  // s
constexpr double kMaxMotion = 2.0;  // s

constexpr int kBearings = 72;            // candidates
constexpr double kLookAhead = 1.5;       // m: obstacles farther away do not matter yet
constexpr double kCourseWeight = 0.35;   // of a change of course, against the deviation from the point
constexpr double kBackOffTime = 1.0;     // s, after a stall
constexpr double kPatience = 10.0;       // s without progress until it roams
constexpr double kProgress = 0.2;        // m
constexpr double kRoamTime = 6.0;        // s
constexpr double kRoamCourseTime = 5.0;  // s, between random changes of course
constexpr double kSamePlace = 0.5;       // m: a point that moves by less is the same

Vec2 DirectionOf(double bearing) {
  const SinCosResult direction = SinCos(bearing);
  return {direction.cos, direction.sin};
}

constexpr double kSeparation = 2.0;  // weights, of the direction ahead 1
constexpr double kCohesion = 1.0;
constexpr double kAlignment = 1.0;

}  // namespace

double BrakingSpeed(const DriveDescription& drive, double distance) {
  const double braking = std::max(-drive.acceleration.x.min, 1e-3);
  return std::sqrt(2.0 * braking * std::max(distance, 0.0));
}

Command SteerToPoint(const DriveDescription& drive, const SteerSettings& settings, const Vec2& p_R, double most) {
  const double speed = std::min(settings.speed, most);
  if (drive.type == DriveType::kCar) return SteerCar(drive, settings, p_R, speed);
  const double bearing = Atan2(p_R.y(), p_R.x());
  const double facing = std::max(p_R.x() / std::max(std::sqrt(p_R.squaredNorm()), 1e-9), 0.0);
  Command command;
  command.twist.vx = speed * facing * facing;
  command.twist.wz = std::clamp(kTurnGain * bearing, -settings.turn_rate, settings.turn_rate);
  return command;
}

void Recovery::ObserveMotion(const Observation& observation) {
  const Pose& X_ER = observation.pose_estimate;
  const bool was_away = observation.time - called_at_ > 1.5 * observation.interval;
  called_at_ = observation.time;
  if (place_ && ((X_ER.translation() - *place_).squaredNorm() > kPlaceRadius * kPlaceRadius || was_away ||
                 observation.time - stalled_at_ > kCalmTime)) {
    place_.reset();
  }
  if (observation.stalled) {
    stalled_at_ = observation.time;
    if (!place_) {
      place_ = X_ER.translation();
      place_since_ = observation.time;
    }
  }
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

std::optional<Command> Recovery::Update(const Observation& observation, double patience, double place_patience) {
  ObserveMotion(observation);
  const double now = observation.time;
  if (motion_ && now >= motion_until_ && !observation.stalled) {
    motion_.reset();
    rest_since_ = now;
  }
  const bool rests = now - rest_since_ >= patience;
  const bool turns = patience < kNever && place_ && now - place_since_ >= place_patience;
  if ((!motion_ && (rests || turns)) || (motion_ && observation.stalled)) {
    motion_ = RandomMotion(observation);
    motion_until_ = now + kMinMotion + (kMaxMotion - kMinMotion) * observation.Random(19);
  }
  return motion_;
}

ClearSteering::ClearSteering(const RobotInfo& info, std::optional<std::size_t> ranger, const Settings& settings)
    : settings_(settings), drive_(info.robot->drive), recovery_(drive_, settings.steer), ranger_(ranger) {
  if (ranger_) rays_ = PlacedRaysOf(info, *ranger_);
}

void ClearSteering::SeeObstacles(const Observation& observation) {
  obstacles_.clear();
  if (!ranger_) return;
  const SensorReading& reading = observation.sensors[*ranger_];
  for (const PlacedRay& placed : *rays_) {
    const double range = RangeOf(reading, placed.ray);
    if (range >= placed.ray.max_range) continue;
    const Vec2 hit = placed.p_RO + range * placed.direction;
    const double reach = kLookAhead + settings_.clearance;
    if (hit.squaredNorm() <= reach * reach) obstacles_.push_back(hit);
  }
}

std::optional<Command> ClearSteering::Escape(const Observation& observation) {
  const double now = observation.time;
  const bool is_stuck = observation.stalled && now >= turn_until_;
  // A manoeuvre that was blocked from its start to its end is not repeated.
  const double patience = is_stuck ? std::max(now - stalled_at_, Recovery::kPatience) : Recovery::kNever;
  if (std::optional<Command> recovery = recovery_.Update(observation, patience)) {
    turn_until_ = now;
    last_course_.reset();
    return recovery;
  }
  if (is_stuck) {
    stalled_at_ = now;
    back_off_until_ = now + kBackOffTime;
    // A random angle, against an endless sequence of stalls of two robots that give way to the same side.
    const double angle = 0.25 * kPi + 0.5 * kPi * observation.Random(0);
    turn_until_ = back_off_until_ + angle / std::max(settings_.steer.turn_rate, 0.1);
    side_ = observation.Random(1) < 0.5 ? 1.0 : -1.0;
    last_course_.reset();
  }
  if (now < back_off_until_) return Drive(-0.5 * settings_.steer.speed, 0.0);
  if (now < turn_until_) return TurnAround();
  return std::nullopt;
}

bool ClearSteering::IsClear(double bearing, double distance, double clearance) const {
  const Vec2 direction = DirectionOf(bearing);
  return std::none_of(obstacles_.begin(), obstacles_.end(), [&](const Vec2& obstacle) {
    const double along = obstacle.dot(direction);
    const double across = direction.x() * obstacle.y() - direction.y() * obstacle.x();
    return along > 0.0 && along < distance && std::abs(across) < clearance;
  });
}

std::optional<double> ClearSteering::ClearBearing(double wanted, double distance, double clearance,
                                                  double heading) const {
  std::optional<double> best;
  double least = 0.0;
  for (int i = -1; i < kBearings; ++i) {
    // The wanted bearing itself is the first candidate.
    const double bearing = i < 0 ? wanted : 2.0 * kPi * i / kBearings - kPi;
    // The deviation from the point and the change of course: without the latter two bearings of nearly equal cost would
    // alternate from tick to tick.
    double cost = std::abs(WrapAngle(bearing - wanted));
    if (last_course_) cost += kCourseWeight * std::abs(WrapAngle(heading + bearing - *last_course_));
    if (best && cost >= least) continue;
    if (!IsClear(bearing, distance, clearance)) continue;
    best = bearing;
    least = cost;
  }
  return best;
}

double ClearSteering::RoomAhead() const {
  double room = kLookAhead + settings_.clearance;
  for (const Vec2& obstacle : obstacles_) {
    if (obstacle.x() > 0.0 && std::abs(obstacle.y()) < 0.8 * settings_.clearance) room = std::min(room, obstacle.x());
  }
  return room;
}

Command ClearSteering::Steer(const Observation& observation, const Vec2& p_R, double most) {
  const double distance = std::sqrt(p_R.squaredNorm());
  const double look = std::clamp(distance, 0.3, kLookAhead);
  const double wanted = Atan2(p_R.y(), p_R.x());
  const double heading = observation.pose_estimate.heading;
  std::optional<double> bearing = ClearBearing(wanted, look, settings_.clearance, heading);
  // In a narrow place, or beside an obstacle.
  if (!bearing) bearing = ClearBearing(wanted, 0.5 * look, 0.6 * settings_.clearance, heading);
  if (!bearing) {
    last_course_.reset();
    return TurnAround();
  }
  last_course_ = WrapAngle(heading + *bearing);
  side_ = *bearing >= 0.0 ? 1.0 : -1.0;
  const double room = RoomAhead() - 0.8 * settings_.clearance;
  const double speed = std::min(most, std::max(BrakingSpeed(drive_, room), 0.05));
  return SteerToPoint(drive_, settings_.steer, *bearing == wanted ? p_R : Vec2(look * DirectionOf(*bearing)), speed);
}

Command ClearSteering::Towards(const Observation& observation, const Vec2& p_R, double most) {
  SeeObstacles(observation);
  const double now = observation.time;
  const Vec2 target = Transform2(observation.pose_estimate) * p_R;
  const double distance = std::sqrt(p_R.squaredNorm());
  const bool is_new = (target - best_target_).squaredNorm() > kSamePlace * kSamePlace;
  if (is_new || distance < best_distance_ - kProgress) {
    best_target_ = target;
    best_distance_ = distance;
    progress_at_ = now;
    if (is_new) roam_until_ = 0.0;
  }
  if (now - progress_at_ > kPatience) {
    roam_until_ = now + kRoamTime;
    roam_course_ = 2.0 * kPi * observation.Random(4);
    new_course_at_ = roam_until_;
    progress_at_ = roam_until_;
    best_distance_ = distance;
  }
  if (now < roam_until_) return Roam(observation);
  if (const std::optional<Command> escape = Escape(observation)) return *escape;
  return Steer(observation, p_R, most);
}

Command ClearSteering::Roam(const Observation& observation) {
  SeeObstacles(observation);
  if (const std::optional<Command> escape = Escape(observation)) return *escape;
  const double heading = observation.pose_estimate.heading;
  if (observation.time >= new_course_at_) {
    roam_course_ = WrapAngle(heading + 0.5 * kPi * (observation.Random(2) - 0.5));
    new_course_at_ = observation.time + kRoamCourseTime;
  }
  const double bearing = WrapAngle(roam_course_ - heading);
  Command command = Steer(observation, 2.0 * DirectionOf(bearing), settings_.steer.speed);
  // The robot continues where it found room, and does not push back to the old course.
  if (last_course_) roam_course_ = *last_course_;
  return command;
}

Command ClearSteering::LookAround(const Observation& observation) {
  if (drive_.type == DriveType::kCar) return Roam(observation);
  const double patience = observation.stalled ? Recovery::kPatience : Recovery::kNever;
  if (const std::optional<Command> recovery = recovery_.Update(observation, patience)) return *recovery;
  return Drive(0.0, 0.5);
}

Command ClearSteering::TurnAround() {
  return Drive(0.0, side_);
}

// `turn`: 1 to the left, -1 to the right. A car cannot turn on the spot: it turns backwards.
Command ClearSteering::Drive(double speed, double turn) const {
  Command command;
  if (drive_.type == DriveType::kCar) {
    command.speed = turn != 0.0 ? -0.5 * settings_.steer.speed : speed;
    command.steering = turn != 0.0 ? drive_.velocity.heading.Clamp(-0.5 * turn) : 0.0;
  } else {
    command.twist = {speed, 0.0, turn * settings_.steer.turn_rate};
  }
  return command;
}

Vec2 FlockDirection(const std::vector<Neighbour>& neighbours, double distance) {
  Vec2 wanted(1.0, 0.0);
  if (neighbours.empty()) return wanted;
  Vec2 separation = Vec2::Zero();
  Vec2 center = Vec2::Zero();
  Vec2 course = Vec2::Zero();
  for (const Neighbour& neighbour : neighbours) {
    const double apart = std::max(std::sqrt(neighbour.p_R.squaredNorm()), 1e-3);
    separation -= std::max(1.0 - apart / distance, 0.0) * neighbour.p_R / apart;
    center += neighbour.p_R;
    const SinCosResult heading = SinCos(neighbour.heading);
    course += Vec2(heading.cos, heading.sin);
  }
  const double count = static_cast<double>(neighbours.size());
  const Vec2 mean = center / count;
  const double apart = std::sqrt(mean.squaredNorm());
  // A middle at its distance neither attracts nor repels.
  const double pull = std::min(std::max(apart - distance, 0.0) / distance, 1.0);
  wanted += kSeparation * separation + kAlignment * course / count;
  if (apart > 1e-3) wanted += kCohesion * pull * mean / apart;
  return wanted.squaredNorm() < 1e-12 ? Vec2::Zero() : wanted;
}

double FlockSpeed(const Vec2& direction) {
  return std::clamp(0.5 + 0.25 * direction.x(), 0.2, 1.0);
}

}  // namespace troupe
