#include "worldfile/edit/written_model.h"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "common/base/json.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kLongLine = 110;  // bytes

// Stage's numbers may begin with a point or a plus.
std::string ScalarToJson(const Value::Scalar& scalar) {
  const auto* const number = std::get_if<Value::Number>(&scalar);
  if (number == nullptr) return JsonText(nlohmann::json(std::get<std::string>(scalar)));
  std::string text = number->text;
  if (text.starts_with('+')) text.erase(0, 1);
  if (text.starts_with('.')) text.insert(0, "0");
  if (text.starts_with("-.")) text.insert(1, "0");
  if (text.ends_with('.')) text.pop_back();
  // The spelling of the file where JSON allows it; else its value (Stage accepts "007" and "1.2.3").
  return nlohmann::json::accept(text) ? text : PlainNumber(number->value, 6);
}

std::string Joined(const Value& value, const char* separator, std::string (*write)(const Value::Scalar&)) {
  if (const auto* number = std::get_if<Value::Number>(&value.content)) return write(*number);
  if (const auto* text = std::get_if<std::string>(&value.content)) return write(*text);
  std::string tuple = "[";
  for (const Value::Scalar& scalar : std::get<Value::Tuple>(value.content)) {
    if (tuple.size() > 1) tuple += separator;
    tuple += write(scalar);
  }
  return tuple + "]";
}

std::string BodyLines(const WrittenModel& model, const std::string& indent, const std::string& end_of_line) {
  std::string text = indent + "(" + end_of_line;
  for (const auto& [name, value] : model.properties) {
    text.append(indent).append("  ").append(name).append(" ").append(ToStage(value)).append(end_of_line);
  }
  for (const WrittenModel& child : model.children) {
    text.append(indent).append("  ").append(ToStage(child, indent + "  ", end_of_line)).append(end_of_line);
  }
  return text + indent + ")";
}

constexpr PropertyHelp kTable[] = {
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

    {"position", "drive", "diff|omni|car", "", "\"diff\"", "How it moves"},
    {"position", "wheelbase", "number", "m", "1", "Of a car"},
    {"position", "velocity_bounds", "xmin xmax ymin ymax zmin zmax amin amax", "m/s, deg/s", "[-1 1 -1 1 -1 1 -90 90]",
     "Each pair includes 0"},
    {"position", "acceleration_bounds", "xmin xmax ymin ymax zmin zmax amin amax", "m/s2, deg/s2",
     "[-1 1 -1 1 -1 1 -90 90]", "Each pair includes 0"},
    {"position", "localization", "gps|odom", "", "\"gps\"", "gps: it knows its pose; odom: it adds up its motion"},
    {"position", "localization_origin", "x y z heading", "m, deg", "", "Odometry reports poses relative to it"},
    {"position", "odom_error", "x y z heading", "proportion", "", "A motion d is read as d (1 + error)"},
    {"position", "ctrl", "controller", "", "", "What drives the robot, with its parameters"},

    {"ranger", "update_interval", "number", "ms", "100", "The period of its measurements"},
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
    {"radio", "channel", "number", "", "0", "Radios of other channels do not hear it"},
    {"radio", "range", "number", "m", "10", "Of its messages, without walls"},
    {"radio", "bandwidth", "number", "bytes/s", "10000", "That it may send"},
    {"radio", "delay", "number", "s", "0", "Until its messages arrive"},
    {"radio", "loss", "number", "0 to 1", "0", "The probability that a receiver loses a message"},
    {"radio", "range_loss", "number", "0 to 1", "0", "Another one, at range; in proportion to the distance"},
    {"radio", "power", "number", "dBm", "20", "Of its messages at 1 m"},
    {"radio", "path_loss_exponent", "number", "", "2", "How fast the strength falls; 2 as in free space"},
    {"radio", "wall_loss", "number", "dB", "10", "Lost at each wall between the antennas"},
    {"radio", "body_loss", "number", "dB", "3", "Lost at each robot or object between them"},
    {"radio", "range_and_bearing", "flag", "", "0", "It measures where the senders are"},
    {"radio", "range_noise", "number", "m", "0", "Standard deviation of that"},
    {"radio", "bearing_noise", "number", "deg", "0", "Standard deviation of that"},
    {"imu", "heading_noise", "number", "deg", "0", "Standard deviation of the heading"},
    {"imu", "gyro_noise", "number", "deg/s", "0", "Standard deviation of the yaw rate"},
    {"imu", "gyro_bias", "number", "deg/s", "0", "Standard deviation of its constant error"},
    {"imu", "acceleration_noise", "number", "m/s2", "0", "Standard deviation of the force along each axis"},
    {"imu", "acceleration_bias", "number", "m/s2", "0", "Standard deviation of its constant error"},
    {"blinkenlight", "period", "number", "ms", "1000", "Of the light"},
    {"blinkenlight", "dutycycle", "number", "0 to 1", "1", "The share of each period in which it is on"},
    {"blinkenlight", "enabled", "flag", "", "1", "0: always off"},

    {"door", "kind", "hinged|double_hinged|sliding|double_sliding", "", "\"hinged\"", "How its leaves move"},
    {"door", "side", "right|left", "", "\"right\"", "Of the hinge of a single leaf, or to which it slides"},
    {"door", "swing", "number", "deg", "90", "By which hinged leaves turn, towards y"},
    {"door", "ratio", "number", "", "1", "Widths of the right and the left leaf"},
    {"door", "seconds", "number", "s", "3", "From closed to open"},
    {"door", "reach", "number", "m", "0", "It opens for robots that are nearer; 0: for none"},
    {"door", "opening", "number", "0 to 1", "0", "At the start: 0 is closed, 1 open"},
    {"door", "operated", "flag", "", "1", "0: requests have no effect"},
    {"lift", "floors", "texts", "", "", "The names of its floors"},
    {"lift", "heights", "numbers", "m", "", "Of the cabin's floor at each"},
    {"lift", "speed", "number", "m/s", "1", "Of the cabin"},
    {"lift", "cabin_doors", "texts", "", "", "Doors that move with the cabin"},
    {"lift", "floor_doors", "texts", "", "", "Pairs: a floor, and a door that opens there"},
    {"actuator", "type", "linear|rotational", "", "\"linear\"", "Shifts along the axis, or turns about the vertical"},
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

}  // namespace

Value::Number RoundedNumber(double value, int decimals) {
  std::string text = PlainNumber(value, decimals);
  return {std::strtod(text.c_str(), nullptr), std::move(text)};
}

Value Number(double value, int decimals) {
  return {RoundedNumber(value, decimals), {}};
}

Value Text(std::string text) {
  return {std::move(text), {}};
}

Value Tuple(const std::vector<double>& numbers, int decimals) {
  Value::Tuple tuple;
  for (const double number : numbers) tuple.emplace_back(RoundedNumber(number, decimals));
  return {std::move(tuple), {}};
}

Result<Value> ReadValueText(const std::string& text) {
  const Result<StageTree> tree = ParseStage("value " + text, "");
  const bool is_one = tree.ok() && tree.value().statements.size() == 1 &&
                      tree.value().statements[0].kind == StatementKind::kProperty &&
                      text.find_first_of("#\r\n") == std::string::npos;
  if (!is_one) {
    return Error{{}, "found " + Quoted(text) + ", expected a number, a text in double quotes, or several in [ ]"};
  }
  return ValueOf(tree.value(), tree.value().statements[0]);
}

std::string ToStage(const Value::Scalar& scalar) {
  if (const auto* number = std::get_if<Value::Number>(&scalar)) return number->text;
  return '"' + std::get<std::string>(scalar) + '"';
}

std::string ToStage(const Value& value) {
  return Joined(value, " ", [](const Value::Scalar& scalar) { return ToStage(scalar); });
}

std::string ToJson(const Value& value) {
  return Joined(value, ", ", ScalarToJson);
}

WrittenModel WrittenBlock(const std::vector<Vec2>& outline, double z_min, double z_max) {
  WrittenModel block{"block", {}, {}};
  block.Set("points", Number(static_cast<double>(outline.size())));
  for (std::size_t i = 0; i < outline.size(); ++i) {
    block.Set("point[" + std::to_string(i) + "]", Tuple({outline[i].x(), outline[i].y()}));
  }
  block.Set("z", Tuple({z_min, z_max}));
  return block;
}

std::string ToStage(const WrittenModel& model, const std::string& indent, const std::string& end_of_line) {
  std::string line = model.type + "(";
  for (const auto& [name, value] : model.properties) line += " " + name + " " + ToStage(value);
  line += " )";
  const bool is_short = model.children.empty() && indent.size() + line.size() <= kLongLine;
  // Blocks are one line each, however long: the corners are one value of many parts.
  if (is_short || model.type == "block") return line;
  return model.type + end_of_line + BodyLines(model, indent, end_of_line);
}

std::string ToDefine(const WrittenModel& model, const std::string& name, const std::string& end_of_line) {
  return "define " + name + " " + model.type + end_of_line + BodyLines(model, "", end_of_line);
}

std::string ToScenarioEntry(const WrittenModel& model) {
  std::string text = "{";
  const auto add = [&](const std::string& key, const std::string& value) {
    text += (text.size() > 1 ? ", " : "") + ScalarToJson(key) + ": " + value;
  };
  std::string properties;
  for (const auto& [name, value] : model.properties) {
    if (name == "name") add(name, ToJson(value));
  }
  add("model", ScalarToJson(model.type));
  for (const auto& [name, value] : model.properties) {
    if (name == "pose" && model.type != "sensor") add(name, ToJson(value));
    if (name == "name" || (name == "pose" && model.type != "sensor")) continue;
    properties += (properties.empty() ? "" : ", ") + ScalarToJson(name) + ": " + ToJson(value);
  }
  if (!properties.empty()) add("properties", "{" + properties + "}");
  std::string children;
  for (const WrittenModel& child : model.children) children += (children.empty() ? "" : ", ") + ToScenarioEntry(child);
  if (!children.empty()) add("children", "[" + children + "]");
  return text + "}";
}

std::span<const PropertyHelp> PropertyTable() {
  return kTable;
}

}  // namespace troupe
