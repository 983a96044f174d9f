// `camera`: colours and depths.
#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/sensor_properties.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

class CameraReader : public ModelReader {
 public:
  // In Stage its angles are in degrees whatever the file's unit; here they are in the file's unit, as all others.
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    CameraParameters camera;
    if (const auto resolution = reader.Numbers("resolution", 2)) {
      for (const double side : *resolution) {
        if (side >= 1.0 && side <= kMaxImageSide) continue;
        reader.diagnostics().Fail(
            reader.Where("resolution"),
            "found an image of " + NumberText(side) + " pixels, expected 1 to " + std::to_string(kMaxImageSide));
        return;
      }
      camera.width = static_cast<std::uint32_t>((*resolution)[0]);
      camera.height = static_cast<std::uint32_t>((*resolution)[1]);
    }
    camera.range = ReadRange(reader, camera.range);
    double vertical = camera.elevation.max - camera.elevation.min;
    if (const auto fov = reader.Numbers("fov", 2)) {
      camera.fov = reader.units().Angle((*fov)[0]);
      vertical = reader.units().Angle((*fov)[1]);
    }
    double pan = 0.0;
    double tilt = 0.0;
    if (const auto pantilt = reader.Numbers("pantilt", 2)) {
      pan = reader.units().Angle((*pantilt)[0]);
      tilt = reader.units().Angle((*pantilt)[1]);
    }
    camera.elevation = {tilt - 0.5 * vertical, tilt + 0.5 * vertical};
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
