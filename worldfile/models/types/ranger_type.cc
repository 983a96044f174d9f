// `ranger`: one or more ray sensors on one model, each with its own pose, fan and noise. Elevations are rad above the
// horizontal plane of the sensor, ascending; without them the fan is flat, which is Stage's ranger and cheaper.
#include <algorithm>
#include <cmath>

#include "common/geometry/limits.h"
#include "worldfile/models/properties/property_reader.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr double kDefaultSensorHeight = 0.02;  // m

constexpr std::size_t kMaxPlanes = 1024;

// rad, of the planes of a sensor with several: by `planes` and `vertical_fov`, or as a list. Empty: one horizontal
// plane.
std::vector<double> ReadElevations(PropertyReader& reader) {
  const std::size_t planes = static_cast<std::size_t>(reader.Integer("planes", 1, 1, kMaxPlanes));
  const double fov = ReadAngle(reader, "vertical_fov", DegreesToRadians(30.0), 2.0 * kMaxElevation);
  const Property* const list = reader.Use("elevations");
  std::vector<double> elevations;
  if (list == nullptr) {
    if (planes == 1) return {};
    if (!(fov > 0.0)) {
      reader.diagnostics().Fail(reader.Where("vertical_fov"), "found no 'vertical_fov' above 0 for several planes");
      return {};
    }
    const double last = static_cast<double>(planes - 1);
    for (std::size_t i = 0; i < planes; ++i) {
      // Symmetric to the last bit: plane i and plane n - 1 - i are negatives of each other.
      elevations.push_back(fov * ((2.0 * static_cast<double>(i) - last) / (2.0 * last)));
    }
    return elevations;
  }
  for (const char* name : {"planes", "vertical_fov"}) {
    if (reader.node().Find(name) == nullptr) continue;
    reader.diagnostics().Warn(reader.Where(name), "property " + Quoted(name) + " has no effect beside 'elevations'");
  }
  const auto numbers = reader.Numbers("elevations", reader.Texts("elevations").size());
  if (!numbers) return {};
  for (const double number : *numbers) elevations.push_back(reader.units().Angle(number));
  // Sorted and distinct, as CheckParameters of a sensor wants them.
  std::sort(elevations.begin(), elevations.end());
  const bool usable = !elevations.empty() && elevations.size() <= kMaxPlanes && elevations.front() >= -kMaxElevation &&
                      elevations.back() <= kMaxElevation &&
                      std::adjacent_find(elevations.begin(), elevations.end()) == elevations.end();
  if (usable) return elevations;
  reader.diagnostics().Fail(reader.Where("elevations"),
                            "found elevations that are equal, too many or beyond 85 degrees, expected up to " +
                                std::to_string(kMaxPlanes) + " different ones");
  return {};
}

struct Noise {
  double variance = 0.0;      // m^2
  double proportional = 0.0;  // of the range
  double angle = 0.0;         // rad
};

Noise ReadNoise(PropertyReader& reader) {
  const auto noise = reader.Numbers("noise", 3);
  if (!noise) return {};
  if (*std::min_element(noise->begin(), noise->end()) < 0.0) {
    reader.diagnostics().Warn(reader.Where("noise"), "found negative noise, expected values of at least 0; 0 is used");
  }
  return {std::max(0.0, (*noise)[0]), std::max(0.0, (*noise)[1]), reader.units().Angle(std::max(0.0, (*noise)[2]))};
}

RaySensorDescription ReadSensor(const WorldNode& node, const Pose& X_MD, const Units& units, Diagnostics& diagnostics) {
  PropertyReader reader(node, units, diagnostics);
  RaySensorDescription sensor;
  double height = kDefaultSensorHeight;
  if (const auto size = reader.Numbers("size", 3)) height = (*size)[2] * units.length;
  const Pose X_DS = reader.ReadPose("pose").value_or(Pose{});
  sensor.X_MS = X_MD * X_DS;
  sensor.X_MS.z += 0.5 * height;  // rays leave from half the sensor's height
  if (!IsWithinReach(sensor.X_MS)) {
    diagnostics.Fail(reader.Where("pose"), "found a sensor beyond 1000 km, expected it nearer");
  }
  sensor.range = ReadRange(reader, sensor.range);
  sensor.fov = ReadFov(reader, sensor.fov);
  sensor.samples = static_cast<std::uint32_t>(reader.Integer("samples", 1, 1, kMaxRaySamples));
  sensor.elevations = ReadElevations(reader);
  const Noise noise = ReadNoise(reader);
  sensor.noise_variance = noise.variance;
  sensor.noise_proportional = noise.proportional;
  sensor.noise_angle = noise.angle;
  WarnOfUnusedInSensor(reader);
  if (!node.children.empty()) {
    diagnostics.Fail(node.children.front().where,
                     "found " + Quoted(node.children.front().type) + " inside a sensor, expected only properties");
  }
  return sensor;
}

class RangerReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    // The macro's nodes are shared, so that the address is the identity of the text; the tree outlives the build.
    const RangerParameters* ranger = context.rangers.Find(reader.node());
    if (ranger == nullptr) ranger = &context.rangers.Add(reader.node(), ReadRanger(reader, draft.X_MD));
    AddSensor(reader, draft, "ranger", *ranger, context);
  }

 private:
  static RangerParameters ReadRanger(PropertyReader& reader, const Pose& X_MD) {
    std::vector<RaySensorDescription> sensors;
    for (const WorldNode& child : reader.node().children) {
      if (child.type == "sensor") sensors.push_back(ReadSensor(child, X_MD, reader.units(), reader.diagnostics()));
    }
    if (sensors.empty()) {
      reader.diagnostics().Warn(reader.node().where, "this ranger has no 'sensor', so it measures nothing");
    }
    return {std::move(sensors)};
  }
};

}  // namespace

ModelType RangerType() {
  return {.name = "ranger",
          .has_body = false,
          .size = {0.15, 0.15, 0.2},
          .color = {0.0, 0.0, 139.0 / 255.0, 1.0},
          .has_sensors = true,
          .make_reader = MakeReader<RangerReader>};
}

}  // namespace troupe
