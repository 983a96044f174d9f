#include "robot-agent/sensors/ranger.h"

#include <cmath>
#include <optional>
#include <span>

#include "common/base/deterministic_math.h"
#include "common/base/random.h"

namespace troupe {
namespace {

// Which of a ray's random numbers; the last word of its key.
enum class Draw : std::uint64_t { kAngle = 0, kProportional = 1, kConstant = 2 };

// The random numbers of one sensor at one tick, each a function of its key alone.
class Noise {
 public:
  Noise(const WorldDescription& world, RobotId robot, std::size_t ranger, std::size_t sensor, Tick tick) {
    const RaySensorDescription& description = world.robot(robot).rangers[ranger].sensors[sensor];
    if (description.noise_variance == 0.0 && description.noise_proportional == 0.0 && description.noise_angle == 0.0) {
      return;  // nothing will be drawn, as in most worlds
    }
    key_ = RandomBits({world.seed, robot.index(), ranger, sensor, tick});
  }

  // Uniform in [-1, 1).
  double Uniform(std::size_t ray, Draw draw) const {
    return 2.0 * RandomUniform({key_, ray, static_cast<std::uint64_t>(draw)}) - 1.0;
  }
  double Normal(std::size_t ray, Draw draw) const {
    return RandomNormal({key_, ray, static_cast<std::uint64_t>(draw)});
  }

 private:
  std::uint64_t key_ = 0;
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
  const auto noise_of = [&](std::size_t sensor) { return Noise(world, robot, ranger, sensor, tick); };
  std::size_t count = 0;
  for (const RaySensorDescription& sensor : description.sensors) count += sensor.samples;
  std::vector<Ray> rays;  // of all sensors, one after another
  rays.reserve(count);
  std::vector<double> bearings;
  for (std::size_t s = 0; s < description.sensors.size(); ++s) {
    const RaySensorDescription& sensor = description.sensors[s];
    FillBearings(sensor, bearings);
    TurnRays(sensor, noise_of(s), bearings);
    for (const double bearing : bearings) {
      const SinCosResult direction = SinCos(poses[s].heading + bearing);
      rays.push_back({.origin = poses[s].translation(),
                      .direction = {direction.cos, direction.sin},
                      .z = poses[s].z,
                      .max_distance = sensor.range.max});
    }
  }
  std::vector<std::optional<RayHit>> hits;
  CastRays(scene, bodies, rays, robot, hits);

  reading.tick = tick;
  reading.scans.resize(description.sensors.size());
  auto hit = hits.begin();
  for (std::size_t s = 0; s < description.sensors.size(); ++s) {
    const RaySensorDescription& sensor = description.sensors[s];
    const Noise noise = noise_of(s);
    RangeScan& scan = reading.scans[s];
    scan.ranges.resize(sensor.samples);
    scan.intensities.resize(sensor.samples);
    for (std::size_t ray = 0; ray < sensor.samples; ++ray, ++hit) {
      scan.ranges[ray] = *hit ? sensor.range.Clamp(NoisyRange(sensor, noise, ray, (*hit)->distance)) : sensor.range.max;
      scan.intensities[ray] = *hit ? scene.ranger_return((*hit)->model) : 0.0;
    }
  }
}

}  // namespace troupe
