// pioneer_flocking: moves with the robots that its fiducial finder sees.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/base/deterministic_math.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/clear_steering.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

constexpr double kTargetDistance = 2.0;  // m, of the point that it steers to
constexpr double kSeparation = 2.0;      // weights, of the direction ahead 1
constexpr double kCohesion = 1.0;
constexpr double kAlignment = 1.0;

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
    Vec2 separation = Vec2::Zero();
    Vec2 center = Vec2::Zero();
    Vec2 course = Vec2::Zero();
    for (const Fiducial& neighbour : reading->fiducials) {
      const Vec2 p_R = sensor * neighbour.X_SF.translation();
      const double distance = std::max(std::sqrt(p_R.squaredNorm()), 1e-3);
      separation -= std::max(1.0 - distance / parameters_.distance, 0.0) * p_R / distance;
      center += p_R;
      const SinCosResult heading = SinCos(reading->X_RS.heading + neighbour.X_SF.heading);
      course += Vec2(heading.cos, heading.sin);
    }
    const double count = static_cast<double>(reading->fiducials.size());
    const Vec2 mean = center / count;
    const double apart = std::sqrt(mean.squaredNorm());
    // Neighbours at their distance neither attract nor repel.
    const double pull = std::min(std::max(apart - parameters_.distance, 0.0) / parameters_.distance, 1.0);
    Vec2 wanted = Vec2(1.0, 0.0) + kSeparation * separation + kAlignment * course / count;
    if (apart > 1e-3) wanted += kCohesion * pull * mean / apart;
    const double length = std::sqrt(wanted.squaredNorm());
    if (length < 1e-6) return {};
    // Who is pushed back slows down, and who has to catch up drives at full speed.
    const double urge = std::clamp(0.5 + 0.5 * wanted.x() / 2.0, 0.2, 1.0);
    return steering_.Towards(observation, kTargetDistance * wanted / length, urge * parameters_.motion.steer.speed);
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
