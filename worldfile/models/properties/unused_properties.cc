#include "worldfile/models/properties/unused_properties.h"

#include <algorithm>
#include <span>
#include <string>

#include "worldfile/text/quote.h"

namespace troupe {
namespace {

struct NoEffect {
  std::string_view name;
  std::string_view reason;
};

constexpr std::string_view kWindow = "it only concerns Stage's window";
constexpr std::string_view kNotInStage = "it has none in Stage either";
constexpr std::string_view kFormer = "only older versions of Stage knew it";

constexpr NoEffect kWorldProperties[] = {
    {"confirm_on_quit", kWindow},
    {"interval_real", kFormer},
    {"paused", kWindow},
    {"resolution", "geometry is exact, without cells"},
    {"show_clock", kWindow},
    {"show_clock_interval", kWindow},
    {"speedup", "the command line sets the speed"},
    {"test", kNotInStage},
    {"threads", "each robot has its own process"},
};

constexpr NoEffect kModelProperties[] = {
    {"alwayson", "a sensor is on while it has a reader"},
    {"blob_return", kNotInStage},
    {"debug", kNotInStage},
    {"event_queue", kNotInStage},
    {"friction", kNotInStage},
    {"gui_grid", kWindow},
    {"gui_move", kWindow},
    {"gui_outline", kWindow},
    {"laser_return", kFormer},
    {"map_resolution", kNotInStage},
    {"say", kWindow},
    {"shape", kFormer},
    {"sonar_return", kFormer},
    {"trail_interval", kWindow},
    {"trail_length", kWindow},
    {"velocity", kNotInStage},
    {"view", kFormer},
};

constexpr NoEffect kSensorProperties[] = {
    {"color", kWindow},
    {"color_rgba", kWindow},
    {"view", kFormer},
};

std::string_view FindReason(std::span<const NoEffect> reasons, const std::string& name) {
  const auto found =
      std::find_if(reasons.begin(), reasons.end(), [&](const NoEffect& entry) { return entry.name == name; });
  return found == reasons.end() ? std::string_view{} : found->reason;
}

// `otherwise` follows the name of a property without a reason in the list.
void WarnOfUnused(PropertyReader& reader, std::span<const NoEffect> reasons, const std::string& otherwise,
                  bool in_sensor = false) {
  for (const Property* property : reader.Unused()) {
    const std::string_view reason = FindReason(reasons, property->name);
    const std::string statement = "property " + Quoted(property->name);
    if (reason == kWindow) {
      reader.diagnostics().WarnOfWindow(property->where, statement + (in_sensor ? " of a sensor" : ""));
      continue;
    }
    std::string text = statement + " has no effect";
    text += reason.empty() ? otherwise : ": " + std::string(reason);
    reader.diagnostics().Warn(property->where, text);
  }
}

}  // namespace

void WarnOfUnusedInWorld(PropertyReader& reader) {
  WarnOfUnused(reader, kWorldProperties, " in a 'world'");
}

void WarnOfUnusedInSensor(PropertyReader& reader) {
  WarnOfUnused(reader, kSensorProperties, " in a 'sensor'", true);
}

void WarnOfUnusedInBlock(PropertyReader& reader) {
  WarnOfUnused(reader, {}, " in a 'block'");
}

void WarnOfUnusedInModel(PropertyReader& reader, std::string_view type) {
  WarnOfUnused(reader, kModelProperties, " in a '" + std::string(type) + "'");
}

}  // namespace troupe
