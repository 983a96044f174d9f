#include "library/save_picture.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "common/base/file.h"
#include "common/sensing/sensor_suite.h"

namespace troupe {
namespace {

// Grey, from white at the nearest depth to black at the farthest and beyond.
std::vector<std::uint8_t> DepthPixels(const CameraReading& reading) {
  const double reach = std::max(reading.limits.max - reading.limits.min, 1e-9);
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * reading.depths.size());
  for (const float depth : reading.depths) {
    const double share = std::clamp((static_cast<double>(depth) - reading.limits.min) / reach, 0.0, 1.0);
    const auto grey = static_cast<std::uint8_t>(std::lround(255.0 * (1.0 - share)));
    rgb.insert(rgb.end(), 3, grey);
  }
  return rgb;
}

}  // namespace

// Options are checked before the sensors are measured, which is most of the time.
Result<std::string> DrawPicture(const Scene& scene, const BodyIndex& bodies, const WorldState& state,
                                const PictureOptions& options, PictureRays rays) {
  if (const Status problem = CheckPictureOptions(options); !problem.ok()) return problem.error();
  const std::vector<ScanFan> fans =
      rays == PictureRays::kDrawn ? MeasureFans(scene, bodies, state) : std::vector<ScanFan>();
  const std::vector<Mark> marks =
      rays == PictureRays::kDrawn ? MeasureMarks(scene, bodies, state) : std::vector<Mark>();
  Result<std::string> bytes = DrawPicture(scene.world(), state, fans, options, marks);
  if (!bytes.ok()) return Failure(bytes.error().message);
  return bytes;
}

Status SavePicture(const Scene& scene, const BodyIndex& bodies, const WorldState& state, const std::string& file,
                   const PictureOptions& options, PictureRays rays) {
  const Result<PictureFormat> format = PictureFormatOf(file);
  if (!format.ok()) return format.error();
  PictureOptions with_format = options;
  with_format.format = format.value();
  const Result<std::string> bytes = DrawPicture(scene, bodies, state, with_format, rays);
  if (!bytes.ok()) return bytes.error();
  return WriteWholeFile(file, bytes.value());
}

Status SaveView(const CameraReading& reading, const std::string& file, CameraImage image) {
  const Result<PictureFormat> format = PictureFormatOf(file);
  if (!format.ok()) return format.error();
  if (format.value() != PictureFormat::kPng) {
    return Error{{file, 0, 0}, "found a camera's picture as .svg, expected .png", ErrorCode::kBadInput};
  }
  const std::vector<std::uint8_t> rgb = image == CameraImage::kDepths ? DepthPixels(reading) : reading.colors;
  const Result<std::string> bytes = EncodePng(static_cast<int>(reading.width), static_cast<int>(reading.height), rgb);
  if (!bytes.ok()) return Failure(bytes.error().message);
  return WriteWholeFile(file, bytes.value());
}

std::vector<ScanFan> MeasureFans(const Scene& scene, const BodyIndex& bodies, const WorldState& state) {
  std::vector<ScanFan> fans;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    for (const std::unique_ptr<const Sensor>& sensor : MakeSensors(scene, RobotId(i))) {
      const SensorReading reading = sensor->Measure({scene, bodies, &state}, state.tick);
      const RangerReading* const ranger = reading.ranger();
      if (ranger == nullptr) continue;  // other kinds have no fans
      for (const RangeScan& scan : ranger->scans()) {
        const Pose X_WS = bodies.X_WB(scene.body_of(RobotId(i))) * scan.X_RS;
        // The picture is flat: of a scan with several planes it shows the flattest.
        const std::size_t first = FlattestPlane(scan) * scan.fan.count;
        const auto begin = scan.ranges.begin() + static_cast<std::ptrdiff_t>(first);
        ScanFan fan{
            X_WS, scan.fan.fov, scan.limits.max, {}, {begin, begin + static_cast<std::ptrdiff_t>(scan.fan.count)}};
        for (std::size_t ray = 0; ray < scan.fan.count; ++ray) fan.bearings.push_back(scan.fan.Bearing(ray));
        fans.push_back(std::move(fan));
      }
    }
  }
  return fans;
}

std::vector<Mark> MeasureMarks(const Scene& scene, const BodyIndex& bodies, const WorldState& state) {
  std::vector<Mark> marks;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    if (!RobotExists(scene.world(), RobotId(i))) continue;
    for (const std::unique_ptr<const Sensor>& sensor : MakeSensors(scene, RobotId(i))) {
      const SensedWorld world{scene, bodies, &state};
      if (std::holds_alternative<RangerParameters>(sensor->description().parameters)) continue;  // it has fans
      sensor->AddMarks(world, sensor->Measure(world, state.tick), marks);
    }
  }
  return marks;
}

}  // namespace troupe
