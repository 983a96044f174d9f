// expand: turns to the side with the most free space and drives there, so that many robots spread out.
#include <algorithm>
#include <cmath>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/rays.h"
#include "robot-agent/navigation/steering.h"
#include "troupe/deterministic_math.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

constexpr double kEscapeTime = 0.5;       // s, of one attempt to escape after a stall
constexpr double kEscapePatience = 10.0;  // s at rest, before a recovery
constexpr double kStopWay = 0.15;         // m, to where the circle that it keeps clear would meet an obstacle

struct ExpandParameters {
  double speed = 0.4;           // m/s, when the front is clear
  double turn_gain = 1.0;       // 1/s: turn rate for each radian between the heading and the free space
  double clear_distance = 0.6;  // m: the front is clear without a nearer hit
  double clear_angle = 0.5;     // rad: bearings within this are the front
  double clearance = 0.0;       // m: it keeps a circle of this radius about its origin clear; 0: none
};

Result<ExpandParameters> ParseExpand(const std::string& text) {
  ExpandParameters p;
  Parameters reader("expand", text);
  p.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.speed);
  p.turn_gain = reader.ReadNumber("turn_gain", {0.0, 100.0}).value_or(p.turn_gain);
  p.clear_distance = reader.ReadNumber("clear_distance", {0.0, 1000.0}).value_or(p.clear_distance);
  p.clear_angle = reader.ReadNumber("clear_angle", {0.0, kPi}).value_or(p.clear_angle);
  p.clearance = reader.ReadNumber("clearance", {0.0, 100.0}).value_or(p.clearance);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class ExpandController final : public Controller {
 public:
  ExpandController(const RobotInfo& info, const ExpandParameters& parameters, std::size_t ranger)
      : parameters_(parameters),
        drive_(info.robot->drive),
        recovery_(drive_, {parameters.speed, parameters.turn_gain}),
        ranger_(ranger),
        rays_(PlacedRaysOf(info, ranger)) {
    // Between the rays of a sonar ring there is room for legs of tables: a scanner sees them.
    if (parameters.clearance <= 0.0) return;
    scanner_ = FindScanner(info).value_or(ranger);
    scan_ = PlacedRaysOf(info, *scanner_);
  }

  std::vector<std::size_t> Subscriptions() const override {
    if (scanner_ && *scanner_ != ranger_) return {std::min(ranger_, *scanner_), std::max(ranger_, *scanner_)};
    return {ranger_};
  }

  Command Update(const Observation& observation) override {
    const SensorReading& reading = observation.sensors[ranger_];
    if (reading.empty()) return {};
    // It rests in front of a narrow obstacle with the free space behind it, and where all its attempts are blocked.
    if (const std::optional<Command> recovery = recovery_.Update(observation, kEscapePatience, Recovery::kNever))
      return *recovery;
    // The sum of all rays as vectors: it points to the side with the most room.
    Vec2 free_space = Vec2::Zero();
    bool clear = true;
    for (const auto& [ray, origin, direction] : *rays_) {
      const double range = RangeOf(reading, ray);
      free_space += range * direction;
      if (std::abs(ray.bearing) < parameters_.clear_angle && range < parameters_.clear_distance) clear = false;
    }
    const Room room = LookAround(observation);
    clear = clear && room.ahead;
    const double bearing = Atan2(free_space.y(), free_space.x());
    if (observation.stalled) {
      escape_ = PickEscape(observation);
      escape_until_ = observation.time + kEscapeTime;
    }
    if (observation.time < escape_until_) {
      const bool is_free = escape_.speed > 0.0 ? room.ahead : room.behind;
      return Drive(is_free ? escape_.speed : 0.0, escape_.turn_rate);
    }
    return Drive(clear ? parameters_.speed : 0.0, parameters_.turn_gain * bearing);
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<ExpandController>(*this); }

 private:
  struct Escape {
    double speed = 0.0;      // m/s
    double turn_rate = 0.0;  // rad/s
  };

  // Whether the circle about the body can move on before it meets an obstacle; it can where no ray looks.
  struct Room {
    bool ahead = true;
    bool behind = true;
  };

  Room LookAround(const Observation& observation) const {
    Room room;
    if (!scanner_ || observation.sensors[*scanner_].empty()) return room;
    const double radius = parameters_.clearance;
    for (const PlacedRay& placed : **scan_) {
      const double range = RangeOf(observation.sensors[*scanner_], placed.ray);
      if (range >= placed.ray.max_range) continue;
      const Vec2 p_R = placed.p_RO + range * placed.direction;
      if (std::abs(p_R.y()) >= radius) continue;
      const double way = std::abs(p_R.x()) - std::sqrt(radius * radius - p_R.y() * p_R.y());
      if (way < kStopWay) (p_R.x() > 0.0 ? room.ahead : room.behind) = false;
    }
    return room;
  }

  // In a crowd a robot with the same rule may block any single way out for ever, so the choice is random.
  Escape PickEscape(const Observation& observation) const {
    const double side = observation.Random(1) < 0.5 ? 1.0 : -1.0;
    const double chance = observation.Random(0);
    if (chance < 0.5) return {-0.5 * parameters_.speed, 0.0};
    if (chance < 0.75) return {0.5 * parameters_.speed, 0.0};
    return {0.0, side * parameters_.turn_gain};
  }

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
  Recovery recovery_;
  std::size_t ranger_;
  Shared<std::vector<PlacedRay>> rays_;
  std::optional<std::size_t> scanner_;                  // with a circle to keep clear
  std::optional<Shared<std::vector<PlacedRay>>> scan_;  // its rays
  Escape escape_;
  double escape_until_ = 0.0;  // s, simulated
};

Status CheckExpand(const std::string& parameters) {
  const Result<ExpandParameters> parsed = ParseExpand(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateExpand(const RobotInfo& info) {
  const Result<ExpandParameters> parameters = ParseExpand(info.parameters);
  if (!parameters.ok()) return parameters.error();
  std::optional<std::size_t> ranger = FindSonar(info);
  if (!ranger) ranger = FindScanner(info);
  if (!ranger) {
    return Error{{}, "expand: the robot has no ranger with several rays, expected a sonar ring or a scanner"};
  }
  return std::unique_ptr<Controller>(std::make_unique<ExpandController>(info, parameters.value(), *ranger));
}

}  // namespace

BuiltInController Expand() {
  return {"expand", CheckExpand, CreateExpand};
}

}  // namespace troupe
