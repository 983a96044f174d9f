// pioneer_flocking: moves with the robots that its fiducial finder sees.
#include <cmath>
#include <optional>
#include <vector>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/clear_steering.h"
#include "robot-agent/navigation/flock_rule.h"
#include "troupe/deterministic_math.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

constexpr double kTargetDistance = 2.0;  // m, of the point that it steers to

struct FlockingParameters {
  ClearSteering::Settings motion;
  double distance = 1.5;  // m, between neighbours
};

Result<FlockingParameters> ParseFlocking(const std::string& text) {
  FlockingParameters p;
  Parameters reader("pioneer_flocking", text);
  p.distance = reader.ReadNumber("distance", {0.05, 1000.0}).value_or(p.distance);
  p.motion.steer.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.motion.steer.speed);
  p.motion.steer.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.motion.steer.turn_rate);
  p.motion.clearance = reader.ReadNumber("clearance", {0.0, 100.0}).value_or(p.motion.clearance);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class FlockingController final : public Controller {
 public:
  FlockingController(const RobotInfo& info, const FlockingParameters& parameters, std::size_t finder,
                     std::optional<std::size_t> ranger)
      : parameters_(parameters), finder_(finder), ranger_(ranger), steering_(info, ranger, parameters.motion) {}

  std::vector<std::size_t> Subscriptions() const override {
    return ranger_ ? std::vector<std::size_t>{finder_, *ranger_} : std::vector<std::size_t>{finder_};
  }

  Command Update(const Observation& observation) override {
    const auto* const reading = observation.sensors[finder_].As<FiducialReading>();
    if (reading == nullptr || reading->fiducials.empty()) return steering_.Roam(observation);
    const Transform2 sensor(reading->X_RS);
    std::vector<Neighbour> neighbours;
    for (const Fiducial& seen : reading->fiducials) {
      neighbours.push_back({sensor * seen.X_SF.translation(), WrapAngle(reading->X_RS.heading + seen.X_SF.heading)});
    }
    const Vec2 wanted = FlockDirection(neighbours, parameters_.distance);
    const double length = std::sqrt(wanted.squaredNorm());
    if (length == 0.0) return {};
    return steering_.Towards(observation, kTargetDistance * wanted / length,
                             FlockSpeed(wanted) * parameters_.motion.steer.speed);
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<FlockingController>(*this); }

 private:
  FlockingParameters parameters_;
  std::size_t finder_;
  std::optional<std::size_t> ranger_;
  ClearSteering steering_;
};

Status CheckFlocking(const std::string& parameters) {
  const Result<FlockingParameters> parsed = ParseFlocking(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateFlocking(const RobotInfo& info) {
  const Result<FlockingParameters> parameters = ParseFlocking(info.parameters);
  if (!parameters.ok()) return parameters.error();
  const std::optional<std::size_t> finder = FindFinder(info);
  if (!finder) return Error{{}, "pioneer_flocking: the robot has no fiducial finder, expected one"};
  return std::unique_ptr<Controller>(
      std::make_unique<FlockingController>(info, parameters.value(), *finder, FindBestRanger(info)));
}

}  // namespace

BuiltInController Flocking() {
  return {"pioneer_flocking", CheckFlocking, CreateFlocking};
}

}  // namespace troupe
