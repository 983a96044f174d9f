#include "ros/messages/radio_json.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>

#include "common/base/hexadecimal.h"
#include "common/base/json_text.h"

namespace troupe::ros {
namespace {

// Twice the bytes as digits, and the names around them.
constexpr std::size_t kLongestText = 4 * kMostRadioBytes;

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

Error Refused(std::string message) {
  return {{}, std::move(message)};
}

}  // namespace

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
  if (text.size() > kLongestText) return Refused("a text that is too long");
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return Refused("a text that is no JSON object");
  RadioMessage message{.radio = radio};
  bool has_content = false;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string()) return Refused("a value that is no string");
    const std::string content = value.get<std::string>();
    if (key == "to") {
      message.to = FindRobot(world, content);
      if (!message.to) return Refused("the name of a robot that is not there");
    } else if (key == "text" && !has_content) {
      message.bytes.assign(content.begin(), content.end());
      has_content = true;
    } else if (key == "bytes" && !has_content) {
      const std::optional<std::string> bytes = BytesOf(content);
      if (!bytes) return Refused("bytes that are no pairs of hexadecimal digits");
      message.bytes.assign(bytes->begin(), bytes->end());
      has_content = true;
    } else {
      return Refused("keys other than 'to', and 'text' or 'bytes'");
    }
  }
  if (!has_content) return Refused("neither 'text' nor 'bytes'");
  return message;
}

}  // namespace troupe::ros
