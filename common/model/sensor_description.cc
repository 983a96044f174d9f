// The checks and summaries of sensor parameters: rules between fields; single values are checked by their limits
// (field_check.h).
#include "troupe/sensor_description.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "common/base/source_text.h"
#include "common/model/field_check.h"
#include "troupe/interval.h"

namespace troupe {
namespace {

std::string Metres(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " m";
}

std::string Pixels(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels";
}

Status CheckRaySensor(const RaySensorDescription& sensor) {
  if (sensor.planes() * sensor.samples > kMaxRays) {
    return BadInput("a sensor has more than " + std::to_string(kMaxRays) + " rays");
  }
  for (std::size_t i = 1; i < sensor.elevations.size(); ++i) {
    if (sensor.elevations[i] <= sensor.elevations[i - 1]) {
      return BadInput("the elevations of a sensor are not ascending");
    }
  }
  return {};
}

// The alternative of SensorParameters with this type name.
template <std::size_t I = 0>
std::optional<SensorParameters> ParametersFrom(std::string_view type) {
  if constexpr (I < std::variant_size_v<SensorParameters>) {
    using Parameters = std::variant_alternative_t<I, SensorParameters>;
    if (type == Parameters::kType) return SensorParameters(Parameters());
    return ParametersFrom<I + 1>(type);
  } else {
    return std::nullopt;
  }
}

}  // namespace

Status RangerParameters::Check() const {
  for (const RaySensorDescription& sensor : *ray_sensors) {
    if (Status error = CheckRaySensor(sensor); !error.ok()) return error;
  }
  return {};
}

std::string RangerParameters::Summary() const {
  std::size_t rays = 0;
  for (const RaySensorDescription& sensor : *ray_sensors) rays += sensor.samples * sensor.planes();
  return CountText(ray_sensors->size(), "sensor") + ", " + CountText(rays, "ray");
}

Status BreakBeamParameters::Check() const {
  // MountedSensors makes it; a description of a robot must not contain one.
  return BadInput("it belongs to a gripper");
}

std::string BreakBeamParameters::Summary() const {
  return CountText(beams.size(), "beam");
}

std::string FiducialParameters::Summary() const {
  return "up to " + Metres(range.max);
}

Status BumperParameters::Check() const {
  if (segments.size() > kMaxBumpers) return BadInput("it has more than " + std::to_string(kMaxBumpers) + " segments");
  return {};
}

std::string BumperParameters::Summary() const {
  return CountText(segments.size(), "segment");
}

std::string BlobfinderParameters::Summary() const {
  return Pixels(width, height) + ", " + (colors.empty() ? "all colors" : CountText(colors.size(), "color"));
}

Status CameraParameters::Check() const {
  if (!(elevation.min < elevation.max)) return BadInput("its picture has no height");
  return {};
}

Interval CameraParameters::TiltLimits() const {
  return {-kMaxElevation - elevation.min, kMaxElevation - elevation.max};
}

std::string CameraParameters::Summary() const {
  return Pixels(width, height);
}

std::string RadioParameters::Summary() const {
  return "up to " + Metres(range) + ", channel " + std::to_string(channel) +
         (range_and_bearing ? ", range and bearing" : "");
}

std::string_view TypeOf(const SensorParameters& parameters) {
  return std::visit([](const auto& kind) { return kind.kType; }, parameters);
}

std::optional<SensorParameters> DefaultParameters(std::string_view type) {
  return ParametersFrom(type);
}

Status CheckParameters(const SensorParameters& parameters) {
  FieldCheck check(nullptr);
  return std::visit(
      [&](const auto& kind) {
        if (!check.Check(kind)) return Status(BadInput(check.problem()));
        if constexpr (requires { kind.Check(); }) return kind.Check();
        return Status();
      },
      parameters);
}

std::string SummaryOf(const SensorParameters& parameters) {
  return std::visit([](const auto& kind) { return kind.Summary(); }, parameters);
}

}  // namespace troupe
