// wander: drives ahead, turns away from obstacles, backs off after a stall.
//
// Needs no map and no goal, and works with any ranger, or none: the usual load of a swarm, so that its Update is short.
// Choices that would be symmetric are random by Observation::Random.
#include <algorithm>
#include <cmath>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/rays.h"
#include "robot-agent/navigation/steering.h"
#include "troupe/deterministic_math.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

constexpr double kStopWay = 0.15;      // m, to where the circle that it keeps clear would meet an obstacle
constexpr int kVainStalls = 4;         // one after another
constexpr double kSameSeconds = 30.0;  // after a stall: another one is at the same thing, as far as it can know

struct WanderParameters {
  double speed = 0.4;           // m/s, ahead
  double turn_rate = 0.8;       // rad/s, with an obstacle ahead
  double min_distance = 1.0;    // m: it turns away from a nearer obstacle ahead
  double front_angle = 0.5;     // rad: bearings within this are ahead
  double back_off_time = 1.0;   // s of driving backwards after a stall
  double steering_angle = 0.5;  // rad, car drives: steering in a turn
  double clearance = 0.0;       // m: it keeps a circle of this radius about its origin clear; 0: none
};

Result<WanderParameters> ParseWander(const std::string& text) {
  WanderParameters p;
  Parameters reader("wander", text);
  p.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.speed);
  p.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.turn_rate);
  p.min_distance = reader.ReadNumber("min_distance", {0.0, 1000.0}).value_or(p.min_distance);
  p.front_angle = reader.ReadNumber("front_angle", {0.0, kPi}).value_or(p.front_angle);
  p.back_off_time = reader.ReadNumber("back_off_time", {0.0, 3600.0}).value_or(p.back_off_time);
  p.steering_angle = reader.ReadNumber("steering_angle", {0.0, 0.5 * kPi}).value_or(p.steering_angle);
  p.clearance = reader.ReadNumber("clearance", {0.0, 100.0}).value_or(p.clearance);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class WanderController final : public Controller {
 public:
  WanderController(const RobotInfo& info, const WanderParameters& parameters)
      : parameters_(parameters),
        car_(info.robot->drive.type == DriveType::kCar),
        recovery_(info.robot->drive, {parameters.speed, parameters.turn_rate}),
        needed_(parameters.min_distance) {
    ranger_ = FindBestRanger(info);
    if (ranger_) rays_ = RaysOf(info, *ranger_);
    if (ranger_ && parameters.clearance > 0.0) placed_rays_ = PlacedRaysOf(info, *ranger_);
  }

  std::vector<std::size_t> Subscriptions() const override {
    return ranger_ ? std::vector<std::size_t>{*ranger_} : std::vector<std::size_t>{};
  }

  Command Update(const Observation& observation) override {
    const View view = Look(observation);
    const double now = observation.time;
    const bool is_stuck = observation.stalled && now >= turn_until_;
    // A manoeuvre that was blocked from its start to its end is not repeated.
    const double patience = is_stuck ? std::max(now - stalled_at_, Recovery::kPatience) : Recovery::kNever;
    if (const std::optional<Command> recovery = recovery_.Update(observation, patience)) {
      turn_until_ = now;
      turn_ = 0.0;
      last_ = Motion::kOther;
      return *recovery;
    }
    if (is_stuck) Escape(observation, view);
    if (now < escape_until_ && (escape_ < 0.0 || view.front_is_clear))
      return Drive(0.5 * escape_ * parameters_.speed, 0.0);
    if (now < turn_until_) return Turn();
    if (view.front >= parameters_.min_distance && view.front_is_clear) needed_ = parameters_.min_distance;
    if (view.front >= needed_ && view.front_is_clear) {
      turn_ = 0.0;
      return Drive(parameters_.speed, 0.0);
    }
    // The side stays until the way is clear: a new choice in each tick could turn it to and fro in a corner.
    if (turn_ == 0.0) {
      turn_ = view.left_is_free ? 1.0 : -1.0;
      turning_since_ = now;
    }
    // A whole circle without a clear front: in a narrow place less room has to do.
    if (!car_ && now - turning_since_ >= TurningTime(2.0 * kPi)) {
      needed_ *= 0.5;
      turning_since_ = now;
    }
    return keeps_circle() && now - turning_since_ < parameters_.back_off_time ? TurnWithRoom(view) : Turn();
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<WanderController>(*this); }

 private:
  enum class Motion { kOther, kAhead, kBack, kLeft, kRight };

  struct View {
    double front;                // m, the shortest range ahead
    bool left_is_free;           // there is at least as much room to the left as to the right
    bool front_is_clear = true;  // the circle about the body can move ahead
    bool back_is_clear = true;   // likewise; also where no ray looks
    bool near_front = false;     // something is in that circle, in its front half
    bool near_back = false;      // likewise in the other one
  };

  // A car does not turn on the spot.
  bool keeps_circle() const { return placed_rays_ && !car_; }

  // Away from a contact, then a turn by a random angle, against an endless sequence of stalls in one corner.
  void Escape(const Observation& observation, const View& view) {
    const double now = observation.time;
    // An obstacle that the ranger does not see, such as the railing of a gallery, looks like the side with more room.
    // So a robot that stalls again turns to the same side, by a larger angle, and leaves that obstacle behind.
    const bool again = stall_side_ != 0.0 && now - stalled_at_ < kSameSeconds;
    stalls_ = again ? stalls_ + 1 : 1;
    if (!again) stall_side_ = view.left_is_free ? 1.0 : -1.0;
    // Where its care has not helped, it does as a robot that sees less.
    const bool is_careful = keeps_circle() && stalls_ < kVainStalls;
    const bool in_turn = is_careful && (last_ == Motion::kLeft || last_ == Motion::kRight);
    if (in_turn) stall_side_ = last_ == Motion::kLeft ? -1.0 : 1.0;
    if (is_careful && last_ == Motion::kBack) {
      escape_ = 0.0;
    } else if (in_turn) {
      // What stops it in a turn is beside or behind it, perhaps where no ray looks: it leaves that behind, or turns to
      // the other side.
      escape_ = view.front_is_clear ? 1.0 : view.near_front && view.back_is_clear ? -1.0 : 0.0;
    } else {
      escape_ = view.back_is_clear ? -1.0 : 0.0;
    }
    stalled_at_ = now;
    escape_until_ = now + (escape_ != 0.0 ? parameters_.back_off_time : 0.0);
    const double least = again ? 0.5 * kPi : 0.25 * kPi;
    const double turn = escape_ > 0.0 ? 0.0 : least + 0.5 * kPi * observation.Random(0);
    turn_until_ = escape_until_ + TurningTime(turn);
    turn_ = stall_side_;
    if (is_careful) turning_since_ = escape_until_;
  }

  View Look(const Observation& observation) const {
    View view{parameters_.min_distance, true};
    if (!ranger_) {
      view.left_is_free = observation.Random(1) < 0.5;
      return view;
    }
    const SensorReading& reading = observation.sensors[*ranger_];
    double balance = 0.0;
    for (const RangerRay& ray : *rays_) {
      const double range = RangeOf(reading, ray);
      // A ray without a hit is clear, even if its maximum is below min_distance.
      const bool clear = range >= ray.max_range;
      if (std::abs(ray.bearing) <= parameters_.front_angle && !clear) view.front = std::min(view.front, range);
      if (std::abs(ray.bearing) <= 0.5 * kPi && ray.bearing != 0.0) balance += ray.bearing > 0.0 ? range : -range;
    }
    view.left_is_free = balance >= 0.0;
    if (placed_rays_) LookAround(reading, view);
    return view;
  }

  // Whether the circle about the body can move on before it meets an obstacle. Where it finds no way out in several
  // turns, a smaller one has to do.
  void LookAround(const SensorReading& reading, View& view) const {
    const double share = parameters_.min_distance > 0.0 ? needed_ / parameters_.min_distance : 1.0;
    const double radius = parameters_.clearance * std::min(1.0, 4.0 * share);
    for (const PlacedRay& placed : **placed_rays_) {
      const double range = RangeOf(reading, placed.ray);
      if (range >= placed.ray.max_range) continue;
      const Vec2 p_R = placed.p_RO + range * placed.direction;
      if (std::abs(p_R.y()) >= radius) continue;
      if (p_R.squaredNorm() < radius * radius) (p_R.x() > 0.0 ? view.near_front : view.near_back) = true;
      const double way = std::abs(p_R.x()) - std::sqrt(radius * radius - p_R.y() * p_R.y());
      if (way >= kStopWay) continue;
      (p_R.x() > 0.0 ? view.front_is_clear : view.back_is_clear) = false;
    }
  }

  double TurningTime(double angle) const { return parameters_.turn_rate > 0.0 ? angle / parameters_.turn_rate : 0.0; }

  // What has come into the circle, a robot or a person, could be touched by a corner of the body in a turn: it makes
  // room first, where there is some.
  Command TurnWithRoom(const View& view) {
    if (view.near_front && !view.near_back && view.back_is_clear) return Drive(-0.5 * parameters_.speed, 0.0);
    if (view.near_back && !view.near_front && view.front_is_clear) return Drive(0.5 * parameters_.speed, 0.0);
    return Turn();
  }

  // A car cannot turn on the spot: it turns backwards, away from the obstacle ahead.
  Command Turn() {
    return car_ ? Drive(-0.5 * parameters_.speed, -turn_ * parameters_.steering_angle)
                : Drive(0.0, turn_ * parameters_.turn_rate);
  }

  // `turn`: steering angle of a car, turn rate of any other drive.
  Command Drive(double speed, double turn) {
    last_ = speed > 0.0 ? Motion::kAhead : speed < 0.0 ? Motion::kBack : turn > 0.0 ? Motion::kLeft : Motion::kRight;
    Command command;
    if (car_) {
      command.speed = speed;
      command.steering = turn;
    } else {
      command.twist = {speed, 0.0, turn};
    }
    return command;
  }

  WanderParameters parameters_;
  bool car_;
  std::optional<std::size_t> ranger_;
  Shared<std::vector<RangerRay>> rays_;
  std::optional<Shared<std::vector<PlacedRay>>> placed_rays_;  // with a circle to keep clear
  Recovery recovery_;
  Motion last_ = Motion::kOther;  // of the last command
  double needed_;      // m: it turns away from a nearer obstacle ahead; min_distance, or less in a narrow place
  double turn_ = 0.0;  // 1: to the left, -1: to the right, 0: not turning
  double turning_since_ = 0.0;  // s, simulated, as all times: or since `needed_` was lowered
  double stalled_at_ = 0.0;     // when it last began to back off
  double stall_side_ = 0.0;     // to which it turned then; 0: it has not
  int stalls_ = 0;              // at the same thing
  double escape_ = 0.0;         // 1: it drives ahead from the contact, -1: back, 0: neither
  double escape_until_ = 0.0;
  double turn_until_ = 0.0;
};

Status CheckWander(const std::string& parameters) {
  const Result<WanderParameters> parsed = ParseWander(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateWander(const RobotInfo& info) {
  const Result<WanderParameters> parameters = ParseWander(info.parameters);
  if (!parameters.ok()) return parameters.error();
  return std::unique_ptr<Controller>(std::make_unique<WanderController>(info, parameters.value()));
}

}  // namespace

BuiltInController Wander() {
  return {"wander", CheckWander, CreateWander};
}

}  // namespace troupe
