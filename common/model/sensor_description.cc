#include "troupe/sensor_description.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/geometry/limits.h"
#include "troupe/color.h"
#include "troupe/interval.h"
#include "troupe/pose.h"
#include "troupe/vec2.h"

namespace troupe {
namespace {

// The numbers of a plain value, one after another, and the value from its numbers: the form in which the parameters of
// a sensor are hashed, checked and sent. A struct lists its parts by a static VisitFields(self, visit), which calls
// visit(name, part) for each; a list is its length and its elements.

// Gives each number to `take`.
template <typename Take>
class NumberWriter {
 public:
  explicit NumberWriter(Take take) : take_(std::move(take)) {}

  void Write(double value) { take_(value); }
  void Write(bool value) { Write(value ? 1.0 : 0.0); }
  void Write(std::uint32_t value) { Write(static_cast<double>(value)); }
  void Write(std::int32_t value) { Write(static_cast<double>(value)); }
  void Write(const Vec2& p) { WriteAll(p.x(), p.y()); }
  void Write(const Pose& pose) { WriteAll(pose.x, pose.y, pose.z, pose.heading); }
  void Write(const Interval& interval) { WriteAll(interval.min, interval.max); }
  void Write(const Color& color) { WriteAll(color.r, color.g, color.b, color.a); }
  template <typename T>
  void Write(const std::vector<T>& list) {
    Write(static_cast<std::uint32_t>(list.size()));
    for (const T& element : list) Write(element);
  }
  template <typename T>
  void Write(const Shared<T>& value) {
    Write(*value);
  }
  template <typename T>
  requires std::is_class_v<T>
  void Write(const T& value) {
    T::VisitFields(value, [this](std::string_view, const auto& part) { this->Write(part); });
  }

 private:
  template <typename... Numbers>
  void WriteAll(Numbers... numbers) {
    (take_(numbers), ...);
  }
  Take take_;
};

// Reads what NumberWriter wrote. After the first number that is missing or does not fit, ok() is false.
class NumberReader {
 public:
  explicit NumberReader(std::span<const double> numbers) : numbers_(numbers) {}

  bool ok() const { return ok_; }
  bool at_end() const { return next_ == numbers_.size(); }

  void Read(double& value) {
    ok_ = ok_ && next_ < numbers_.size();
    if (ok_) value = numbers_[next_++];
  }
  void Read(bool& value) { value = ReadWhole(0.0, 1.0) != 0.0; }
  void Read(std::uint32_t& value) {
    value = static_cast<std::uint32_t>(ReadWhole(0.0, std::numeric_limits<std::uint32_t>::max()));
  }
  void Read(std::int32_t& value) {
    value = static_cast<std::int32_t>(
        ReadWhole(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()));
  }
  void Read(Vec2& p) { ReadAll(p.x(), p.y()); }
  void Read(Pose& pose) { ReadAll(pose.x, pose.y, pose.z, pose.heading); }
  void Read(Interval& interval) { ReadAll(interval.min, interval.max); }
  void Read(Color& color) { ReadAll(color.r, color.g, color.b, color.a); }
  template <typename T>
  void Read(std::vector<T>& list) {
    std::uint32_t count = 0;
    Read(count);
    // Every element has at least one number: a wrong length cannot exhaust the memory.
    ok_ = ok_ && count <= numbers_.size() - next_;
    if (!ok_) return;
    list.resize(count);
    for (T& element : list) Read(element);
  }
  template <typename T>
  void Read(Shared<T>& value) {
    T own;
    Read(own);
    value = std::move(own);
  }
  template <typename T>
  requires std::is_class_v<T>
  void Read(T& value) {
    T::VisitFields(value, [this](std::string_view, auto& part) { this->Read(part); });
  }

 private:
  template <typename... Numbers>
  void ReadAll(Numbers&... numbers) {
    (Read(numbers), ...);
  }
  double ReadWhole(double min, double max) {
    double value = 0.0;
    Read(value);
    ok_ = ok_ && value >= min && value <= max && std::trunc(value) == value;
    return ok_ ? value : 0.0;
  }

  std::span<const double> numbers_;
  std::size_t next_ = 0;
  bool ok_ = true;
};

Error SensorProblem(const std::string& message) {
  return {.where = {}, .message = message};
}

bool IsRange(const Interval& range) {
  return range.min >= 0.0 && range.min <= range.max;
}

std::string CountOf(std::size_t number, const char* noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

std::string Metres(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " m";
}

std::string Pixels(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels";
}

Status CheckImage(std::uint32_t width, std::uint32_t height) {
  if (width < 1 || width > kMaxImageSide || height < 1 || height > kMaxImageSide) {
    return SensorProblem("its image is not 1 to " + std::to_string(kMaxImageSide) + " pixels wide and high");
  }
  return {};
}

Status CheckRaySensor(const RaySensorDescription& sensor) {
  if (!IsRange(sensor.range)) return SensorProblem("the range of a sensor is not an interval from 0 up");
  if (sensor.fov < 0.0) return SensorProblem("the fov of a sensor is not finite or negative");
  if (sensor.samples < 1 || sensor.samples > kMaxRaySamples) {
    return SensorProblem("a sensor does not have 1 to " + std::to_string(kMaxRaySamples) + " samples");
  }
  if (sensor.noise_variance < 0.0) return SensorProblem("the noise of a sensor is not finite or its variance negative");
  if (sensor.planes() * sensor.samples > kMaxRays) {
    return SensorProblem("a sensor has more than " + std::to_string(kMaxRays) + " rays");
  }
  for (std::size_t i = 0; i < sensor.elevations.size(); ++i) {
    if (std::abs(sensor.elevations[i]) > kMaxElevation || (i > 0 && sensor.elevations[i] <= sensor.elevations[i - 1])) {
      return SensorProblem("the elevations of a sensor are not ascending within 85 degrees");
    }
  }
  return {};
}

// The alternative of SensorParameters with this type name.
template <std::size_t I = 0>
std::optional<SensorParameters> ParametersOfType(std::string_view type) {
  if constexpr (I < std::variant_size_v<SensorParameters>) {
    using Parameters = std::variant_alternative_t<I, SensorParameters>;
    if (type == Parameters::kType) return SensorParameters(Parameters());
    return ParametersOfType<I + 1>(type);
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
  return CountOf(ray_sensors->size(), "sensor") + ", " + CountOf(rays, "ray");
}

Status BreakBeamParameters::Check() const {
  return SensorProblem("it belongs to a gripper");
}

std::string BreakBeamParameters::Summary() const {
  return CountOf(beams.size(), "beam");
}

Status FiducialParameters::Check() const {
  if (!IsRange(range)) return SensorProblem("its range is not an interval from 0 up");
  if (id_range < 0.0) return SensorProblem("its range of identification is negative");
  if (!(fov >= 0.0 && fov <= 2.0 * kPi)) return SensorProblem("its fov is not 0 to 2 pi");
  return {};
}

std::string FiducialParameters::Summary() const {
  return "up to " + Metres(range.max);
}

Status BumperParameters::Check() const {
  if (segments.size() > kMaxBumpers)
    return SensorProblem("it has more than " + std::to_string(kMaxBumpers) + " segments");
  if (height < 0.0) return SensorProblem("its height is negative");
  for (const BumperSegment& segment : segments) {
    if (segment.length < 0.0) return SensorProblem("the length of a segment is negative");
  }
  return {};
}

std::string BumperParameters::Summary() const {
  return CountOf(segments.size(), "segment");
}

Status BlobfinderParameters::Check() const {
  if (Status error = CheckImage(width, height); !error.ok()) return error;
  if (!(fov > 0.0 && fov <= 2.0 * kPi)) return SensorProblem("its fov is not above 0 and at most 360 degrees");
  if (range < 0.0) return SensorProblem("its range is negative");
  return {};
}

std::string BlobfinderParameters::Summary() const {
  return Pixels(width, height) + ", " + (colors.empty() ? "all colors" : CountOf(colors.size(), "color"));
}

Status CameraParameters::Check() const {
  if (Status error = CheckImage(width, height); !error.ok()) return error;
  if (!(fov > 0.0 && fov <= 2.0 * kMaxElevation))
    return SensorProblem("its fov is not above 0 and at most 170 degrees");
  if (!IsRange(range)) return SensorProblem("its range is not an interval from 0 up");
  if (!(elevation.min >= -kMaxElevation && elevation.max <= kMaxElevation && elevation.min < elevation.max)) {
    return SensorProblem("its picture does not end within 85 degrees above and below the horizontal");
  }
  return {};
}

Interval CameraParameters::TiltLimits() const {
  return {-kMaxElevation - elevation.min, kMaxElevation - elevation.max};
}

std::string CameraParameters::Summary() const {
  return Pixels(width, height);
}

Status RadioParameters::Check() const {
  if (range < 0.0) return SensorProblem("its range is negative");
  if (bandwidth < 0.0) return SensorProblem("its bandwidth is negative");
  if (!(delay >= 0.0 && delay <= kMaxRadioDelay)) return SensorProblem("its delay is not 0 to 60 s");
  for (const double probability : {loss, range_loss}) {
    if (!(probability >= 0.0 && probability <= 1.0)) return SensorProblem("a loss of messages is not 0 to 1");
  }
  if (!(path_loss_exponent > 0.0)) return SensorProblem("its path loss exponent is not above 0");
  if (wall_loss < 0.0 || body_loss < 0.0) return SensorProblem("a loss by walls or bodies is negative");
  if (range_noise < 0.0 || bearing_noise < 0.0) return SensorProblem("a noise is negative");
  return {};
}

std::string RadioParameters::Summary() const {
  return "up to " + Metres(range) + ", channel " + std::to_string(channel) +
         (range_and_bearing ? ", range and bearing" : "");
}

Status ImuParameters::Check() const {
  for (const double error : {heading_noise, gyro_noise, gyro_bias, acceleration_noise, acceleration_bias}) {
    if (error < 0.0) return SensorProblem("the standard deviation of one of its errors is negative");
  }
  return {};
}

std::string_view TypeOf(const SensorParameters& parameters) {
  return std::visit([](const auto& kind) { return kind.kType; }, parameters);
}

std::vector<SensorField> FieldsOf(const SensorParameters& parameters) {
  std::vector<SensorField> fields;
  std::visit(
      [&](const auto& kind) {
        kind.VisitFields(kind, [&](std::string_view name, const auto& part) {
          SensorField& field = fields.emplace_back(SensorField{std::string(name), {}});
          NumberWriter([&](double number) { field.numbers.push_back(number); }).Write(part);
        });
      },
      parameters);
  return fields;
}

Result<SensorParameters> ParametersFrom(std::string_view type, std::span<const SensorField> fields) {
  std::optional<SensorParameters> parameters = ParametersOfType(type);
  if (!parameters) return SensorProblem("found a sensor of type '" + std::string(type) + "', expected a known one");
  std::size_t next = 0;
  std::string wrong;
  std::visit(
      [&](auto& kind) {
        kind.VisitFields(kind, [&](std::string_view name, auto& part) {
          if (!wrong.empty()) return;
          if (next < fields.size() && fields[next].name == name) {
            NumberReader reader(fields[next].numbers);
            reader.Read(part);
            if (reader.ok() && reader.at_end()) {
              ++next;
              return;
            }
          }
          wrong = name;
        });
      },
      *parameters);
  if (wrong.empty() && next < fields.size()) wrong = fields[next].name;
  if (wrong.empty()) return *std::move(parameters);
  return SensorProblem("found a " + std::string(type) + " with a wrong field '" + wrong + "'");
}

Status CheckParameters(const SensorParameters& parameters) {
  std::string_view wrong;
  const auto check = [&](std::string_view name, const auto& part) {
    if (!wrong.empty() || name == "key" || name == "channel") return;  // ids are no magnitudes
    bool usable = true;
    NumberWriter([&](double number) { usable = usable && std::abs(number) <= kMaxMagnitude; }).Write(part);
    if (!usable) wrong = name;
  };
  return std::visit(
      [&](const auto& kind) {
        kind.VisitFields(kind, check);
        if (wrong.empty()) return kind.Check();
        const std::string name(wrong);
        return Status(SensorProblem("its field '" + name + "' has a number that is not finite or too large"));
      },
      parameters);
}

std::string SummaryOf(const SensorParameters& parameters) {
  return std::visit([](const auto& kind) { return kind.Summary(); }, parameters);
}

}  // namespace troupe
