#include "worldfile/models/types/property_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "common/geometry/limits.h"
#include "troupe/deterministic_math.h"
#include "troupe/door_description.h"
#include "troupe/sensor_description.h"
#include "worldfile/models/types/field_properties.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/stage/part_draft.h"

namespace troupe {
namespace {

struct TableRow {
  std::string_view type, name, form, unit, initial, help;  // of PropertyHelp
};

constexpr TableRow kRows[] = {
    {"world", "name", "text", "", "", "Shown in summaries; without it the file's name"},
    {"world", "interval_sim", "number", "ms", "100", "Length of a tick"},
    {"world", "gravity", "number", "m/s2", "9.81", "0: released objects stay in the air"},
    {"world", "quit_time", "number", "s", "0", "The run ends after this simulated time; 0: it does not"},
    {"world", "unit_length", "m|cm|mm", "", "\"m\"", "Of all lengths in the file and its includes"},
    {"world", "unit_angle", "degrees|radians", "", "\"degrees\"", "Of all angles in the file and its includes"},

    {"*", "name", "text", "", "", "Unique; without it TYPE:N"},
    {"*", "pose", "x y z heading", "m, deg", "[0 0 0 0]", "In the parent's frame, or the world's"},
    {"*", "size", "x y z", "m", "[0.4 0.4 1]", "The body is stretched to it; a size of 0 leaves no body"},
    {"*", "origin", "x y z heading", "m, deg", "[0 0 0 0]", "The body's centre in the model's frame"},
    {"*", "stack_children", "flag", "", "1", "Children are on top: their z counts from the model's height"},
    {"*", "noblocks", "flag", "", "0", "Leaves the box out"},
    {"*", "boundary", "flag", "", "0", "Four thin walls around the box or the bitmap"},
    {"*", "bitmap", "text", "", "", "An image (PNG, JPEG, BMP, PGM) whose dark pixels are the body"},
    {"*", "map_yaml", "text", "", "", "A map of ROS's map_server as the body"},
    {"*", "map_cells", "text", "", "", "A map of cells (.map of movingai, .pogema) as the body"},
    {"*", "model_file", "text", "", "",
     "A model or robot of SDF or URDF, in whose place the other properties count first"},
    {"*", "cell_size", "number", "m", "1", "The side of a cell of map_cells"},
    {"*", "obstacle_return", "flag", "", "1", "Collides"},
    {"*", "ranger_return", "number", "", "1", "Intensity that a ranger reads; below 0 it is invisible to rangers"},
    {"*", "gripper_return", "flag", "", "0", "An object: may be gripped, moved and dropped"},
    {"*", "fiducial_return", "number", "", "0", "The id that fiducial finders read; 0: they do not find it"},
    {"*", "fiducial_key", "number", "", "0", "Only finders with the same key find it"},
    {"*", "color", "color", "", "\"red\"", "A name of X11's rgb.txt, or \"random\""},
    {"*", "color_rgba", "r g b a", "0 to 1", "", "Without color"},
    {"*", "gui_nose", "flag", "", "0", "Pictures show the front"},
    {"*", "joules", "number", "J", "", "Makes a store of energy; below 0 an endless one"},
    {"*", "joules_capacity", "number", "J", "", "The size of the store, full without joules"},
    {"*", "kjoules", "number", "kJ", "", "In place of joules"},
    {"*", "kjoules_capacity", "number", "kJ", "", "In place of joules_capacity"},
    {"*", "watts", "number", "W", "0", "That the model consumes"},
    {"*", "mass", "number", "kg", "0", "A robot consumes 10 W per kg and m/s or rad/s"},
    {"*", "give_watts", "number", "W", "0", "That it gives to models that touch it"},
    {"*", "take_watts", "number", "W", "0", "That it takes from models that it touches"},

    {"position", "wheelbase", "number", "m", "1", "Of a car"},
    {"position", "velocity_bounds", "xmin xmax ymin ymax zmin zmax amin amax", "m/s, deg/s", "[-1 1 -1 1 -1 1 -90 90]",
     "Each pair includes 0"},
    {"position", "acceleration_bounds", "xmin xmax ymin ymax zmin zmax amin amax", "m/s2, deg/s2",
     "[-1 1 -1 1 -1 1 -90 90]", "Each pair includes 0"},
    {"position", "localization_origin", "x y z heading", "m, deg", "", "Odometry reports poses relative to it"},
    {"position", "odom_error", "x y z heading", "proportion", "", "A motion d is read as d (1 + error)"},
    {"position", "ctrl", "controller", "", "", "What drives the robot, with its parameters"},

    {"ranger", "update_interval", "number", "ms", "100", "The period of its measurements"},
    {"ranger", "frame", "text", "", "", "Of its messages in ROS; without it one with the name of its topic"},
    {"camera", "frame", "text", "", "", "Of its messages in ROS; without it one with the name of its topic"},
    {"imu", "frame", "text", "", "", "Of its messages in ROS; without it one with the name of its topic"},
    {"fiducial", "frame", "text", "", "", "Of its messages in ROS; without it one with the name of its topic"},
    {"blobfinder", "frame", "text", "", "", "Of its messages in ROS; without it one with the name of its topic"},
    {"sensor", "pose", "x y z heading", "m, deg", "[0 0 0 0]", "In the ranger's body"},
    {"sensor", "size", "x y z", "m", "[0.02 0.02 0.02]", "Half of z raises the rays"},
    {"sensor", "range", "min max", "m", "[0 5]", "Readings are within it"},
    {"sensor", "fov", "number", "deg", "", "The fan spans half of it to both sides"},
    {"sensor", "samples", "number", "", "1", "Number of rays"},
    {"sensor", "planes", "number", "", "1", "Planes of rays, one above another"},
    {"sensor", "vertical_fov", "number", "deg", "30", "Of several planes, from the lowest to the highest"},
    {"sensor", "elevations", "numbers", "deg", "", "The elevation of each plane"},
    {"sensor", "noise", "variance proportional angle", "m2, proportion", "", "Added to a hit"},

    {"fiducial", "range_min", "number", "m", "0", "From the finder to the model"},
    {"fiducial", "range_max", "number", "m", "8", "From the finder to the model"},
    {"fiducial", "range_max_id", "number", "m", "5", "Beyond it the id reads 0"},
    {"fiducial", "fov", "number", "deg", "180", "Of the finder"},
    {"fiducial", "ignore_zloc", "flag", "", "0", "Also finds what is above or below its plane"},
    {"bumper", "bcount", "number", "", "0", "Number of strips"},
    {"bumper", "bpose", "x y z heading", "m, deg", "[0 0 0 0]", "bpose[i]: the middle of strip i"},
    {"bumper", "blength", "number", "m", "0", "Of all strips, or blength[i]"},
    {"blobfinder", "image", "width height", "pixels", "[80 60]", "Of the image"},
    {"blobfinder", "range", "number", "m", "12", "Of its sight"},
    {"blobfinder", "fov", "number", "deg", "60", "Of the width"},
    {"blobfinder", "pan", "number", "deg", "0", "To the left"},
    {"blobfinder", "colors_count", "number", "", "", "Of colors"},
    {"blobfinder", "colors", "texts", "", "", "The colours that it finds; without them all"},
    {"camera", "resolution", "width height", "pixels", "[32 32]", "Of the image"},
    {"camera", "range", "min max", "m", "[0.2 8]", "Of depths"},
    {"camera", "fov", "horizontal vertical", "deg", "[70 40]", "Of the image"},
    {"camera", "pantilt", "pan tilt", "deg", "[0 0]", "To the left, and up"},
    {"blinkenlight", "period", "number", "ms", "1000", "Of the light"},
    {"blinkenlight", "dutycycle", "number", "0 to 1", "1", "The share of each period in which it is on"},
    {"blinkenlight", "enabled", "flag", "", "1", "0: always off"},

    {"door", "swing", "number", "deg", "90", "By which hinged leaves turn, towards y"},
    {"door", "ratio", "number", "", "1", "Widths of the right and the left leaf"},
    {"lift", "floors", "texts", "", "", "The names of its floors"},
    {"lift", "heights", "numbers", "m", "", "Of the cabin's floor at each"},
    {"lift", "cabin_doors", "texts", "", "", "Doors that move with the cabin"},
    {"lift", "floor_doors", "texts", "", "", "Pairs: a floor, and a door that opens there"},
    {"actuator", "axis", "x y z", "", "", "A direction in the actuator's frame"},
    {"actuator", "max_speed", "number", "m/s, deg/s", "1", "To both sides"},
    {"actuator", "min_position", "number", "m, deg", "0", "Lower limit"},
    {"actuator", "max_position", "number", "m, deg", "1", "Upper limit"},
    {"actuator", "start_position", "number", "m, deg", "", "At the start"},
    {"gripper", "paddle_size", "x y z", "proportion", "[0.66 0.1 0.4]", "Length, thickness and height of a paddle"},
    {"gripper", "paddle_state", "texts", "", "[\"open\" \"down\"]", "\"open\" or \"closed\", \"up\" or \"down\""},
    {"gripper", "autosnatch", "flag", "", "0", "Closes by itself when a break beam is broken"},
    {"gripper", "min_height", "number", "m", "", "Of the paddles' underside above the robot's base, at 0 percent"},
    {"gripper", "max_height", "number", "m", "", "The same at 100 percent"},
    {"gripper", "paddle_speed", "number", "m/s", "", "Of each paddle"},
    {"gripper", "lift_speed", "number", "m/s", "", "Of the lift"},
    {"gripper", "vDistanceDivision", "number", "updates", "20", "Of the lift for its full travel"},
    {"gripper", "update_interval", "number", "ms", "100", "The length of an update"},
    {"gripper", "left_finger", "text", "", "", "An actuator of the gripper"},
    {"gripper", "right_finger", "text", "", "", "An actuator of the gripper"},
    {"gripper", "left_pad", "text", "", "", "The model of the left finger that touches"},
    {"gripper", "right_pad", "text", "", "", "The model of the right finger that touches"},
    {"gripper", "lift", "text", "", "", "The actuator that carries both fingers"},
};

// As files have it.
std::string UnitInFiles(const FieldInfo& field) {
  if (field.unit.empty()) return field.limits == FieldLimits{0.0, 1.0} ? "0 to 1" : "";
  if (field.unit.starts_with("rad")) return "deg" + std::string(field.unit.substr(3));
  if (field.unit == "byte/s") return "bytes/s";
  if (field.unit == "m/s^2") return "m/s2";
  return std::string(field.unit);
}

PropertyHelp HelpWith(std::string_view type, const FieldInfo& field, std::string form, std::string initial) {
  std::string help(field.documentation);
  if (!help.empty() && help.front() >= 'a' && help.front() <= 'z') {
    help.front() = static_cast<char>(help.front() - 'a' + 'A');
  }
  return {std::string(type),  std::string(field.name), std::move(form),
          UnitInFiles(field), std::move(initial),      std::move(help)};
}

// A choice of words; the first is the default.
template <typename Value>
PropertyHelp ChoiceOf(std::string_view type, std::string_view name, std::string_view help) {
  std::string words;
  for (const char* const word : StageWordsOf(Value())) words += (words.empty() ? "" : "|") + std::string(word);
  std::string first = '"' + std::string(StageWordOf(Value())) + '"';
  return {std::string(type), std::string(name), std::move(words), "", std::move(first), std::string(help)};
}

// Above the limit of a field that excludes its limit.
constexpr double kMinDistance = 1e-3;

}  // namespace

double ReadField(PropertyReader& reader, const FieldInfo& field, double otherwise) {
  const FieldLimits& limits = field.limits;
  if (field.unit.starts_with("rad")) return ReadAngle(reader, field.name, otherwise);
  if (field.unit == "m" && limits.min == 0.0 && !limits.has_max()) return ReadDistance(reader, field.name, otherwise);
  if (field.unit == "m" || field.unit == "m/s") {
    return std::clamp(reader.Length(field.name, otherwise), limits.min, limits.max);
  }
  return reader.Number(field.name, otherwise,
                       std::max(limits.is_min_excluded ? limits.min + kMinDistance : limits.min, -kMaxMagnitude),
                       std::min(limits.max, kMaxMagnitude));
}

std::int32_t ReadField(PropertyReader& reader, const FieldInfo& field, std::int32_t otherwise) {
  constexpr double kMax = 1e9;
  const auto min = static_cast<std::int64_t>(std::max(field.limits.min, -kMax));
  const auto max = static_cast<std::int64_t>(std::min(field.limits.max, kMax));
  return static_cast<std::int32_t>(reader.Integer(field.name, otherwise, min, max));
}

bool ReadField(PropertyReader& reader, const FieldInfo& field, bool otherwise) {
  return reader.Flag(field.name, otherwise);
}

PropertyHelp HelpOf(std::string_view type, const FieldInfo& field, double initial) {
  const bool is_angle = field.unit.starts_with("rad");
  return HelpWith(type, field, "number", fmt::format("{}", is_angle ? RadiansToDegrees(initial) : initial));
}

PropertyHelp HelpOf(std::string_view type, const FieldInfo& field, std::int32_t initial) {
  return HelpWith(type, field, "number", std::to_string(initial));
}

PropertyHelp HelpOf(std::string_view type, const FieldInfo& field, bool initial) {
  return HelpWith(type, field, "flag", initial ? "1" : "0");
}

const std::vector<PropertyHelp>& PropertyTable() {
  static const std::vector<PropertyHelp> table = [] {
    std::vector<PropertyHelp> rows;
    rows.push_back(ChoiceOf<DriveType>("position", "drive", "How it moves"));
    rows.push_back(
        ChoiceOf<LocalizationType>("position", "localization", "gps: it knows its pose; odom: it adds up its motion"));
    rows.push_back(ChoiceOf<DoorKind>("door", "kind", "How its leaves move"));
    rows.push_back(ChoiceOf<DoorSide>("door", "side", "Of the hinge of a single leaf, or to which it slides"));
    rows.push_back(ChoiceOf<JointType>("actuator", "type", "Shifts along the axis, or turns about the vertical"));
    for (const TableRow& row : kRows) {
      rows.push_back({std::string(row.type), std::string(row.name), std::string(row.form), std::string(row.unit),
                      std::string(row.initial), std::string(row.help)});
    }
    AppendFields<DoorDescription>("door", rows);
    AppendFields<LiftDescription>("lift", rows);
    AppendFields<RadioParameters>("radio", rows);
    AppendFields<ImuParameters>("imu", rows);
    return rows;
  }();
  return table;
}

}  // namespace troupe
