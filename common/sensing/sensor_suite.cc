#include "common/sensing/sensor_suite.h"

#include <algorithm>
#include <array>

#include "common/base/prefetch.h"
#include "common/sensing/contact.h"
#include "common/sensing/sensor_kinds.h"
#include "troupe/check.h"

namespace troupe {
namespace {

// The length is the number of kinds of descriptions: a forgotten kind leaves a row without a maker.
constexpr std::array<SensorKind, std::variant_size_v<SensorParameters>> kKinds = {{
    {RangerParameters::kType, MakeRanger},
    {BreakBeamParameters::kType, MakeBreakBeams},
    {FiducialParameters::kType, MakeFiducialFinder},
    {BumperParameters::kType, MakeBumper},
    {ContactParameters::kType, MakeContactSensor},
    {BlobfinderParameters::kType, MakeBlobfinder},
    {CameraParameters::kType, MakeCamera},
    {RadioParameters::kType, MakeRadio},
    {ImuParameters::kType, MakeImu},
}};

}  // namespace

SensorSuite::SensorSuite(const Scene& scene, RobotId robot)
    : sensors_(MakeSensors(scene, robot)), subscribed_(sensors_.size(), false), readings_(sensors_.size()) {}

void SensorSuite::CopyReadings(const SensorSuite& other) {
  subscribed_ = other.subscribed_;
  readings_ = other.readings_;
}

void SensorSuite::Prefetch() const {
  for (const auto& sensor : sensors_) troupe::Prefetch(sensor.get(), sizeof(Sensor));
  troupe::Prefetch(readings_.data(), readings_.size() * sizeof(SensorReading));
}

void SensorSuite::Update(const SensedWorld& world, Tick tick) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (subscribed_[i] && sensors_[i]->IsDueAt(tick)) sensors_[i]->MeasureInto(world, tick, readings_[i]);
  }
}

const SensorReading& SensorSuite::Measure(std::size_t index, const SensedWorld& world, Tick tick) {
  const SensorReading& reading = readings_[index];
  if (!reading.empty() && reading.tick == tick) return reading;
  // MeasureInto reuses only readings of its own sensor.
  if (unsubscribed_sensor_ != index) unsubscribed_ = {};
  unsubscribed_sensor_ = index;
  sensors_[index]->MeasureInto(world, tick, unsubscribed_);
  return unsubscribed_;
}

std::span<const SensorKind> SensorKinds() {
  return kKinds;
}

const SensorKind* FindSensorKind(std::string_view type) {
  const auto* const found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const SensorKind& kind) { return kind.type == type; });
  return found == kKinds.end() ? nullptr : found;
}

std::vector<SensorDescription> MountedSensors(const Scene& scene, RobotId robot) {
  const WorldDescription& world = scene.world();
  std::vector<SensorDescription> sensors = world.robot(robot).sensors;
  for (const GripperId id : scene.grippers_of(robot)) {
    const GripperDescription& gripper = world.gripper(id);
    if (gripper.beams.empty()) continue;
    sensors.push_back({.name = gripper.name + ".beams",
                       .model = gripper.model,
                       .period_ticks = 1,
                       .parameters = BreakBeamParameters{gripper.beams}});
  }
  return sensors;
}

std::vector<std::unique_ptr<const Sensor>> MakeSensors(const Scene& scene, RobotId robot) {
  std::vector<std::unique_ptr<const Sensor>> sensors;
  for (const SensorDescription& description : MountedSensors(scene, robot)) {
    const SensorKind* const kind = FindSensorKind(TypeOf(description.parameters));
    TROUPE_CHECK(kind != nullptr);
    sensors.push_back(kind->make({scene, robot, sensors.size(), description}));
  }
  return sensors;
}

}  // namespace troupe
