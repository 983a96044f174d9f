#include "common/sensing/reading_json.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace troupe {

std::string LineStart(Tick tick, const std::string& robot, const std::string& sensor) {
  return "{\"tick\":" + std::to_string(tick) + ",\"robot\":" + JsonString(robot) + ",\"sensor\":" + JsonString(sensor);
}

std::string JsonString(const std::string& text) {
  return JsonText(nlohmann::json(text));
}

std::string JsonNumbers(std::span<const double> values) {
  std::string text = "[";
  text.reserve(2 + 20 * values.size());
  for (const double value : values) {
    char digits[32];
    if (text.size() > 1) text += ',';
    text.append(digits, std::to_chars(digits, digits + sizeof(digits), value).ptr);
  }
  return text + "]";
}

std::string JsonNumber(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof(digits), value).ptr};
}

}  // namespace troupe
