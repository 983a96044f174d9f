#include "common/sensing/sensor_registry.h"

#include <algorithm>
#include <array>

#include "common/sensing/blobfinder.h"
#include "common/sensing/break_beam.h"
#include "common/sensing/bumper.h"
#include "common/sensing/camera.h"
#include "common/sensing/contact.h"
#include "common/sensing/fiducial.h"
#include "common/sensing/imu.h"
#include "common/sensing/radio.h"
#include "common/sensing/ranger.h"
#include "troupe/check.h"

namespace troupe {
namespace {

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
