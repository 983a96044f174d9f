#include "ros/messages/text_messages.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>

#include "common/base/json.h"
#include "common/base/text.h"

namespace troupe::ros {
namespace {

const char* FingersOf(const GripperMotion& motion, double largest) {
  if (motion.opening_rate > 0.0) return "opening";
  if (motion.opening_rate < 0.0) return "closing";
  return motion.opening >= largest ? "open" : "closed";
}

// Twice the bytes as digits, and the names around them.
constexpr std::size_t kMaxText = 4 * kMaxRadioBytes;

// Digits of either case.
std::optional<std::string> BytesOf(std::string digits) {
  for (char& digit : digits) {
    if (digit >= 'A' && digit <= 'F') digit = static_cast<char>(digit - 'A' + 'a');
  }
  return FromHexadecimal(digits);
}

// As nlohmann decides it, which refuses to write any other.
bool IsUtf8(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

}  // namespace

double LargestOpening(const WorldDescription& world, GripperId gripper) {
  const Interval& left = world.joint(world.gripper(gripper).left).position;
  const Interval& right = world.joint(world.gripper(gripper).right).position;
  return left.max - left.min + right.max - right.min;
}

GripperMotion MotionOf(const WorldDescription& world, GripperId gripper, const WorldState& state) {
  GripperMotion motion;
  for (const JointId id : {world.gripper(gripper).left, world.gripper(gripper).right}) {
    const JointState& finger = state.joints[id.index()];
    motion.opening += world.joint(id).position.max - finger.position;
    motion.opening_rate -= finger.velocity;
    motion.moves = motion.moves || finger.velocity != 0.0;
    motion.blocked = motion.blocked || finger.blocked;
  }
  motion.clamped = state.grippers[gripper.index()].clamped.has_value();
  return motion;
}

std::string GripperJson(const WorldDescription& world, GripperId gripper, const WorldState& state) {
  const GripperMotion motion = MotionOf(world, gripper, state);
  const GripperState& grip = state.grippers[gripper.index()];
  const double largest = LargestOpening(world, gripper);
  nlohmann::json json = {{"tick", state.tick},
                         {"fingers", FingersOf(motion, largest)},
                         {"opening", motion.opening},
                         {"largest_opening", largest}};
  if (grip.left_contact) json["left_contact"] = world.model(*grip.left_contact).name;
  if (grip.right_contact) json["right_contact"] = world.model(*grip.right_contact).name;
  if (grip.clamped) {
    json["clamped"] = world.model(world.objects[grip.clamped->index()]).name;
    if (state.objects[grip.clamped->index()].holder == gripper) json["held"] = json["clamped"];
  }
  if (const std::optional<JointId> lift = world.gripper(gripper).lift) {
    json["lift"] = state.joints[lift->index()].position;
    json["lift_blocked"] = state.joints[lift->index()].blocked;
  }
  return JsonText(json);
}

std::string ReceptionJson(const WorldDescription& world, const RadioReception& reception) {
  nlohmann::json json = {{"from", world.robot(reception.from).name},
                         {"to_all", reception.to_all},
                         {"bytes", ToHexadecimal(std::as_bytes(std::span(reception.bytes)))},
                         {"rssi", reception.rssi},
                         {"tick", reception.tick}};
  std::string text(reception.bytes.begin(), reception.bytes.end());
  if (IsUtf8(text)) json["text"] = std::move(text);
  if (reception.place) {
    json["range"] = reception.place->range;
    json["bearing"] = reception.place->bearing;
    json["elevation"] = reception.place->elevation;
  }
  return JsonText(json);
}

Result<RadioMessage> ReadRadioMessage(const WorldDescription& world, std::size_t radio, const std::string& text) {
  if (text.size() > kMaxText) return BadInput("a text that is too long");
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return BadInput("a text that is no JSON object");
  RadioMessage message{.radio = radio};
  bool has_content = false;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string()) return BadInput("a value that is no string");
    const std::string content = value.get<std::string>();
    if (key == "to") {
      message.to = FindRobot(world, content);
      if (!message.to) return BadInput("the name of a robot that is not there");
    } else if (key == "text" && !has_content) {
      message.bytes.assign(content.begin(), content.end());
      has_content = true;
    } else if (key == "bytes" && !has_content) {
      const std::optional<std::string> bytes = BytesOf(content);
      if (!bytes) return BadInput("bytes that are no pairs of hexadecimal digits");
      message.bytes.assign(bytes->begin(), bytes->end());
      has_content = true;
    } else {
      return BadInput("keys other than 'to', and 'text' or 'bytes'");
    }
  }
  if (!has_content) return BadInput("neither 'text' nor 'bytes'");
  return message;
}

}  // namespace troupe::ros
