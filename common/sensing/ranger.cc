#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/sensing/sensor.h"
#include "common/sensing/sensor_kinds.h"
#include "common/spatial/column_cast.h"
#include "common/spatial/ray_cast.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

constexpr double kGroundIntensity = 1.0;  // as that of most models

// The random numbers of a ray; the last word of their key.
enum class Draw : std::uint64_t { kAngle = 0, kProportional = 1, kConstant = 2 };

// The random numbers of one ray sensor at one tick, each a function of its key alone.
class Noise {
 public:
  Noise(const RaySensorDescription& description, std::initializer_list<std::uint64_t> key) {
    if (description.noise_variance == 0.0 && description.noise_proportional == 0.0 && description.noise_angle == 0.0) {
      return;  // nothing will be drawn, as in most worlds
    }
    key_ = RandomBits(key);
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

RayFan FanOf(const RaySensorDescription& sensor) {
  return {sensor.fov, sensor.samples};
}

// rad: the largest error of a bearing. The step of a single ray is its whole field of view.
double AngleNoise(const RaySensorDescription& sensor) {
  const double step = sensor.samples > 1 ? FanOf(sensor).angle_increment() : sensor.fov;
  return 0.5 * step * sensor.noise_angle;
}

double NoisyRange(const RaySensorDescription& sensor, const Noise& noise, std::size_t ray, double range) {
  double noisy = range;
  if (sensor.noise_proportional != 0.0) {
    noisy += range * sensor.noise_proportional * noise.Uniform(ray, Draw::kProportional);
  }
  if (sensor.noise_variance > 0.0) noisy += std::sqrt(sensor.noise_variance) * noise.Normal(ray, Draw::kConstant);
  return noisy;
}

class Ranger final : public Sensor {
 public:
  explicit Ranger(const SensorMount& mount) : Sensor(mount) {
    const ModelId model = description().model;
    is_fixed_ = mount.scene.link_of(model) == 0;
    for (const RaySensorDescription& sensor : ray_sensors()) {
      ray_count_ += sensor.samples * sensor.planes();
      if (is_fixed_) X_RS_.push_back(mount.scene.X_LM(model) * sensor.X_MS);
    }
  }

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    const std::vector<RangeScan>& scans = std::get<RangerReading>(reading.content).scans;
    std::string lines;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      lines += LineStart(reading.tick, world.robot(robot()).name, description().name + "." + std::to_string(i)) +
               ",\"ranges\":" + JsonNumbers(scans[i].ranges) + "}\n";
    }
    return lines;
  }

 private:
  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    const std::vector<std::optional<RayHit>> hits = Cast(world, tick);
    reading.tick = tick;
    RangerReading& ranger = ContentOf<RangerReading>(reading);
    ranger.scans.resize(ray_sensors().size());
    const Pose X_RM = is_fixed_ ? Pose{} : MountAt(world);
    auto hit = hits.begin();
    for (std::size_t s = 0; s < ray_sensors().size(); ++s) {
      const RaySensorDescription& sensor = ray_sensors()[s];
      const Noise noise = NoiseOf(world, s, tick);
      RangeScan& scan = ranger.scans[s];
      scan.fan = FanOf(sensor);
      scan.X_RS = is_fixed_ ? X_RS_[s] : X_RM * sensor.X_MS;
      scan.limits = sensor.range;
      scan.variance = sensor.noise_variance;
      scan.elevations = sensor.elevations;
      if (!sensor.elevations.empty()) {
        MeasurePlanes(world, s, noise, scan);
        continue;
      }
      scan.ranges.resize(sensor.samples);
      scan.intensities.resize(sensor.samples);
      for (std::size_t ray = 0; ray < sensor.samples; ++ray, ++hit) {
        scan.ranges[ray] =
            *hit ? sensor.range.Clamp(NoisyRange(sensor, noise, ray, (*hit)->distance)) : sensor.range.max;
        scan.intensities[ray] = *hit ? world.scene.ranger_return((*hit)->model) : 0.0;
      }
    }
  }

  // The ranges of a ray sensor with several planes: in each half plane of a bearing all at once.
  void MeasurePlanes(const SensedWorld& world, std::size_t s, const Noise& noise, RangeScan& scan) const {
    const RaySensorDescription& sensor = ray_sensors()[s];
    const Pose X_WS = world.bodies.X_WM(description().model) * sensor.X_MS;
    const std::size_t planes = sensor.planes();
    const double amplitude = AngleNoise(sensor);
    scan.ranges.assign(planes * sensor.samples, sensor.range.max);
    scan.intensities.assign(planes * sensor.samples, 0.0);
    std::vector<double> slopes;
    std::vector<double> cosines;
    for (const double elevation : sensor.elevations) {
      const SinCosResult at = SinCos(elevation);
      slopes.push_back(at.sin / at.cos);
      cosines.push_back(at.cos);
    }
    const ZRange seen{X_WS.z + std::min(0.0, sensor.range.max * slopes.front()),
                      X_WS.z + std::max(0.0, sensor.range.max * slopes.back())};
    ColumnCaster caster(world.scene, world.bodies, X_WS.translation(), sensor.range.max, robot(), Sight::kRangers);
    std::vector<ColumnCut> cuts;
    for (std::size_t i = 0; i < sensor.samples; ++i) {
      double bearing = FanOf(sensor).Bearing(i);
      if (amplitude != 0.0) bearing += amplitude * noise.Uniform(i, Draw::kAngle);
      const SinCosResult direction = SinCos(X_WS.heading + bearing);
      caster.Cut({direction.cos, direction.sin}, seen, cuts);
      for (std::size_t plane = 0; plane < planes; ++plane) {
        const ClimbingRay ray{X_WS.z, slopes[plane]};
        const std::optional<ColumnHit> hit = FirstHit(ray, cuts);
        // The ground, at z 0, ends rays from above it.
        const double ground = ray.slope < 0.0 && ray.z > 0.0 ? -ray.z / ray.slope : sensor.range.max;
        const bool hits_body = hit && hit->distance <= ground;
        const double distance = (hits_body ? hit->distance : ground) / cosines[plane];
        if (!hits_body && (ground >= sensor.range.max || distance > sensor.range.max)) continue;
        if (distance > sensor.range.max) continue;
        const std::size_t place = plane * sensor.samples + i;
        scan.ranges[place] = sensor.range.Clamp(NoisyRange(sensor, noise, place, distance));
        scan.intensities[place] = hits_body ? world.scene.ranger_return(hit->model) : kGroundIntensity;
      }
    }
  }

  // The hits of all rays of the flat ray sensors, ray sensor by ray sensor.
  std::vector<std::optional<RayHit>> Cast(const SensedWorld& world, Tick tick) const {
    const Pose X_WM = world.bodies.X_WM(description().model);
    const Transform2 to_world(X_WM);  // for all ray sensors: X_WM * X_MS of each without further sines
    std::vector<Ray> rays;
    rays.reserve(ray_count_);
    for (std::size_t s = 0; s < ray_sensors().size(); ++s) {
      const RaySensorDescription& sensor = ray_sensors()[s];
      if (!sensor.elevations.empty()) continue;
      const Vec2 origin = to_world * sensor.X_MS.translation();
      const double heading = WrapAngle(X_WM.heading + sensor.X_MS.heading);
      const RayFan fan = FanOf(sensor);
      const Noise noise = NoiseOf(world, s, tick);
      const double amplitude = AngleNoise(sensor);
      for (std::size_t i = 0; i < fan.count; ++i) {
        double bearing = fan.Bearing(i);
        if (amplitude != 0.0) bearing += amplitude * noise.Uniform(i, Draw::kAngle);
        const SinCosResult direction = SinCos(heading + bearing);
        rays.push_back({.origin = origin,
                        .direction = {direction.cos, direction.sin},
                        .z = X_WM.z + sensor.X_MS.z,
                        .max_distance = sensor.range.max});
      }
    }
    std::vector<std::optional<RayHit>> hits;
    CastRays(world.scene, world.bodies, rays, robot(), hits);
    return hits;
  }

  Noise NoiseOf(const SensedWorld& world, std::size_t sensor, Tick tick) const {
    return {ray_sensors()[sensor], {world.scene.world().seed, robot().index(), index(), sensor, tick}};
  }

  const std::vector<RaySensorDescription>& ray_sensors() const {
    return std::get<RangerParameters>(description().parameters).ray_sensors;
  }

  bool is_fixed_ = false;   // no joint moves it
  std::vector<Pose> X_RS_;  // by ray sensor; empty where a joint moves it
  std::size_t ray_count_ = 0;
};

}  // namespace

std::unique_ptr<const Sensor> MakeRanger(const SensorMount& mount) {
  return std::make_unique<Ranger>(mount);
}

}  // namespace troupe
