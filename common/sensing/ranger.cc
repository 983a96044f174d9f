// The ranger. Two ways of measuring: flat ray sensors (one horizontal plane) collect all their rays and cast them
// together, which shares the walk through the indices; ray sensors with several planes cut the world along each bearing
// once and read all planes from the cut (column_cast.h).
//
// The measurement of a flat ranger runs for every robot at every tick, and is a large part of their cost. Hence the
// precomputed FlatSensor list, shared by all robots of one model (Intern), the geometry of the scans that is shared
// with the readings, the lists that keep their memory, sines and cosines of many angles at once (SinCosOf) and the
// prefetches.
//
// Noise is drawn by keys (seed, robot, sensor, ray sensor, tick, ray); a sensor without noise draws nothing.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/base/intern.h"
#include "common/base/prefetch.h"
#include "common/base/sin_cos_of.h"
#include "common/sensing/sensor.h"
#include "common/sensing/sensor_kinds.h"
#include "common/spatial/column_cast.h"
#include "common/spatial/ray_cast.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

constexpr double kGroundIntensity = 1.0;  // the default of models

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

// The values of a flat ray sensor for the measurement of a tick.
struct FlatSensor {
  Vec2 p_MS;
  double heading_MS;
  double z_MS;
  Interval range;
  RayFan fan;
  double angle_noise;  // rad
  std::size_t index;   // among the ray sensors
  std::size_t first;   // in RangerReading::ranges
  bool has_exact_ranges;

  bool operator==(const FlatSensor&) const = default;
};
using FlatSensors = std::vector<FlatSensor>;

FlatSensors FlatSensorsOf(std::span<const RaySensorDescription> ray_sensors) {
  FlatSensors flat;
  std::size_t first = 0;
  for (std::size_t s = 0; s < ray_sensors.size(); ++s) {
    const RaySensorDescription& sensor = ray_sensors[s];
    first += sensor.samples * sensor.planes();
    if (!sensor.elevations.empty()) continue;
    // `first` counts the rays of all ray sensors before this one: it is an offset into the whole reading.
    flat.push_back({.p_MS = sensor.X_MS.translation(),
                    .heading_MS = sensor.X_MS.heading,
                    .z_MS = sensor.X_MS.z,
                    .range = sensor.range,
                    .fan = FanOf(sensor),
                    .angle_noise = AngleNoise(sensor),
                    .index = s,
                    .first = first - sensor.samples,
                    .has_exact_ranges = sensor.noise_proportional == 0.0 && !(sensor.noise_variance > 0.0)});
  }
  return flat;
}

// Of scans of a ranger at X_RM.
std::vector<ScanGeometry> GeometryOf(std::span<const RaySensorDescription> ray_sensors, const Pose& X_RM) {
  std::vector<ScanGeometry> scans;
  for (const RaySensorDescription& sensor : ray_sensors) {
    scans.push_back({.fan = FanOf(sensor),
                     .elevations = sensor.elevations,
                     .X_RS = X_RM * sensor.X_MS,
                     .limits = sensor.range,
                     .variance = sensor.noise_variance});
  }
  return scans;
}

class Ranger final : public Sensor {
 public:
  explicit Ranger(const SensorMount& mount) : Sensor(mount), flat_(Intern(FlatSensorsOf(ray_sensors()))) {
    has_planes_ = flat_->size() < ray_sensors().size();
    const ModelId model = description().model;
    // On link 0, the robot's base, no joint moves the ranger: the geometry is one shared constant.
    if (mount.scene.link_of(model) == 0) geometry_ = Intern(GeometryOf(ray_sensors(), mount.scene.X_LM(model)));
  }

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    const auto& ranger = std::get<RangerReading>(reading.content);
    std::string lines;
    for (std::size_t i = 0; i < ranger.geometry->size(); ++i) {
      const std::span ranges = std::span(ranger.ranges).subspan(ranger.first_ray(i), (*ranger.geometry)[i].rays());
      JsonWriter json(lines);
      BeginReading(json, reading.tick, world.robot(robot()).name, description().name + "." + std::to_string(i));
      json.Member("ranges", ranges).EndObject();
      lines += '\n';
    }
    return lines;
  }

 private:
  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    // Kept from tick to tick, so that a measurement allocates nothing.
    thread_local std::vector<Ray> rays;
    thread_local std::vector<std::optional<RayHit>> hits;
    reading.tick = tick;
    const bool is_new = reading.empty();
    RangerReading& ranger = ContentOf<RangerReading>(reading);
    // A kept reading of a fixed ranger already has its geometry.
    if (is_new || !geometry_) Describe(world, ranger);
    Prefetch(ranger.ranges.data(), ranger.ranges.size() * sizeof(double));  // while the rays are cast
    Prefetch(ranger.intensities.data(), ranger.intensities.size() * sizeof(double));
    MakeRays(world, tick, rays);
    CastRays(world.scene, world.bodies, rays, robot(), hits);
    std::optional<RayHit>* hit = hits.data();
    for (const FlatSensor& sensor : *flat_) {
      if (!sensor.has_exact_ranges) {
        AddNoise(ray_sensors()[sensor.index], NoiseOf(world, sensor.index, tick), std::span(hit, sensor.fan.count));
      }
      double* range = ranger.ranges.data() + sensor.first;
      double* intensity = ranger.intensities.data() + sensor.first;
      for (std::size_t i = 0; i < sensor.fan.count; ++i, ++hit, ++range, ++intensity) {
        // Clamped after the noise: a reading is never outside the limits of the device.
        *range = *hit ? sensor.range.Clamp((*hit)->distance) : sensor.range.max;
        *intensity = *hit ? world.scene.ranger_return((*hit)->model) : 0.0;
      }
    }
    if (has_planes_) MeasurePlanes(world, tick, ranger);
  }

  // Writes all of the reading but what is measured. It never changes if no joint moves the ranger.
  void Describe(const SensedWorld& world, RangerReading& ranger) const {
    if (geometry_) {
      ranger.geometry = *geometry_;
    } else if (std::vector<ScanGeometry> moved = GeometryOf(ray_sensors(), MountAt(world)); *ranger.geometry != moved) {
      ranger.geometry = std::move(moved);
    }
    const std::size_t rays = ranger.first_ray(ranger.geometry->size());
    ranger.ranges.resize(rays);
    ranger.intensities.resize(rays);
  }

  // The scans of the ray sensors with several planes.
  void MeasurePlanes(const SensedWorld& world, Tick tick, RangerReading& ranger) const {
    for (std::size_t s = 0; s < ray_sensors().size(); ++s) {
      if (!ray_sensors()[s].elevations.empty()) MeasurePlanes(world, s, NoiseOf(world, s, tick), ranger);
    }
  }

  static void AddNoise(const RaySensorDescription& sensor, const Noise& noise, std::span<std::optional<RayHit>> hits) {
    for (std::size_t ray = 0; ray < hits.size(); ++ray) {
      if (hits[ray]) hits[ray]->distance = NoisyRange(sensor, noise, ray, hits[ray]->distance);
    }
  }

  // The ranges of a ray sensor with several planes: in each half plane of a bearing all at once.
  void MeasurePlanes(const SensedWorld& world, std::size_t s, const Noise& noise, RangerReading& ranger) const {
    const RaySensorDescription& sensor = ray_sensors()[s];
    const Pose X_WS = world.bodies.X_WM(description().model) * sensor.X_MS;
    const std::size_t planes = sensor.planes();
    const double amplitude = AngleNoise(sensor);
    const std::size_t first = ranger.first_ray(s);
    const std::span ranges = std::span(ranger.ranges).subspan(first, planes * sensor.samples);
    const std::span intensities = std::span(ranger.intensities).subspan(first, planes * sensor.samples);
    std::fill(ranges.begin(), ranges.end(), sensor.range.max);
    std::fill(intensities.begin(), intensities.end(), 0.0);
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
        ranges[place] = sensor.range.Clamp(NoisyRange(sensor, noise, place, distance));
        intensities[place] = hits_body ? world.scene.ranger_return(hit->model) : kGroundIntensity;
      }
    }
  }

  // The rays of the flat ray sensors, ray sensor by ray sensor.
  void MakeRays(const SensedWorld& world, Tick tick, std::vector<Ray>& rays) const {
    thread_local std::vector<double> angles;
    thread_local std::vector<SinCosResult> directions;
    rays.clear();
    angles.clear();
    const Pose X_WM = world.bodies.X_WM(description().model);
    const Transform2 to_world = world.bodies.TransformOf(
        description().model, X_WM);  // for all ray sensors: X_WM * X_MS of each without further sines
    for (const FlatSensor& sensor : *flat_) {
      const Vec2 origin = to_world * sensor.p_MS;
      const double heading = WrapAngle(X_WM.heading + sensor.heading_MS);
      const double z = X_WM.z + sensor.z_MS;
      const auto add_ray = [&](double bearing) {
        angles.push_back(heading + bearing);
        rays.push_back({origin, {1.0, 0.0}, z, sensor.range.max});
      };
      if (sensor.angle_noise == 0.0) {
        for (std::size_t i = 0; i < sensor.fan.count; ++i) add_ray(sensor.fan.Bearing(i));
        continue;
      }
      const Noise noise = NoiseOf(world, sensor.index, tick);
      for (std::size_t i = 0; i < sensor.fan.count; ++i) {
        add_ray(sensor.fan.Bearing(i) + sensor.angle_noise * noise.Uniform(i, Draw::kAngle));
      }
    }
    directions.resize(angles.size());
    SinCosOf(angles, directions);
    for (std::size_t i = 0; i < rays.size(); ++i) rays[i].direction = {directions[i].cos, directions[i].sin};
  }

  Noise NoiseOf(const SensedWorld& world, std::size_t sensor, Tick tick) const {
    return {ray_sensors()[sensor], {world.scene.world().seed, robot().index(), index(), sensor, tick}};
  }

  const std::vector<RaySensorDescription>& ray_sensors() const {
    return std::get<RangerParameters>(description().parameters).ray_sensors;
  }

  Shared<FlatSensors> flat_;                                   // the ray sensors with one plane
  bool has_planes_ = false;                                    // of a ray sensor with several planes
  std::optional<Shared<std::vector<ScanGeometry>>> geometry_;  // none: joints move the ranger
};

}  // namespace

std::unique_ptr<const Sensor> MakeRanger(const SensorMount& mount) {
  return std::make_unique<Ranger>(mount);
}

}  // namespace troupe
