// `blinkenlight`: a light that is on and off by turns. `lightindicator`: a light that a controller switches.
#include <cmath>

#include "worldfile/models/types/built_in_types.h"

namespace troupe {
namespace {

class BlinkenlightReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& /*context*/) override {
    const double period_ms = reader.Number("period", 1000.0, 1e-3, 1e6);
    const double duty_cycle = reader.Number("dutycycle", 1.0, 0.0, 1.0);
    const bool enabled = reader.Flag("enabled", true);
    Blinking& blinking = draft.model.blinking;
    blinking.period_ns = std::llround(period_ms * 1e6);
    blinking.on_ns = std::llround(period_ms * duty_cycle * 1e6);
    blinking.is_switched_on = enabled;
  }
};

class LightIndicatorReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& /*reader*/, ModelDraft& draft, BuildContext& /*context*/) override {
    constexpr std::int64_t kAnyPeriod = 1'000'000'000;  // ns
    draft.model.blinking = {kAnyPeriod, kAnyPeriod, false};
  }
};

}  // namespace

ModelType BlinkenlightType() {
  return {.name = "blinkenlight",
          .size = {0.02, 0.02, 0.02},
          .color = {0.0, 1.0, 0.0, 1.0},
          .make_reader = MakeReader<BlinkenlightReader>};
}

ModelType LightIndicatorType() {
  return {.name = "lightindicator", .make_reader = MakeReader<LightIndicatorReader>};
}

}  // namespace troupe
