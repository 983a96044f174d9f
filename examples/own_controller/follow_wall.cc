// follow_wall: keeps a wall at its left. A complete controller of one's own, in one file.
//
// Parameters: {"speed": m/s, "distance": m from the robot's ranger to the wall}
#include <troupe/controller.h>

#include <algorithm>
#include <stdexcept>

namespace {

class FollowWall final : public troupe::Controller {
 public:
  explicit FollowWall(const troupe::RobotInfo& info) {
    troupe::Parameters parameters("follow_wall", info.parameters);
    speed_ = parameters.ReadNumber("speed", {0.01, 10.0}).value_or(speed_);
    distance_ = parameters.ReadNumber("distance", {0.1, 5.0}).value_or(distance_);
    if (const troupe::Status status = parameters.Finish(); !status.ok()) {
      throw std::invalid_argument(status.error().message);  // the error of the run
    }
    while (ranger_ < info.sensors.size() && !IsRanger(*info.sensors[ranger_].description)) ++ranger_;
    if (ranger_ == info.sensors.size()) throw std::invalid_argument("the robot has no ranger");
  }

  std::vector<std::size_t> Subscriptions() const override { return {ranger_}; }

  troupe::Command Update(const troupe::Observation& observation) override {
    troupe::Command command;
    const troupe::RangerReading* reading = observation.sensors[ranger_].ranger();
    if (reading == nullptr) return command;  // not measured yet
    if (Nearest(*reading, -0.4, 0.4) < distance_) {
      command.twist.wz = -0.8;  // a corner: turn to the right
    } else {
      command.twist.vx = speed_;
      command.twist.wz = std::clamp(Nearest(*reading, 0.8, 1.8) - distance_, -0.5, 0.5);
    }
    return command;
  }

  std::unique_ptr<troupe::Controller> Clone() const override { return std::make_unique<FollowWall>(*this); }

 private:
  static bool IsRanger(const troupe::SensorDescription& sensor) {
    return std::holds_alternative<troupe::RangerParameters>(sensor.parameters);
  }

  // The shortest range (m) between two bearings (rad, from the robot's heading), at most 10 m.
  static double Nearest(const troupe::RangerReading& reading, double first, double last) {
    double nearest = 10.0;
    for (const troupe::RangeScan& scan : reading.scans()) {
      for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        const double bearing = troupe::WrapAngle(scan.X_RS.heading + scan.fan.Bearing(i));
        if (bearing > first && bearing < last) nearest = std::min(nearest, scan.ranges[i]);
      }
    }
    return nearest;
  }

  double speed_ = 0.3;      // m/s
  double distance_ = 0.8;   // m
  std::size_t ranger_ = 0;  // in RobotInfo::sensors: the first ranger
};

}  // namespace

TROUPE_CONTROLLER(FollowWall)
