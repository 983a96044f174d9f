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

// Today's names of what older versions of Stage had.
constexpr std::string_view kRange = "it is 'range [min max]' today";
constexpr std::string_view kSensors = "the rays of a 'ranger' are in 'sensor ( ... )' today";

constexpr NoEffect kModelProperties[] = {
    {"alwayson", "a sensor is on while it has a reader"},
    {"blob_return", kNotInStage},
    {"debug", kNotInStage},
    {"event_queue", kNotInStage},
    {"friction", kNotInStage},
    {"gui_grid", kWindow},
    {"gui_move", kWindow},
    {"gui_outline", kWindow},
    {"laser_return", "it is 'ranger_return' today"},
    {"map_resolution", kNotInStage},
    {"say", kWindow},
    {"shape", "only older versions of Stage knew it; a body is made of 'block ( ... )' or a 'bitmap' today"},
    {"sonar_return", "it is 'ranger_return' today"},
    {"trail_interval", kWindow},
    {"trail_length", kWindow},
    {"velocity", kNotInStage},
    {"bitmap_resolution", kFormer},
    {"blobfinder_return", "it is 'blob_return' in Stage 4, where it has no effect either"},
    {"corrupt", "'localization' and 'odom_error' say how well a robot knows its pose today"},
    {"fiducial_id", "it is 'fiducial_return' today"},
    {"gui_boundary", "it is 'boundary' today"},
    {"image_filename", "it is 'bitmap' today"},
    {"interval", "it is 'update_interval' today"},
    {"map_filename", "it is 'bitmap' today"},
    {"obstacle", "it is 'obstacle_return' today"},
    {"odometry", "it is 'localization \"odom\"' today"},
    {"polygons", "a body is made of 'block ( ... )' today"},
    {"polygon", "a body is made of 'block ( ... )' today"},
    {"puck_return", "it is 'gripper_return' today"},
    {"rects", "a body is made of 'block ( ... )' today"},
    {"rect", "a body is made of 'block ( ... )' today"},
    {"scale", "'size' says how large the body is today"},
    {"steer", "it is 'drive' today"},
    {"vision_return", "it is 'blob_return' in Stage 4, where it has no effect either"},
    {"view", kFormer},
};

constexpr NoEffect kSensorProperties[] = {
    {"angle", "it is 'fov' today"},         {"color", kWindow},      {"color_rgba", kWindow},
    {"laser_sample_skip", kFormer},         {"range_max", kRange},   {"range_min", kRange},
    {"ray_count", "it is 'samples' today"}, {"resolution", kFormer}, {"view", kFormer},
};

constexpr NoEffect kBlobfinderProperties[] = {
    {"channel_count", "it is 'colors_count' today"},
    {"channels", "they are 'colors' today"},
    {"channels_count", "it is 'colors_count' today"},
    {"range_max", "it is 'range' today"},
};

constexpr NoEffect kFiducialProperties[] = {
    {"max_range_anon", "it is 'range_max' today"},
    {"max_range_id", "it is 'range_max_id' today"},
    {"range", "it is 'range_max' today"},
};

// Of a ranger itself.
constexpr NoEffect kRangerProperties[] = {
    {"fov", kSensors},
    {"range", kSensors},
    {"range_max", "it is 'range [min max]' of a 'sensor ( ... )' today"},
    {"range_min", "it is 'range [min max]' of a 'sensor ( ... )' today"},
    {"samples", kSensors},
    {"laser_sample_skip", kFormer},
    {"scount", kSensors},
    {"spose", "it is 'pose' of a 'sensor ( ... )' today"},
    {"srange", "it is 'range' of a 'sensor ( ... )' today"},
    {"ssize", "it is 'size' of a 'sensor ( ... )' today"},
    {"sview", "it is 'range', 'fov' and 'samples' of a 'sensor ( ... )' today"},
    {"view", "it is 'range' and 'fov' of a 'sensor ( ... )' today"},
};

// Without the index of a property such as spose[3].
std::string WithoutIndex(const std::string& name) {
  return name.substr(0, name.find('['));
}

std::string_view FindReason(std::span<const NoEffect> reasons, const std::string& name) {
  const auto found = std::find_if(reasons.begin(), reasons.end(),
                                  [&](const NoEffect& entry) { return entry.name == WithoutIndex(name); });
  return found == reasons.end() ? std::string_view{} : found->reason;
}

// `otherwise` follows the name of a property without a reason in the list.
void WarnOfUnused(PropertyReader& reader, std::span<const NoEffect> reasons, const std::string& otherwise,
                  bool in_sensor = false, std::span<const NoEffect> first_reasons = {}) {
  for (const Property* property : reader.Unused()) {
    std::string_view reason = FindReason(first_reasons, property->name);
    if (reason.empty()) reason = FindReason(reasons, property->name);
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
  std::span<const NoEffect> of_type;
  if (type == "blobfinder") of_type = kBlobfinderProperties;
  if (type == "fiducial") of_type = kFiducialProperties;
  if (type == "ranger") of_type = kRangerProperties;
  WarnOfUnused(reader, kModelProperties, " in a '" + std::string(type) + "'", false, of_type);
}

}  // namespace troupe
