// `imu`: an inertial measurement unit.
#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/sensor_properties.h"

namespace troupe {
namespace {

class ImuReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    ImuParameters imu;
    imu.X_MS = draft.X_MD;
    imu.heading_noise = ReadAngle(reader, "heading_noise", imu.heading_noise);
    imu.gyro_noise = ReadAngle(reader, "gyro_noise", imu.gyro_noise);
    imu.gyro_bias = ReadAngle(reader, "gyro_bias", imu.gyro_bias);
    imu.acceleration_noise = reader.Number("acceleration_noise", imu.acceleration_noise, 0.0);
    imu.acceleration_bias = reader.Number("acceleration_bias", imu.acceleration_bias, 0.0);
    AddSensor(reader, draft, "IMU", imu, context);
  }
};

}  // namespace

ModelType ImuType() {
  return {.name = "imu", .has_body = false, .size = {0.0, 0.0, 0.0}, .make_reader = MakeReader<ImuReader>};
}

}  // namespace troupe
