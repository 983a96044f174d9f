#include "ros/messages/text_messages.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>

#include "common/base/json.h"
#include "common/base/json_reader.h"
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

// m: the ways of both fingers together.
double LargestOpening(const WorldDescription& world, GripperId gripper) {
  const Interval& left = world.joint(world.gripper(gripper).left).position;
  const Interval& right = world.joint(world.gripper(gripper).right).position;
  return left.max - left.min + right.max - right.min;
}

// Positions of fingers count towards closing, so that the opening is what is left of their travel.
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

// Bytes always, and a text as well if they are one.
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

// The length is checked before the text is parsed.
Result<RadioMessage> ReadRadioMessage(const WorldDescription& world, std::size_t radio, const std::string& text) {
  if (text.size() > kMaxText) return BadInput("a text that is too long");
  const JsonReader json = JsonReader::OfText(text);
  RadioMessage message{.radio = radio};
  if (const auto to = json.Optional<std::string>("to")) {
    message.to = FindRobot(world, *to);
    if (!message.to) json.Find("to")->Fail("the name of a robot");
  }
  const auto content = json.Optional<std::string>("text");
  const auto digits = json.Optional<std::string>("bytes");
  if (content.has_value() == digits.has_value()) json.Fail("either 'text' or 'bytes'");
  const std::optional<std::string> bytes = digits ? BytesOf(*digits) : content;
  if (digits && !bytes) json.Find("bytes")->Fail("pairs of hexadecimal digits");
  if (bytes) message.bytes.assign(bytes->begin(), bytes->end());
  if (Status status = json.Finish(); !status.ok()) return status.error();
  return message;
}

}  // namespace troupe::ros
