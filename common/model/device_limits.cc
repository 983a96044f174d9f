#include "common/model/device_limits.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

#include "troupe/deterministic_math.h"
#include "troupe/radio_limits.h"

namespace troupe {
namespace {

double ClampComponent(const Interval& velocity, const Interval& acceleration, double current, double desired,
                      double seconds) {
  const Interval reachable{current + acceleration.min * seconds, current + acceleration.max * seconds};
  // The acceleration wins over the velocity bound: nothing stops at once.
  return reachable.Clamp(velocity.Clamp(desired));
}

struct CarMotion {
  double speed = 0.0;     // m/s, of the steered wheel
  double steering = 0.0;  // rad, at most a quarter turn to either side
};

// The inverse of CarTwist.
CarMotion ToCarMotion(const Twist& twist, double wheelbase) {
  const double sideways = twist.wz * wheelbase;
  const double speed = std::sqrt(twist.vx * twist.vx + sideways * sideways);
  // Backwards the wheel turns backwards; a steering angle beyond a quarter turn would say the same.
  if (twist.vx < 0.0) return {-speed, Atan2(-sideways, -twist.vx)};
  return {speed, Atan2(sideways, twist.vx)};
}

bool IsNear(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max({1.0, std::abs(a), std::abs(b)});
}

// A bandwidth of 80 bytes/s gives 8 bytes in 0.1 s, although 80 * 0.1 may be rounded to less.
constexpr double kRounding = 1e-9;

// Counts the bytes of each radio of a robot during a tick.
class ByteBudget {
 public:
  ByteBudget(const RobotDescription& robot, double interval_seconds)
      : robot_(robot), interval_seconds_(interval_seconds), used_(robot.sensors.size(), 0) {}

  // False if the message does not fit. REQUIRES: it names a radio.
  bool Use(const RadioMessage& message) {
    const RadioParameters& radio = *FindRadio(robot_, message.radio);
    // A later message may still fit after a long one was left out: order and size decide, nothing is cut.
    if (count_ == kMaxRadioMessages) return false;
    if (used_[message.radio] + message.bytes.size() > BytesPerTick(radio, interval_seconds_)) return false;
    used_[message.radio] += message.bytes.size();
    ++count_;
    return true;
  }

 private:
  const RobotDescription& robot_;
  double interval_seconds_;
  std::vector<std::size_t> used_;  // by sensor
  std::size_t count_ = 0;
};

}  // namespace

Twist ClampToLimits(const DriveDescription& drive, const Twist& current, const Twist& desired, double seconds) {
  const TwistBounds& v = drive.velocity;
  const TwistBounds& a = drive.acceleration;
  if (drive.type == DriveType::kCar) {
    const CarMotion now = ToCarMotion(current, drive.wheelbase);
    const CarMotion then = ToCarMotion(desired, drive.wheelbase);
    // The twist of a car at rest has no steering angle, so the rate of steering has no bound.
    return CarTwist(ClampComponent(v.x, a.x, now.speed, then.speed, seconds), v.heading.Clamp(then.steering),
                    drive.wheelbase);
  }
  Twist result;
  result.vx = ClampComponent(v.x, a.x, current.vx, desired.vx, seconds);
  if (drive.type == DriveType::kOmni) result.vy = ClampComponent(v.y, a.y, current.vy, desired.vy, seconds);
  result.wz = ClampComponent(v.heading, a.heading, current.wz, desired.wz, seconds);
  return result;
}

bool WithinLimits(const DriveDescription& drive, const Twist& current, const Twist& proposed, double seconds) {
  const Twist clamped = ClampToLimits(drive, current, proposed, seconds);
  // The inverse of a car's twist rounds, so that bits cannot be compared.
  return IsNear(clamped.vx, proposed.vx) && IsNear(clamped.vy, proposed.vy) && IsNear(clamped.wz, proposed.wz);
}

Twist CarTwist(double speed, double steering, double wheelbase) {
  const SinCosResult trig = SinCos(steering);
  return {.vx = speed * trig.cos, .vy = 0.0, .wz = speed * trig.sin / wheelbase};
}

std::size_t BytesPerTick(const RadioParameters& radio, double interval_seconds) {
  const double bytes = std::floor(radio.bandwidth * interval_seconds * (1.0 + kRounding));
  return static_cast<std::size_t>(std::min(bytes, static_cast<double>(kMaxRadioBytes)));
}

Tick DelayTicks(const RadioParameters& radio, double interval_seconds) {
  return static_cast<Tick>(std::ceil(radio.delay / interval_seconds * (1.0 - kRounding)));
}

const RadioParameters* FindRadio(const RobotDescription& robot, std::size_t sensor) {
  return sensor < robot.sensors.size() ? std::get_if<RadioParameters>(&robot.sensors[sensor].parameters) : nullptr;
}

std::vector<RadioMessage> WithinLimits(const RobotDescription& robot, double interval_seconds,
                                       std::vector<RadioMessage> messages) {
  if (messages.empty()) return messages;
  ByteBudget budget(robot, interval_seconds);
  std::erase_if(messages, [&](const RadioMessage& message) { return !budget.Use(message); });
  return messages;
}

Status CheckMessages(const RobotDescription& robot, double interval_seconds, std::span<const RadioMessage> messages) {
  if (messages.empty()) return {};
  if (messages.size() > kMaxRadioMessages) {
    return Error{{},
                 "found " + std::to_string(messages.size()) + " radio messages, expected at most " +
                     std::to_string(kMaxRadioMessages) + " in a tick"};
  }
  ByteBudget budget(robot, interval_seconds);
  for (const RadioMessage& message : messages) {
    const RadioParameters* const radio = FindRadio(robot, message.radio);
    if (radio == nullptr) {
      return Error{{},
                   "found a message of sensor " + std::to_string(message.radio) + ", expected a radio of the robot"};
    }
    if (budget.Use(message)) continue;
    return Error{{},
                 "found a radio message of " + std::to_string(message.bytes.size()) +
                     " bytes beyond the bandwidth of '" + robot.sensors[message.radio].name + "', expected at most " +
                     std::to_string(BytesPerTick(*radio, interval_seconds)) + " bytes in a tick"};
  }
  return {};
}

}  // namespace troupe
