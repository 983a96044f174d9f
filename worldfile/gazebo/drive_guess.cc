#include "worldfile/gazebo/drive_guess.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "worldfile/gazebo/xml_values.h"

namespace troupe {
namespace {

constexpr double kNearGround = 0.03;  // m, of wheels above the robot's lowest point

struct PluginWord {
  std::string_view word;  // in a plugin's file or name, in lower case
  const char* drive;
};
constexpr PluginWord kDrivePlugins[] = {
    {"ackermann", "car"},     {"mecanum", "omni"},    {"planar_move", "omni"},      {"planarmove", "omni"},
    {"planar-move", "omni"},  {"omni_drive", "omni"}, {"velocity-control", "omni"}, {"velocitycontrol", "omni"},
    {"diff-drive", "diff"},   {"diffdrive", "diff"},  {"diff_drive", "diff"},       {"differential", "diff"},
    {"skid_steer", "diff"},   {"skid-steer", "diff"}, {"skidsteer", "diff"},        {"tricycle", "car"},
    {"create_drive", "diff"}, {"kobuki", "diff"},
};

const PluginPart* DrivePlugin(const RigidModel& model, std::string& drive) {
  for (const PluginPart& plugin : model.plugins) {
    for (const PluginWord& known : kDrivePlugins) {
      if (plugin.name.find(known.word) == std::string::npos) continue;
      drive = known.drive;
      return &plugin;
    }
  }
  return nullptr;
}

std::optional<double> Positive(double value) {
  return value > 0.0 && value < 1e3 ? std::optional(value) : std::nullopt;
}

struct Wheel {
  const JointPart* joint = nullptr;
  const JointPart* steering = nullptr;
  double radius = 0.0;
};

bool Contains(const std::string& text, const char* word) {
  std::string lower = text;
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower.find(word) != std::string::npos;
}

std::vector<Wheel> WheelsOf(const RigidModel& model, double lowest) {
  std::map<std::string, const LinkPart*> links;
  for (const LinkPart& link : model.links) links.emplace(link.name, &link);
  std::map<std::string, const JointPart*> above;  // by child
  for (const JointPart& joint : model.joints) above.emplace(joint.child, &joint);
  std::vector<Wheel> wheels;
  for (const JointPart& joint : model.joints) {
    if (joint.type != "continuous" || std::fabs(joint.axis.z) > 0.3) continue;
    const auto link = links.find(joint.child);
    if (link == links.end() || Contains(joint.name + joint.child, "caster")) continue;
    const std::optional<double> low = LowestOf(*link->second);
    if (!low || *low > lowest + kNearGround) continue;
    Wheel wheel{&joint, nullptr, joint.T_MJ.translation().z - *low};
    bool is_caster = false;
    std::size_t length = 0;
    for (auto at = above.find(joint.parent); at != above.end() && ++length < model.joints.size();
         at = above.find(at->second->parent)) {
      const JointPart& upper = *at->second;
      if (std::fabs(upper.axis.z) < 0.7) continue;
      if (upper.type == "continuous") is_caster = true;
      if (upper.type == "revolute") wheel.steering = &upper;
    }
    if (!is_caster) wheels.push_back(wheel);
  }
  return wheels;
}

// Whether the axes of three wheels or more are in three directions.
bool AreOmni(const std::vector<Wheel>& wheels) {
  if (wheels.size() < 3) return false;
  std::size_t directions = 0;
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Vec3& a = wheels[i].joint->axis;
    const bool is_new = std::none_of(wheels.begin(), wheels.begin() + static_cast<std::ptrdiff_t>(i),
                                     [&](const Wheel& other) { return std::fabs(Dot(a, other.joint->axis)) > 0.95; });
    directions += is_new ? 1 : 0;
  }
  return directions >= 3;
}

void ReadLimits(const PluginPart& plugin, Diagnostics& diagnostics, DriveGuess& guess) {
  const XmlValues values(plugin.file, diagnostics);
  const XmlElement& e = plugin.element;
  guess.max_speed = Positive(values.FirstNumber(e, {"max_linear_velocity", "max_velocity", "max_speed"}, 0.0));
  guess.max_acceleration =
      Positive(values.FirstNumber(e, {"max_linear_acceleration", "max_acceleration", "max_accel"}, 0.0));
  guess.max_turn_rate = Positive(values.FirstNumber(e, {"max_angular_velocity"}, 0.0));
  guess.max_turn_acceleration = Positive(values.FirstNumber(e, {"max_angular_acceleration"}, 0.0));
  if (guess.type == "car") {
    guess.wheelbase = std::max(0.0, values.FirstNumber(e, {"wheel_base", "wheelbase"}, 0.0));
    if (const auto steer = Positive(values.FirstNumber(e, {"steering_limit", "max_steer"}, 0.0))) {
      guess.max_turn_rate = steer;
    }
  }
}

}  // namespace

bool HasDrivePlugin(const RigidModel& model) {
  std::string drive;
  return DrivePlugin(model, drive) != nullptr;
}

std::optional<double> LowestOf(const LinkPart& link) {
  std::optional<double> lowest;
  for (const SolidPart& part : link.collisions) {
    const double low = LowestPoint(part.solid, link.T_ML * part.T_LS);
    lowest = std::min(lowest.value_or(low), low);
  }
  return lowest;
}

DriveGuess GuessDrive(const RigidModel& model, double lowest, Diagnostics& diagnostics) {
  DriveGuess guess;
  const std::vector<Wheel> wheels = WheelsOf(model, lowest);
  if (const PluginPart* const plugin = DrivePlugin(model, guess.type)) {
    guess.reason = "the plugin " + XmlValues::Attribute(plugin->element, "filename");
    ReadLimits(*plugin, diagnostics, guess);
  } else if (!wheels.empty()) {
    const bool is_named_omni = std::any_of(wheels.begin(), wheels.end(), [](const Wheel& wheel) {
      return Contains(wheel.joint->name + wheel.joint->child, "mecanum") ||
             Contains(wheel.joint->name + wheel.joint->child, "omni");
    });
    const bool is_steered =
        std::any_of(wheels.begin(), wheels.end(), [](const Wheel& wheel) { return wheel.steering != nullptr; });
    guess.type = is_named_omni || AreOmni(wheels) || Contains(model.name, "mecanum") ? "omni"
                 : is_steered                                                        ? "car"
                                                                                     : "diff";
    guess.reason = CountText(wheels.size(), "wheel");
  }
  if (guess.type == "car" && !(guess.wheelbase > 0.0) && !wheels.empty()) {
    double front = -kMaxMagnitude;
    double back = kMaxMagnitude;
    for (const Wheel& wheel : wheels) {
      const double x = wheel.joint->T_MJ.translation().x;
      front = std::max(front, x);
      back = std::min(back, x);
      if (wheel.steering != nullptr && !guess.max_turn_rate) guess.max_turn_rate = Positive(wheel.steering->upper);
    }
    guess.wheelbase = front - back;
  }
  if (!guess.max_speed) {
    for (const Wheel& wheel : wheels) {
      const double speed = wheel.joint->velocity * wheel.radius;
      // A limit that no robot of this kind reaches is none.
      if (speed > 0.05 && speed < 10.0) guess.max_speed = std::min(guess.max_speed.value_or(speed), speed);
    }
  }
  return guess;
}

}  // namespace troupe
