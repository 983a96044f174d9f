// expand: turns to where the room is and drives there, so that many robots spread out.
#include <cmath>

#include "common/base/deterministic_math.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/parameters.h"
#include "robot-agent/controller/rays.h"

namespace troupe {
namespace {

constexpr double kEscapeTime = 0.5;  // s that it tries one way out after a stall

struct ExpandParameters {
  double speed = 0.4;           // m/s, when the front is clear
  double turn_gain = 1.0;       // 1/s: turn rate for each radian between the heading and the room
  double clear_distance = 0.6;  // m: the front is clear when nothing there is nearer
  double clear_angle = 0.5;     // rad: the front is what lies within this of the heading
};

std::string Parse(const std::string& text, ExpandParameters& p) {
  Parameters reader("expand", text);
  reader.ReadNumber("speed", {0.0, 100.0}, p.speed);
  reader.ReadNumber("turn_gain", {0.0, 100.0}, p.turn_gain);
  reader.ReadNumber("clear_distance", {0.0, 1000.0}, p.clear_distance);
  reader.ReadNumber("clear_angle", {0.0, kPi}, p.clear_angle);
  return reader.Finish();
}

class ExpandController final : public Controller {
 public:
  ExpandController(const RobotInfo& info, const ExpandParameters& parameters, std::size_t ranger)
      : parameters_(parameters), drive_(info.robot->drive), ranger_(ranger) {
    for (const Ray& ray : RaysOf(info, ranger)) {
      const SinCosResult direction = SinCos(ray.bearing);
      rays_.push_back({ray, {direction.cos, direction.sin}});
    }
  }

  std::vector<std::size_t> Subscriptions() const override { return {ranger_}; }

  Command Update(const Observation& observation) override {
    const RangerReading& reading = observation.rangers[ranger_];
    if (reading.scans.empty()) return {};
    Vec2 room = Vec2::Zero();
    bool clear = true;
    for (const auto& [ray, direction] : rays_) {
      const double range = RangeOf(reading, ray);
      room += range * direction;
      if (std::abs(ray.bearing) < parameters_.clear_angle && range < parameters_.clear_distance) clear = false;
    }
    const double bearing = Atan2(room.y(), room.x());
    if (observation.stalled) {
      escape_ = PickEscape(observation);
      escape_until_ = observation.time + kEscapeTime;
    }
    if (observation.time < escape_until_) return Drive(escape_.speed, escape_.turn_rate);
    return Drive(clear ? parameters_.speed : 0.0, parameters_.turn_gain * bearing);
  }

 private:
  struct Escape {
    double speed = 0.0;      // m/s
    double turn_rate = 0.0;  // rad/s
  };

  // In a crowd any single way out may be blocked, for ever by a robot that tries the same, so it tries them by chance.
  Escape PickEscape(const Observation& observation) const {
    const double side = observation.Random(1) < 0.5 ? 1.0 : -1.0;
    const double chance = observation.Random(0);
    if (chance < 0.5) return {-0.5 * parameters_.speed, 0.0};
    if (chance < 0.75) return {0.5 * parameters_.speed, 0.0};
    return {0.0, side * parameters_.turn_gain};
  }

  struct DirectedRay {
    Ray ray;
    Vec2 direction;
  };

  Command Drive(double speed, double turn_rate) const {
    Command command;
    if (drive_.type == DriveType::kCar) {
      // A car turns only while it moves: without a clear front it turns backwards.
      command.speed = speed != 0.0 ? speed : -0.5 * parameters_.speed;
      command.steering = Atan2(turn_rate * drive_.wheelbase, std::abs(command.speed));
      if (command.speed < 0.0) command.steering = -command.steering;
    } else {
      command.twist = {speed, 0.0, turn_rate};
    }
    return command;
  }

  ExpandParameters parameters_;
  DriveDescription drive_;
  std::size_t ranger_;
  std::vector<DirectedRay> rays_;
  Escape escape_;
  double escape_until_ = 0.0;  // s, simulated
};

std::string CheckExpand(const std::string& parameters) {
  ExpandParameters ignored;
  return Parse(parameters, ignored);
}

Result<std::unique_ptr<Controller>> CreateExpand(const RobotInfo& info) {
  ExpandParameters parameters;
  if (const std::string error = Parse(info.parameters, parameters); !error.empty()) return Error{{}, error};
  std::optional<std::size_t> ranger = FindSonar(*info.robot);
  if (!ranger) ranger = FindScanner(*info.robot);
  if (!ranger)
    return Error{{}, "expand: the robot has no ranger with several rays, expected a sonar ring or a scanner"};
  return std::unique_ptr<Controller>(std::make_unique<ExpandController>(info, parameters, *ranger));
}

}  // namespace

BuiltInController Expand() {
  return {"expand", CheckExpand, CreateExpand};
}

}  // namespace troupe
