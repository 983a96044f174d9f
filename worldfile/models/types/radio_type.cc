// `radio`: sends messages of the robot's controller to the radios of other robots, and receives theirs.
#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/sensor_properties.h"

namespace troupe {
namespace {

constexpr double kMostDecibels = 1000.0;

class RadioReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    RadioParameters radio;
    radio.X_MS = draft.X_MD;
    radio.channel = static_cast<std::int32_t>(reader.Integer("channel", radio.channel, -1'000'000'000, 1'000'000'000));
    radio.range = ReadDistance(reader, "range", radio.range);
    radio.bandwidth = reader.Number("bandwidth", radio.bandwidth, 0.0);
    radio.delay = reader.Number("delay", radio.delay, 0.0, kLongestRadioDelay);
    radio.loss = reader.Number("loss", radio.loss, 0.0, 1.0);
    radio.range_loss = reader.Number("range_loss", radio.range_loss, 0.0, 1.0);
    radio.power = reader.Number("power", radio.power, -kMostDecibels, kMostDecibels);
    radio.path_loss_exponent = reader.Number("path_loss_exponent", radio.path_loss_exponent, 1e-3, 100.0);
    radio.wall_loss = reader.Number("wall_loss", radio.wall_loss, 0.0, kMostDecibels);
    radio.body_loss = reader.Number("body_loss", radio.body_loss, 0.0, kMostDecibels);
    radio.range_and_bearing = reader.Flag("range_and_bearing", radio.range_and_bearing);
    radio.range_noise = ReadDistance(reader, "range_noise", radio.range_noise);
    radio.bearing_noise = ReadAngle(reader, "bearing_noise", radio.bearing_noise);
    if (const Property* const period = reader.Use("update_interval")) {
      reader.diagnostics().Warn(period->where,
                                "property 'update_interval' has no effect: a radio receives in every tick");
    }
    AddSensor(reader, draft, "radio", radio, context);
    if (draft.robot) context.world.robots[draft.robot->index()].sensors.back().period_ticks = 1;
  }
};

}  // namespace

ModelType RadioType() {
  return {.name = "radio", .has_body = false, .size = {0.0, 0.0, 0.0}, .make_reader = MakeReader<RadioReader>};
}

}  // namespace troupe
