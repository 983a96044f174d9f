// follow_wall: keeps a wall at its left. A complete controller of one's own, in one file.
//
// Parameters: {"speed": m/s, "distance": m from the robot's ranger to the wall}
#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/deterministic_math.h"
#include "robot-agent/controller/controller.h"

namespace {

class FollowWall final : public troupe::Controller {
 public:
  explicit FollowWall(const troupe::RobotInfo& info) {
    const nlohmann::json parameters = nlohmann::json::parse(info.parameters);
    speed_ = parameters.value("speed", 0.3);
    distance_ = parameters.value("distance", 0.8);
    if (!(speed_ > 0.0) || !(distance_ > 0.0)) {
      throw std::invalid_argument("speed and distance have to be above 0");  // whoever started the robot reads this
    }
    if (info.robot->rangers.empty()) throw std::invalid_argument("the robot has no ranger");

    // Sort the rays of the first ranger, once, into those ahead and those to the left.
    const troupe::RangerDescription& ranger = info.robot->rangers[0];
    for (std::size_t s = 0; s < ranger.sensors.size(); ++s) {
      const troupe::RaySensorDescription& sensor = ranger.sensors[s];
      for (std::uint32_t i = 0; i < sensor.samples; ++i) {
        const double in_fan = sensor.samples > 1 ? sensor.fov * (i / (sensor.samples - 1.0) - 0.5) : 0.0;
        const double bearing = troupe::WrapAngle(info.X_RM[0].heading + sensor.X_MS.heading + in_fan);
        if (std::abs(bearing) < 0.4) ahead_.push_back({s, i});
        if (bearing > 0.8 && bearing < 1.8) left_.push_back({s, i});
      }
    }
  }

  std::vector<std::size_t> Subscriptions() const override { return {0}; }

  troupe::Command Update(const troupe::Observation& observation) override {
    const troupe::RangerReading& reading = observation.rangers[0];
    troupe::Command command;
    if (reading.scans.empty()) return command;  // nothing measured yet
    if (Nearest(reading, ahead_) < distance_) {
      command.twist.wz = -0.8;  // a corner: turn to the right
    } else {
      command.twist.vx = speed_;
      command.twist.wz = std::clamp(Nearest(reading, left_) - distance_, -0.5, 0.5);
    }
    return command;
  }

 private:
  struct Ray {
    std::size_t sensor;
    std::size_t sample;
  };

  static double Nearest(const troupe::RangerReading& reading, const std::vector<Ray>& rays) {
    double nearest = 10.0;
    for (const Ray& ray : rays) nearest = std::min(nearest, reading.scans[ray.sensor].ranges[ray.sample]);
    return nearest;
  }

  double speed_;
  double distance_;
  std::vector<Ray> ahead_;
  std::vector<Ray> left_;
};

}  // namespace

TROUPE_CONTROLLER(FollowWall)
