// The model types of the sensors without a file of their own. Each reader maps properties to the parameters of one
// sensor (include/troupe/sensor.h), in m and rad; limits that belong to the sensor itself are in CheckParameters, which
// AddSensor calls, and not repeated here.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/limits.h"
#include "worldfile/models/properties/color_names.h"
#include "worldfile/models/types/field_properties.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// `blobfinder`: a finder of colours.

// The names of `colors`, as many as `colors_count` says, or all without it.
std::vector<Color> ReadColors(PropertyReader& reader) {
  std::vector<std::string> names = reader.Texts("colors");
  const auto count =
      static_cast<std::size_t>(reader.Integer("colors_count", static_cast<std::int64_t>(names.size()), 0, 1000));
  if (count > names.size()) {
    reader.diagnostics().Warn(reader.Where("colors_count"),
                              "found " + CountText(names.size(), "colour") + ", expected " + std::to_string(count));
  }
  names.resize(std::min(count, names.size()));
  std::vector<Color> colors;
  for (const std::string& name : names) {
    const std::optional<Color> color = FindColor(name);
    if (color) {
      colors.push_back(*color);
    } else {
      reader.diagnostics().Warn(reader.Where("colors"), "colour " + Quoted(name) + " is not known; it is not found");
    }
  }
  return colors;
}

class BlobfinderReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    BlobfinderParameters finder;
    if (const auto image = reader.Numbers("image", 2)) {
      finder.width = ImageSide(reader, "image", (*image)[0]);
      finder.height = ImageSide(reader, "image", (*image)[1]);
    }
    finder.range = ReadDistance(reader, "range", finder.range);
    finder.fov = ReadFov(reader, finder.fov);
    finder.X_MS = draft.X_MD * Pose{0.0, 0.0, 0.0, WrapAngle(ReadAngle(reader, "pan", 0.0))};
    finder.colors = ReadColors(reader);
    AddSensor(reader, draft, "blobfinder", std::move(finder), context);
  }
};

// `bumper` and `contact`: sensors of touch.

std::string Indexed(const std::string& name, std::size_t index) {
  return name + "[" + std::to_string(index) + "]";
}

class BumperReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    BumperParameters bumper;
    bumper.height = draft.size.z;
    const double length = ReadDistance(reader, "blength", 0.0);
    const auto count = static_cast<std::size_t>(reader.Integer("bcount", 0, 0, kMaxBumpers));
    for (std::size_t i = 0; i < count; ++i) {
      const Pose X_DB = reader.ReadPose(Indexed("bpose", i)).value_or(Pose{});
      bumper.segments.push_back({draft.X_MD * X_DB, ReadDistance(reader, Indexed("blength", i), length)});
      if (!IsWithinReach(bumper.segments.back().X_MB)) {
        reader.diagnostics().Fail(reader.Where(Indexed("bpose", i)),
                                  "found a segment beyond 1000 km, expected it nearer");
      }
    }
    if (bumper.segments.empty()) {
      reader.diagnostics().Warn(reader.node().where, "this bumper has no 'bcount', so it feels nothing");
    }
    AddSensor(reader, draft, "bumper", std::move(bumper), context);
  }
};

class ContactReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    AddSensor(reader, draft, "contact", ContactParameters(), context);
  }
};

// `camera`: colours and depths.

constexpr double kTinyAngle = 1e-9;  // rad
constexpr double kNarrow = 0.01;     // rad, of a picture that would be beyond the limits

// One of the two openings, rad: above 0, at most 170 degrees.
double Opening(PropertyReader& reader, double found, double otherwise) {
  const double most = 2.0 * kMaxElevation;
  const double radians = reader.units().Angle(found);
  if (radians > 0.0 && radians <= most) return radians;
  const double used = radians > most ? most : otherwise;
  reader.WarnOfValue(*reader.Use("fov"), NumberText(found),
                     "more than 0 and at most " + AngleText(reader.units(), most), AngleText(reader.units(), used));
  return used;
}

class CameraReader : public ModelReader {
 public:
  // In Stage its angles are in degrees whatever the file's unit; here they are in the file's unit, as all others.
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    CameraParameters camera;
    if (const auto resolution = reader.Numbers("resolution", 2)) {
      camera.width = ImageSide(reader, "resolution", (*resolution)[0]);
      camera.height = ImageSide(reader, "resolution", (*resolution)[1]);
    }
    camera.range = ReadRange(reader, camera.range);
    double vertical = camera.elevation.max - camera.elevation.min;
    if (const auto fov = reader.Numbers("fov", 2)) {
      camera.fov = Opening(reader, (*fov)[0], camera.fov);
      vertical = Opening(reader, (*fov)[1], vertical);
    }
    double pan = 0.0;
    double tilt = 0.0;
    if (const auto pantilt = reader.Numbers("pantilt", 2)) {
      pan = reader.units().Angle((*pantilt)[0]);
      tilt = reader.units().Angle((*pantilt)[1]);
    }
    // The picture is cut at the limits, not turned.
    camera.elevation = {std::max(tilt - 0.5 * vertical, -kMaxElevation),
                        std::min(tilt + 0.5 * vertical, kMaxElevation)};
    if (camera.elevation.max - camera.elevation.min < vertical - kTinyAngle) {
      reader.diagnostics().Warn(
          reader.Where(reader.node().Find("pantilt") != nullptr ? "pantilt" : "fov"),
          "found a picture that ends beyond 85 degrees above or below the horizontal, expected it "
          "within; it ends there");
    }
    if (!(camera.elevation.max > camera.elevation.min)) {
      camera.elevation = tilt > 0.0 ? Interval{kMaxElevation - kNarrow, kMaxElevation}
                                    : Interval{-kMaxElevation, kNarrow - kMaxElevation};
    }
    camera.X_MS = draft.X_MD * Pose{0.0, 0.0, 0.5 * draft.size.z, WrapAngle(pan)};
    AddSensor(reader, draft, "camera", camera, context);
  }
};

// `fiducial`: a finder of models with a `fiducial_return`.

class FiducialReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    FiducialParameters finder;
    finder.X_MS = draft.X_MD;
    finder.range.min = ReadDistance(reader, "range_min", 0.0);
    finder.range.max = ReadDistance(reader, "range_max", 8.0);
    if (finder.range.max < finder.range.min) {
      std::swap(finder.range.min, finder.range.max);
      reader.diagnostics().Warn(
          reader.Where("range_max"),
          "found a 'range_max' below the 'range_min', expected the other way round; they are exchanged");
    }
    finder.id_range = ReadDistance(reader, "range_max_id", 5.0);
    finder.fov = ReadFov(reader, kPi);
    finder.key = draft.model.fiducial_key;
    finder.ignores_height = reader.Flag("ignore_zloc", false);
    AddSensor(reader, draft, "fiducial", finder, context);
  }
};

// `imu`: an inertial measurement unit.

class ImuReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    ImuParameters imu;
    imu.X_MS = draft.X_MD;
    ReadFields(reader, imu);
    AddSensor(reader, draft, "IMU", imu, context);
  }
};

// `radio`: sends messages of the robot's controller to the radios of other robots, and receives theirs.

class RadioReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    RadioParameters radio;
    radio.X_MS = draft.X_MD;
    ReadFields(reader, radio);
    if (const Property* const period = reader.Use("update_interval")) {
      reader.diagnostics().Warn(period->where,
                                "property 'update_interval' has no effect: a radio receives in every tick");
    }
    AddSensor(reader, draft, "radio", radio, context);
    if (draft.robot) context.world.robots[draft.robot->index()].sensors.back().period_ticks = 1;
  }
};

}  // namespace

std::string AngleText(const Units& units, double radians) {
  return units.degrees ? NumberText(RadiansToDegrees(radians)) + " degrees" : NumberText(radians) + " radians";
}

std::uint32_t ImageSide(PropertyReader& reader, std::string_view name, double found) {
  const double side = std::clamp(found, 1.0, static_cast<double>(kMaxImageSide));
  if (side != found) {
    reader.WarnOfValue(*reader.Use(name), NumberText(found) + " pixels", "1 to " + std::to_string(kMaxImageSide),
                       NumberText(side));
  }
  return static_cast<std::uint32_t>(side);
}

std::uint32_t ReadPeriod(PropertyReader& reader, std::int64_t interval_ns) {
  const double period_ns = reader.Number("update_interval", 100.0, 0.0, 1e9) * 1e6;
  // Rounded up: a sensor is never faster than the file says. At least one tick.
  const double ticks = std::ceil(period_ns / static_cast<double>(interval_ns));
  return static_cast<std::uint32_t>(std::clamp(ticks, 1.0, 4e9));
}

double ReadFov(PropertyReader& reader, double otherwise) {
  const auto fov = reader.Numbers("fov", 1);
  if (!fov) return otherwise;
  const double radians = reader.units().Angle(fov->front());
  // Files in radians round 2 pi up.
  if (radians >= 0.0 && radians <= 2.0 * kPi + 1e-3) return std::min(radians, 2.0 * kPi);
  const double used = std::min(std::fabs(radians), 2.0 * kPi);
  reader.WarnOfValue(*reader.Use("fov"), NumberText(fov->front()),
                     std::string("0 to ") + (reader.units().degrees ? "360 degrees" : "6.2832 radians"),
                     AngleText(reader.units(), used));
  return used;
}

Interval ReadRange(PropertyReader& reader, const Interval& otherwise) {
  const auto range = reader.Numbers("range", 2);
  if (!range) return otherwise;
  const Interval found{(*range)[0] * reader.units().length, (*range)[1] * reader.units().length};
  Interval result{std::clamp(found.min, 0.0, kMaxMagnitude), std::clamp(found.max, 0.0, kMaxMagnitude)};
  if (result.min > result.max) std::swap(result.min, result.max);
  if (result.max == 0.0) result = otherwise;
  if (result.min == result.max) result.min = 0.0;
  if (result == found) return result;
  const auto text = [](double min, double max) { return "[" + NumberText(min) + " " + NumberText(max) + "]"; };
  const double unit = reader.units().length;
  reader.diagnostics().Warn(reader.Where("range"), "found range " + text((*range)[0], (*range)[1]) +
                                                       ", expected [min max] with 0 <= min < max <= 1000 km; " +
                                                       text(result.min / unit, result.max / unit) + " is used");
  return result;
}

double ReadDistance(PropertyReader& reader, std::string_view name, double otherwise) {
  const double distance = reader.Length(name, otherwise);
  if (distance >= 0.0) return distance;
  reader.diagnostics().Warn(reader.Where(name),
                            "found a negative " + Quoted(name) + ", expected at least 0; 0 is used");
  return 0.0;
}

double ReadAngle(PropertyReader& reader, std::string_view name, double otherwise, double max) {
  const auto angle = reader.Numbers(name, 1);
  if (!angle) return otherwise;
  const double radians = reader.units().Angle(angle->front());
  if (std::abs(radians) <= max) return radians;
  const double nearest = std::copysign(max, radians);
  reader.WarnOfValue(*reader.Use(name), NumberText(angle->front()),
                     "at most " + AngleText(reader.units(), max) + " to both sides",
                     AngleText(reader.units(), nearest));
  return nearest;
}

void AddSensor(PropertyReader& reader, const ModelDraft& draft, std::string_view noun, SensorParameters parameters,
               BuildContext& context) {
  SensorDescription sensor;
  sensor.period_ticks = ReadPeriod(reader, context.world.interval_ns);
  sensor.frame = reader.Text("frame", "");
  if (!draft.robot) {
    reader.diagnostics().Warn(draft.node.where,
                              "this " + std::string(noun) + " is on no robot, so it measures nothing");
    return;
  }
  if (const Status problem = CheckParameters(parameters); !problem.ok() && !reader.diagnostics().failed()) {
    reader.diagnostics().Fail(draft.node.where, "found a " + std::string(noun) + " that cannot be: " +
                                                    problem.error().message + ", expected usable values");
  }
  sensor.parameters = std::move(parameters);
  sensor.name = NameOnRobot(context.world, *draft.robot, draft.model.name);
  sensor.model = draft.id;
  context.world.robots[draft.robot->index()].sensors.push_back(std::move(sensor));
}

ModelType BlobfinderType() {
  return {.name = "blobfinder", .has_body = false, .make_reader = MakeReader<BlobfinderReader>};
}

ModelType BumperType() {
  return {.name = "bumper", .make_reader = MakeReader<BumperReader>};
}

ModelType ContactType() {
  return {.name = "contact", .has_body = false, .size = {0.0, 0.0, 0.0}, .make_reader = MakeReader<ContactReader>};
}

ModelType CameraType() {
  return {.name = "camera",
          .size = {0.1, 0.07, 0.05},
          .color = {0.0, 0.0, 0.0, 1.0},
          .make_reader = MakeReader<CameraReader>};
}

ModelType FiducialType() {
  return {.name = "fiducial", .has_body = false, .size = {0.0, 0.0, 0.0}, .make_reader = MakeReader<FiducialReader>};
}

ModelType ImuType() {
  return {.name = "imu", .has_body = false, .size = {0.0, 0.0, 0.0}, .make_reader = MakeReader<ImuReader>};
}

ModelType RadioType() {
  return {.name = "radio", .has_body = false, .size = {0.0, 0.0, 0.0}, .make_reader = MakeReader<RadioReader>};
}

}  // namespace troupe
