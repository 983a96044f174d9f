// wander: drives ahead, turns away from what it sees, backs off from what it ran into.
#include <algorithm>
#include <cmath>

#include "common/base/deterministic_math.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/parameters.h"
#include "robot-agent/controller/rays.h"

namespace troupe {
namespace {

struct WanderParameters {
  double speed = 0.4;           // m/s, ahead
  double turn_rate = 0.8;       // rad/s, when something is ahead
  double min_distance = 1.0;    // m: what is ahead and nearer makes it turn
  double front_angle = 0.5;     // rad: ahead is what lies within this of the heading
  double back_off_time = 1.0;   // s of driving backwards after a stall
  double steering_angle = 0.5;  // rad, car drives: steering in a turn
};

std::string Parse(const std::string& text, WanderParameters& p) {
  Parameters reader("wander", text);
  reader.ReadNumber("speed", {0.0, 100.0}, p.speed);
  reader.ReadNumber("turn_rate", {0.0, 100.0}, p.turn_rate);
  reader.ReadNumber("min_distance", {0.0, 1000.0}, p.min_distance);
  reader.ReadNumber("front_angle", {0.0, kPi}, p.front_angle);
  reader.ReadNumber("back_off_time", {0.0, 3600.0}, p.back_off_time);
  reader.ReadNumber("steering_angle", {0.0, 0.5 * kPi}, p.steering_angle);
  return reader.Finish();
}

class WanderController final : public Controller {
 public:
  WanderController(const RobotInfo& info, const WanderParameters& parameters)
      : parameters_(parameters), car_(info.robot->drive.type == DriveType::kCar) {
    ranger_ = FindScanner(*info.robot);
    if (!ranger_) ranger_ = FindSonar(*info.robot);
    if (!ranger_ && !info.robot->rangers.empty()) ranger_ = 0;
    if (ranger_) rays_ = RaysOf(info, *ranger_);
  }

  std::vector<std::size_t> Subscriptions() const override {
    return ranger_ ? std::vector<std::size_t>{*ranger_} : std::vector<std::size_t>{};
  }

  Command Update(const Observation& observation) override {
    const View view = Look(observation);
    const double now = observation.time;
    if (observation.stalled && now >= turn_until_) {
      back_off_until_ = now + parameters_.back_off_time;
      // Turning by a different angle each time keeps it from running into the same corner for ever.
      turn_until_ = back_off_until_ + TurningTime(0.25 * kPi + 0.5 * kPi * observation.Random(0));
      turn_ = view.left_is_free ? 1.0 : -1.0;
    }
    if (now < back_off_until_) return Drive(-0.5 * parameters_.speed, 0.0);
    if (now < turn_until_) return Turn();
    if (view.front >= parameters_.min_distance) {
      turn_ = 0.0;
      return Drive(parameters_.speed, 0.0);
    }
    // It keeps to the side it once chose until the way is clear: choosing anew could turn it to and fro in a corner.
    if (turn_ == 0.0) turn_ = view.left_is_free ? 1.0 : -1.0;
    return Turn();
  }

 private:
  struct View {
    double front;       // m, the shortest range ahead
    bool left_is_free;  // there is at least as much room to the left as to the right
  };

  View Look(const Observation& observation) const {
    View view{parameters_.min_distance, true};
    if (!ranger_) {
      view.left_is_free = observation.Random(1) < 0.5;
      return view;
    }
    const RangerReading& reading = observation.rangers[*ranger_];
    double balance = 0.0;
    for (const Ray& ray : rays_) {
      const double range = RangeOf(reading, ray);
      // A ray that sees no further than min_distance is clear when it sees nothing.
      const bool clear = range >= ray.max_range;
      if (std::abs(ray.bearing) <= parameters_.front_angle && !clear) view.front = std::min(view.front, range);
      if (std::abs(ray.bearing) <= 0.5 * kPi && ray.bearing != 0.0) balance += ray.bearing > 0.0 ? range : -range;
    }
    view.left_is_free = balance >= 0.0;
    return view;
  }

  double TurningTime(double angle) const { return parameters_.turn_rate > 0.0 ? angle / parameters_.turn_rate : 0.0; }

  // A car cannot turn on the spot: it turns backwards, away from what is ahead.
  Command Turn() const {
    return car_ ? Drive(-0.5 * parameters_.speed, -turn_ * parameters_.steering_angle)
                : Drive(0.0, turn_ * parameters_.turn_rate);
  }

  // `turn`: steering angle of a car, turn rate of any other drive.
  Command Drive(double speed, double turn) const {
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
  std::vector<Ray> rays_;
  double turn_ = 0.0;            // 1: to the left, -1: to the right, 0: not turning
  double back_off_until_ = 0.0;  // s, simulated
  double turn_until_ = 0.0;      // s, simulated
};

std::string CheckWander(const std::string& parameters) {
  WanderParameters ignored;
  return Parse(parameters, ignored);
}

Result<std::unique_ptr<Controller>> CreateWander(const RobotInfo& info) {
  WanderParameters parameters;
  if (const std::string error = Parse(info.parameters, parameters); !error.empty()) return Error{{}, error};
  return std::unique_ptr<Controller>(std::make_unique<WanderController>(info, parameters));
}

}  // namespace

BuiltInController Wander() {
  return {"wander", CheckWander, CreateWander};
}

}  // namespace troupe
