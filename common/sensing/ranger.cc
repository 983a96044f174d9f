#include "common/sensing/ranger.h"

#include <cmath>
#include <optional>

#include "common/base/deterministic_math.h"
#include "common/base/random.h"
#include "common/sensing/reading_json.h"
#include "common/spatial/ray_cast.h"

namespace troupe {
namespace {

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
      ray_count_ += sensor.samples;
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
    const Pose X_RM = is_fixed_ ? Pose{} : MovedMount(world);
    auto hit = hits.begin();
    for (std::size_t s = 0; s < ray_sensors().size(); ++s) {
      const RaySensorDescription& sensor = ray_sensors()[s];
      const Noise noise = NoiseOf(world, s, tick);
      RangeScan& scan = ranger.scans[s];
      scan.fan = FanOf(sensor);
      scan.X_RS = is_fixed_ ? X_RS_[s] : X_RM * sensor.X_MS;
      scan.limits = sensor.range;
      scan.variance = sensor.noise_variance;
      scan.ranges.resize(sensor.samples);
      scan.intensities.resize(sensor.samples);
      for (std::size_t ray = 0; ray < sensor.samples; ++ray, ++hit) {
        scan.ranges[ray] =
            *hit ? sensor.range.Clamp(NoisyRange(sensor, noise, ray, (*hit)->distance)) : sensor.range.max;
        scan.intensities[ray] = *hit ? world.scene.ranger_return((*hit)->model) : 0.0;
      }
    }
  }

  // The hits of all rays, ray sensor by ray sensor.
  std::vector<std::optional<RayHit>> Cast(const SensedWorld& world, Tick tick) const {
    const Pose X_WM = world.bodies.X_WM(description().model);
    const Transform2 to_world(X_WM);  // for all ray sensors: X_WM * X_MS of each without further sines
    std::vector<Ray> rays;
    rays.reserve(ray_count_);
    for (std::size_t s = 0; s < ray_sensors().size(); ++s) {
      const RaySensorDescription& sensor = ray_sensors()[s];
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

  // X_RM at present, where a joint moves the ranger.
  Pose MovedMount(const SensedWorld& world) const {
    const BodyId body = world.scene.body_of(robot());
    const ModelId model = description().model;
    return world.bodies.X_BL(body)[world.scene.link_of(model)] * world.scene.X_LM(model);
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
