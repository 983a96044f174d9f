// The properties of a `gripper`. Stage has no speeds but a number of updates for the full travel, and an update of 100
// ms: these are turned into m/s here, so that a world moves alike at any length of a tick.
#include <algorithm>
#include <cmath>

#include "common/geometry/limits.h"
#include "worldfile/models/types/gripper_builder.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Stage moves paddles and lift by a twentieth of their travel at each update.
constexpr double kStageUpdates = 20.0;

std::optional<PartName> ReadPart(PropertyReader& reader, const std::string& property) {
  if (reader.node().Find(property) == nullptr) return std::nullopt;
  PartName part{reader.Text(property, ""), reader.Where(property)};
  if (part.name.empty()) {
    reader.diagnostics().Fail(part.where, "found an empty name for " + Quoted(property) + ", expected that of a model");
  }
  return part;
}

// In m/s.
double ReadSpeed(PropertyReader& reader, std::string_view name, double otherwise) {
  if (reader.node().Find(name) == nullptr) return otherwise;
  return reader.Number(name, 0.0, 0.0) * reader.units().length;
}

double Speed(double way, double seconds) {
  return std::min(way / seconds, kMaxMagnitude);
}

Size ReadPaddleSize(PropertyReader& reader, const Size& size) {
  if (!(size.x > 0.0 && size.y > 0.0 && size.z > 0.0)) {
    reader.diagnostics().Fail(reader.Where("size"), "found a gripper without pads: its size is 0");
  }
  std::vector<double> part = reader.Numbers("paddle_size", 3).value_or(std::vector<double>{0.66, 0.1, 0.4});
  const bool is_good =
      part[0] > 0.0 && part[0] <= 1.0 && part[1] > 0.0 && part[1] < 0.5 && part[2] > 0.0 && part[2] <= 1.0;
  if (!is_good) {
    reader.diagnostics().Warn(
        reader.Where("paddle_size"),
        "found paddle_size [" + NumberText(part[0]) + " " + NumberText(part[1]) + " " + NumberText(part[2]) +
            "], expected proportions of the gripper's size, above 0, up to [1 0.5 1]; the nearest ones are used");
    constexpr double kThinnest = 0.01;
    part = {std::clamp(part[0], kThinnest, 1.0), std::clamp(part[1], kThinnest, 0.45),
            std::clamp(part[2], kThinnest, 1.0)};
  }
  return {part[0] * size.x, part[1] * size.y, part[2] * size.z};
}

struct PaddleState {
  bool closed = false;
  bool up = false;
};

// In any case of letters; other words mean the first of each.
PaddleState ReadPaddleState(PropertyReader& reader) {
  const Property* property = reader.Use("paddle_state");
  if (property == nullptr) return {};
  const std::vector<std::string> words = reader.Texts("paddle_state");
  const auto is = [&words](std::size_t i, std::string_view word) {
    return i < words.size() && EqualInAnyCase(words[i], word);
  };
  const PaddleState state{is(0, "closed"), is(1, "up")};
  const std::string fingers = state.closed ? "closed" : "open";
  const std::string lift = state.up ? "up" : "down";
  if (words == std::vector<std::string>{fingers, lift}) return state;
  std::string found;
  for (const std::string& word : words) found += (found.empty() ? "" : " ") + Quoted(word);
  reader.WarnOfValue(*property, "[" + found + "]", "[\"open\" or \"closed\" \"up\" or \"down\"]",
                     "[\"" + fingers + "\" \"" + lift + "\"]");
  return state;
}

// In m: the underside of the paddles above the gripper. The file's heights are above the robot's base. Nothing after an
// error.
std::optional<Interval> ReadLiftRange(PropertyReader& reader, double highest_inside, double height) {
  const auto min = reader.Numbers("min_height", 1);
  const auto max = reader.Numbers("max_height", 1);
  const double unit = reader.units().length;
  const double lowest = min ? min->front() * unit - height : 0.0;
  const double highest = max ? max->front() * unit - height : std::max(lowest, highest_inside);
  if (lowest > highest) {
    const double found = min ? min->front() : height / unit;
    reader.diagnostics().Fail(reader.Where("max_height"), "found a 'max_height' of " + NumberText(max->front()) +
                                                              " below the lowest height, " + NumberText(found) +
                                                              ", expected at least that");
    return std::nullopt;
  }
  if (std::max(std::fabs(lowest), std::fabs(highest)) > kMaxMagnitude) {
    reader.diagnostics().Fail(reader.Where(min ? "min_height" : "max_height"),
                              "found a height beyond 1000 km from the gripper, expected it nearer");
    return std::nullopt;
  }
  return Interval{lowest, highest};
}

// In m/s.
double ReadLiftSpeed(PropertyReader& reader, const Interval& range, double update_seconds) {
  if (reader.node().Find("lift_speed") != nullptr) {
    const double speed = ReadSpeed(reader, "lift_speed", 0.0);
    if (const Property* unused = reader.Use("vDistanceDivision")) {
      reader.diagnostics().Warn(unused->where, "property 'vDistanceDivision' has no effect beside 'lift_speed'");
    }
    return speed;
  }
  const double updates = reader.Number("vDistanceDivision", kStageUpdates, 1.0);
  return Speed(range.max - range.min, updates * update_seconds);
}

PaddleSettings ReadPaddles(PropertyReader& reader, const Size& size, double height, bool has_lift) {
  PaddleSettings paddles;
  paddles.size = ReadPaddleSize(reader, size);
  paddles.travel = 0.5 * size.y - paddles.size.y;
  const PaddleState state = ReadPaddleState(reader);
  paddles.closed = state.closed;
  paddles.up = state.up;
  const double update_seconds = reader.Number("update_interval", 100.0, 1.0, 1e9) * 1e-3;
  paddles.speed = ReadSpeed(reader, "paddle_speed", Speed(paddles.travel, kStageUpdates * update_seconds));
  if (has_lift) paddles.height = ReadLiftRange(reader, size.z - paddles.size.z, height);
  if (paddles.height) paddles.lift_speed = ReadLiftSpeed(reader, *paddles.height, update_seconds);
  return paddles;
}

}  // namespace

GripperSettings ReadGripper(PropertyReader& reader, const Size& size, double height) {
  GripperSettings gripper;
  gripper.autosnatch = reader.Flag("autosnatch", false);
  gripper.left_finger = ReadPart(reader, "left_finger");
  gripper.right_finger = ReadPart(reader, "right_finger");
  gripper.lift = ReadPart(reader, "lift");
  if (gripper.left_finger.has_value() != gripper.right_finger.has_value()) {
    const std::string given = gripper.left_finger ? "left_finger" : "right_finger";
    const std::string missing = gripper.left_finger ? "right_finger" : "left_finger";
    reader.diagnostics().Fail(reader.Where(given),
                              "found " + Quoted(given) + " without " + Quoted(missing) + ", expected both or neither");
  }
  if (gripper.left_finger) {
    gripper.left_pad = ReadPart(reader, "left_pad");
    gripper.right_pad = ReadPart(reader, "right_pad");
  } else {
    gripper.paddles = ReadPaddles(reader, size, height, !gripper.lift);
  }
  return gripper;
}

Size BackSize(const Size& size, const PaddleSettings& paddles) {
  return {size.x - paddles.size.x, size.y, size.z};
}

Pose BackPose(const Pose& X_MD, const PaddleSettings& paddles) {
  return X_MD * Pose{-0.5 * paddles.size.x, 0.0, 0.0, 0.0};
}

}  // namespace troupe
