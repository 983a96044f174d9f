// `camera`: colours and depths.
#include <algorithm>

#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/sensor_properties.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

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

}  // namespace

ModelType CameraType() {
  return {.name = "camera",
          .size = {0.1, 0.07, 0.05},
          .color = {0.0, 0.0, 0.0, 1.0},
          .make_reader = MakeReader<CameraReader>};
}

}  // namespace troupe
