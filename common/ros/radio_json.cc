#include "common/ros/radio_json.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/base/json_text.h"

namespace troupe::ros {
namespace {

// Twice the bytes as digits, and the names around them.
constexpr std::size_t kLongestText = 4 * kMostRadioBytes;

constexpr char kDigits[] = "0123456789abcdef";

std::string Hexadecimal(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::optional<std::uint8_t> ValueOf(char digit) {
  if (digit >= '0' && digit <= '9') return static_cast<std::uint8_t>(digit - '0');
  if (digit >= 'a' && digit <= 'f') return static_cast<std::uint8_t>(digit - 'a' + 10);
  if (digit >= 'A' && digit <= 'F') return static_cast<std::uint8_t>(digit - 'A' + 10);
  return std::nullopt;
}

std::optional<std::vector<std::uint8_t>> BytesOf(const std::string& digits) {
  std::vector<std::uint8_t> bytes;
  if (digits.size() % 2 != 0) return std::nullopt;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const std::optional<std::uint8_t> high = ValueOf(digits[i]);
    const std::optional<std::uint8_t> low = ValueOf(digits[i + 1]);
    if (!high || !low) return std::nullopt;
    bytes.push_back(static_cast<std::uint8_t>(*high << 4 | *low));
  }
  return bytes;
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
                         {"bytes", Hexadecimal(reception.bytes)},
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
      std::optional<std::vector<std::uint8_t>> bytes = BytesOf(content);
      if (!bytes) return Refused("bytes that are no pairs of hexadecimal digits");
      message.bytes = *std::move(bytes);
      has_content = true;
    } else {
      return Refused("keys other than 'to', and 'text' or 'bytes'");
    }
  }
  if (!has_content) return Refused("neither 'text' nor 'bytes'");
  return message;
}

}  // namespace troupe::ros
