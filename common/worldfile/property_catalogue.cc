#include "common/worldfile/property_catalogue.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "common/worldfile/quote.h"

namespace troupe {
namespace {

constexpr Color kRed{1.0, 0.0, 0.0, 1.0};
constexpr Color kGreen{0.0, 1.0, 0.0, 1.0};
constexpr Color kBlack{0.0, 0.0, 0.0, 1.0};
constexpr Color kDarkBlue{0.0, 0.0, 139.0 / 255.0, 1.0};

constexpr TypeDefaults kTypes[] = {
    {"model", true, {0.4, 0.4, 1.0}, kRed, true},
    {"position", true, {0.4, 0.4, 1.0}, kRed, true},
    {"ranger", false, {0.15, 0.15, 0.2}, kDarkBlue, true},
    {"actuator", true, {0.4, 0.4, 1.0}, kRed, true},
    {"blinkenlight", true, {0.02, 0.02, 0.02}, kGreen, false},
    {"blobfinder", false, {0.4, 0.4, 1.0}, kRed, false},
    {"bumper", true, {0.4, 0.4, 1.0}, kRed, false},
    {"camera", true, {0.1, 0.07, 0.05}, kBlack, false},
    {"fiducial", false, {0.0, 0.0, 0.0}, kRed, false},
    {"gripper", true, {0.2, 0.3, 0.2}, kRed, true},
    {"lightindicator", true, {0.4, 0.4, 1.0}, kRed, false},
};

// Older versions of Stage had them.
constexpr std::string_view kFormerTypes[] = {"charger", "laser", "map", "puck", "sonar", "wifi"};

struct NoEffect {
  std::string_view name;
  std::string_view reason;
};

constexpr std::string_view kWindow = "it only concerns Stage's window";
constexpr std::string_view kEnergy = "energy is not simulated";
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
    {"alwayson", "every sensor that somebody reads is on"},
    {"blob_return", kNotInStage},
    {"debug", kNotInStage},
    {"event_queue", kNotInStage},
    {"fiducial_key", "fiducial finders are not simulated yet"},
    {"friction", kNotInStage},
    {"give_watts", kEnergy},
    {"gui_grid", kWindow},
    {"gui_move", kWindow},
    {"gui_outline", kWindow},
    {"joules", kEnergy},
    {"joules_capacity", kEnergy},
    {"kjoules", kEnergy},
    {"kjoules_capacity", kEnergy},
    {"laser_return", kFormer},
    {"map_resolution", kNotInStage},
    {"mass", kEnergy},
    {"say", kWindow},
    {"shape", kFormer},
    {"sonar_return", kFormer},
    {"take_watts", kEnergy},
    {"trail_interval", kWindow},
    {"trail_length", kWindow},
    {"velocity", kNotInStage},
    {"view", kFormer},
    {"watts", kEnergy},
};

constexpr NoEffect kSensorProperties[] = {
    {"color", kWindow},
    {"color_rgba", kWindow},
    {"view", kFormer},
};

std::string_view FindReason(const NoEffect* begin, const NoEffect* end, const std::string& name) {
  const NoEffect* found = std::find_if(begin, end, [&](const NoEffect& entry) { return entry.name == name; });
  return found == end ? std::string_view{} : found->reason;
}

}  // namespace

const TypeDefaults* FindType(std::string_view type) {
  const TypeDefaults* found =
      std::find_if(std::begin(kTypes), std::end(kTypes), [&](const TypeDefaults& entry) { return entry.type == type; });
  return found == std::end(kTypes) ? nullptr : found;
}

std::string UnknownTypeMessage(const std::string& type) {
  const bool former = std::find(std::begin(kFormerTypes), std::end(kFormerTypes), type) != std::end(kFormerTypes);
  std::string message = "found model type " + Quoted(type) + (former ? ", which Stage 4 no longer has" : "") +
                        ", expected the name of a define, or one of";
  for (const TypeDefaults& known : kTypes) message += " " + std::string(known.type);
  return message;
}

void WarnOfUnused(PropertyReader& reader, std::string_view kind) {
  const TypeDefaults* type = FindType(kind);
  for (const Property* property : reader.Unused()) {
    std::string_view reason;
    if (kind == "world") {
      reason = FindReason(std::begin(kWorldProperties), std::end(kWorldProperties), property->name);
    } else if (kind == "sensor") {
      reason = FindReason(std::begin(kSensorProperties), std::end(kSensorProperties), property->name);
    } else if (type != nullptr) {
      reason = FindReason(std::begin(kModelProperties), std::end(kModelProperties), property->name);
    }
    const std::string name = "property " + Quoted(property->name) + " has no effect";
    if (!reason.empty()) {
      reader.diagnostics().Warn(property->where, name + ": " + std::string(reason));
    } else if (type != nullptr && !type->is_simulated) {
      reader.diagnostics().Warn(property->where, name + ": '" + std::string(kind) + "' models are not simulated yet");
    } else {
      reader.diagnostics().Warn(property->where, name + " in a '" + std::string(kind) + "'");
    }
  }
}

}  // namespace troupe
