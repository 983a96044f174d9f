// flock: moves with the robots that it hears by radio.
//
// Both controllers here follow the rule of Reynolds (1987): keep away from near neighbours, move with the others, stay
// together (FlockDirection in steering.h). They differ in how a robot knows its neighbours: by radio messages with
// their poses, or by a fiducial finder. Neither has a leader, and no robot knows how many there are.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <vector>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/steering.h"
#include "troupe/deterministic_math.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

static_assert(std::endian::native == std::endian::little);  // of the numbers in messages

struct FlockParameters {
  ClearSteering::Settings motion;
  double distance = 1.5;  // m, between neighbours
  double radius = 5.0;    // m: robots farther away are no neighbours
  double memory = 1.0;    // s, without a message, until a neighbour is forgotten
};

Result<FlockParameters> ParseFlock(const std::string& text) {
  FlockParameters p;
  Parameters reader("flock", text);
  p.distance = reader.ReadNumber("distance", {0.05, 1000.0}).value_or(p.distance);
  p.radius = reader.ReadNumber("radius", {0.05, 100000.0}).value_or(p.radius);
  p.memory = reader.ReadNumber("memory", {0.0, 3600.0}).value_or(p.memory);
  p.motion.steer.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.motion.steer.speed);
  p.motion.steer.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.motion.steer.turn_rate);
  p.motion.clearance = reader.ReadNumber("clearance", {0.0, 100.0}).value_or(p.motion.clearance);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

// The content of a message: the sender's pose estimate, x, y and heading.
using Words = std::array<double, 3>;

std::vector<std::uint8_t> Encode(const Pose& pose) {
  const Words words = {pose.x, pose.y, pose.heading};
  std::vector<std::uint8_t> bytes(sizeof(Words));
  std::memcpy(bytes.data(), words.data(), sizeof(Words));
  return bytes;
}

// Nothing for a message that is none of a flock.
std::optional<Pose> Decode(const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() != sizeof(Words)) return std::nullopt;
  Words words{};
  std::memcpy(words.data(), bytes.data(), sizeof(Words));
  for (const double word : words) {
    if (!(std::abs(word) <= 1e6)) return std::nullopt;
  }
  return Pose{words[0], words[1], 0.0, WrapAngle(words[2])};
}

class FlockController final : public Controller {
 public:
  FlockController(const RobotInfo& info, const FlockParameters& parameters, std::size_t radio,
                  std::optional<std::size_t> ranger)
      : parameters_(parameters), radio_(radio), ranger_(ranger), steering_(info, ranger, parameters.motion) {}

  std::vector<std::size_t> Subscriptions() const override {
    return ranger_ ? std::vector<std::size_t>{radio_, *ranger_} : std::vector<std::size_t>{radio_};
  }

  Command Update(const Observation& observation) override {
    Listen(observation);
    Command command = Move(observation);
    command.messages.push_back({.radio = radio_, .to = {}, .bytes = Encode(observation.pose_estimate)});
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<FlockController>(*this); }

 private:
  struct Heard {
    Pose X_EN;          // of the neighbour, in the frame of the estimate
    double time = 0.0;  // s, simulated
  };

  void Listen(const Observation& observation) {
    const SensorReading& reading = observation.sensors[radio_];
    const auto* const radio = reading.As<RadioReading>();
    if (radio != nullptr && reading.tick == observation.tick) {
      const Transform2 antenna(observation.pose_estimate * radio->X_RS);
      for (const RadioReception& reception : radio->receptions) {
        std::optional<Pose> pose = Decode(reception.bytes);
        if (!pose) continue;
        if (reception.place) {  // measured, so that drifts of odometry do not matter
          const SinCosResult direction = SinCos(reception.place->bearing);
          const double range = reception.place->range * SinCos(reception.place->elevation).cos;
          const Vec2 point = antenna * Vec2(range * direction.cos, range * direction.sin);
          pose->x = point.x();
          pose->y = point.y();
        }
        // An ordered map: the sum over neighbours has a fixed order, and with it the same bits.
        heard_[reception.from] = {*pose, observation.time};
      }
    }
    std::erase_if(heard_, [&](const auto& entry) { return observation.time - entry.second.time > parameters_.memory; });
  }

  Command Move(const Observation& observation) {
    const Transform2 robot(observation.pose_estimate);
    std::vector<Neighbour> neighbours;
    for (const auto& [id, heard] : heard_) {
      const Vec2 p_R = robot.InverseTransform(heard.X_EN.translation());
      if (p_R.squaredNorm() > parameters_.radius * parameters_.radius) continue;
      neighbours.push_back({p_R, WrapAngle(heard.X_EN.heading - observation.pose_estimate.heading)});
    }
    if (neighbours.empty()) return steering_.Roam(observation);
    const Vec2 wanted = FlockDirection(neighbours, parameters_.distance);
    const double length = std::sqrt(wanted.squaredNorm());
    if (length == 0.0) return {};
    return steering_.Towards(observation, 2.0 * wanted / length, FlockSpeed(wanted) * parameters_.motion.steer.speed);
  }

  FlockParameters parameters_;
  std::size_t radio_;
  std::optional<std::size_t> ranger_;
  ClearSteering steering_;
  std::map<RobotId, Heard> heard_;
};

Status CheckFlock(const std::string& parameters) {
  const Result<FlockParameters> parsed = ParseFlock(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateFlock(const RobotInfo& info) {
  const Result<FlockParameters> parameters = ParseFlock(info.parameters);
  if (!parameters.ok()) return parameters.error();
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (!std::holds_alternative<RadioParameters>(info.sensors[i].description->parameters)) continue;
    return std::unique_ptr<Controller>(
        std::make_unique<FlockController>(info, parameters.value(), i, FindBestRanger(info)));
  }
  return Error{{}, "flock: the robot has no radio, expected one"};
}

// pioneer_flocking: moves with the robots that its fiducial finder sees.

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

BuiltInController Flock() {
  return {"flock", CheckFlock, CreateFlock};
}

BuiltInController Flocking() {
  return {"pioneer_flocking", CheckFlocking, CreateFlocking};
}

}  // namespace troupe
