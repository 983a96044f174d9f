#include "robot-agent/sensors/ranger.h"

#include <cmath>
#include <optional>

#include "common/base/deterministic_math.h"
#include "common/base/random.h"

namespace troupe {
namespace {

// Which of a ray's random numbers; the last word of its key.
enum class Draw : std::uint64_t { kAngle = 0, kProportional = 1, kConstant = 2 };

// The random numbers of one sensor at one tick, each a function of its key alone.
class Noise {
 public:
  Noise(std::uint64_t seed, RobotId robot, std::size_t ranger, std::size_t sensor, Tick tick)
      : key_(RandomBits({seed, robot.index(), ranger, sensor, tick})) {}

  // Uniform in [-1, 1).
  double Uniform(std::size_t ray, Draw draw) const {
    return 2.0 * RandomUniform({key_, ray, static_cast<std::uint64_t>(draw)}) - 1.0;
  }
  double Normal(std::size_t ray, Draw draw) const {
    return RandomNormal({key_, ray, static_cast<std::uint64_t>(draw)});
  }

 private:
  std::uint64_t key_;
};

// The angle between neighbouring rays; of a single ray, the whole fan.
double Step(const RaySensorDescription& sensor) {
  return sensor.samples > 1 ? sensor.fov / (sensor.samples - 1) : sensor.fov;
}

void TurnRays(const RaySensorDescription& sensor, const Noise& noise, std::vector<double>& bearings) {
  const double amplitude = 0.5 * Step(sensor) * sensor.noise_angle;
  if (amplitude == 0.0) return;
  for (std::size_t ray = 0; ray < bearings.size(); ++ray) bearings[ray] += amplitude * noise.Uniform(ray, Draw::kAngle);
}

double NoisyRange(const RaySensorDescription& sensor, const Noise& noise, std::size_t ray, double range) {
  double noisy = range;
  if (sensor.noise_proportional != 0.0) {
    noisy += range * sensor.noise_proportional * noise.Uniform(ray, Draw::kProportional);
  }
  if (sensor.noise_variance > 0.0) noisy += std::sqrt(sensor.noise_variance) * noise.Normal(ray, Draw::kConstant);
  return noisy;
}

// A fan shares its work among its rays; for a few, as of a sonar, looking along each is less work.
constexpr std::size_t kFewRays = 4;

void Cast(const RayCaster& caster, const Pose& X_WS, const std::vector<double>& bearings, double max_range,
          std::vector<std::optional<RayHit>>& hits) {
  if (bearings.size() > kFewRays) {
    caster.CastFan(X_WS.translation(), X_WS.heading, bearings, X_WS.z, max_range, hits);
    return;
  }
  hits.clear();
  for (double bearing : bearings) {
    const SinCosResult direction = SinCos(X_WS.heading + bearing);
    hits.push_back(caster.CastRay(X_WS.translation(), {direction.cos, direction.sin}, X_WS.z, max_range));
  }
}

// Where the sensors of a ranger are: X_WM * X_MS of each, with the sine and cosine of X_WM's heading worked out once.
std::vector<Pose> SensorPoses(const RangerDescription& ranger, const Pose& X_WM) {
  const Transform2 transform(X_WM);
  std::vector<Pose> poses;
  poses.reserve(ranger.sensors.size());
  for (const RaySensorDescription& sensor : ranger.sensors) {
    const Vec2 p = transform * sensor.X_MS.translation();
    poses.push_back({p.x(), p.y(), X_WM.z + sensor.X_MS.z, WrapAngle(X_WM.heading + sensor.X_MS.heading)});
  }
  return poses;
}

// Where the rays of a ranger may go.
Rectangle ReachOf(const RangerDescription& ranger, const std::vector<Pose>& X_WS) {
  Rectangle reach = Rectangle::Nothing();
  for (std::size_t s = 0; s < X_WS.size(); ++s) {
    Rectangle box = Rectangle::Nothing();
    box.Extend(X_WS[s].translation());
    reach.Extend(box.Inflated(ranger.sensors[s].range.max));
  }
  return reach;
}

void FillBearings(const RaySensorDescription& sensor, std::vector<double>& bearings) {
  bearings.assign(sensor.samples, 0.0);
  if (sensor.samples < 2) return;
  const double last = sensor.samples - 1;
  // From the middle outwards, so that left and right are mirror images and both ends exact.
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    bearings[i] = sensor.fov * ((2.0 * static_cast<double>(i) - last) / (2.0 * last));
  }
}

}  // namespace

std::vector<double> Bearings(const RaySensorDescription& sensor) {
  std::vector<double> bearings;
  FillBearings(sensor, bearings);
  return bearings;
}

void MeasureRanger(const Scene& scene, const BodyIndex& bodies, RobotId robot, std::size_t ranger, Tick tick,
                   RangerReading& reading) {
  const WorldDescription& world = scene.world();
  const RangerDescription& description = world.robot(robot).rangers[ranger];
  const std::vector<Pose> poses = SensorPoses(description, bodies.X_WM(description.model));
  const RayCaster caster(scene, bodies, ReachOf(description, poses), robot);
  std::vector<std::optional<RayHit>> hits;
  std::vector<double> bearings;
  reading.tick = tick;
  reading.scans.resize(description.sensors.size());
  for (std::size_t s = 0; s < description.sensors.size(); ++s) {
    const RaySensorDescription& sensor = description.sensors[s];
    const Pose& X_WS = poses[s];
    const Noise noise(world.seed, robot, ranger, s, tick);
    FillBearings(sensor, bearings);
    TurnRays(sensor, noise, bearings);
    Cast(caster, X_WS, bearings, sensor.range.max, hits);
    RangeScan& scan = reading.scans[s];
    scan.ranges.assign(bearings.size(), sensor.range.max);
    scan.intensities.assign(bearings.size(), 0.0);
    for (std::size_t ray = 0; ray < bearings.size(); ++ray) {
      if (!hits[ray]) continue;
      scan.ranges[ray] = sensor.range.Clamp(NoisyRange(sensor, noise, ray, hits[ray]->distance));
      scan.intensities[ray] = world.model(hits[ray]->model).ranger_return;
    }
  }
}

}  // namespace troupe
