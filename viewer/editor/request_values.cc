#include "viewer/editor/request_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "viewer/editor/property_text.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr double kLargest = 1e6;
constexpr std::size_t kMostBlocks = 200;
constexpr std::size_t kMostCorners = 1000;
constexpr std::size_t kMostProperties = 100;

std::optional<double> NumberOf(const Json& value) {
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  return std::isfinite(number) && std::abs(number) <= kLargest ? std::optional(number) : std::nullopt;
}

}  // namespace

std::string TextIn(const Json& object, const char* key) {
  const auto member = object.find(key);
  return member != object.end() && member->is_string() ? member->get<std::string>() : std::string();
}

std::optional<std::size_t> IndexOf(const Json& value) {
  if (!value.is_number_integer() || value < 0) return std::nullopt;
  return value.get<std::size_t>();
}

std::optional<double> NumberIn(const Json& object, const char* key) {
  const auto member = object.find(key);
  return member != object.end() ? NumberOf(*member) : std::nullopt;
}

std::optional<std::vector<double>> NumbersIn(const Json& object, const char* key, std::size_t count) {
  const auto member = object.find(key);
  if (member == object.end() || !member->is_array() || member->size() != count) return std::nullopt;
  std::vector<double> numbers;
  for (const Json& value : *member) {
    const std::optional<double> number = NumberOf(value);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<Pose> PoseIn(const Json& object, const char* key) {
  const auto numbers = NumbersIn(object, key, 4);
  if (!numbers) return std::nullopt;
  return Pose{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
}

Result<std::vector<DrawnBlock>> BlocksIn(const Json& object, double metres_per_unit) {
  const auto list = object.find("blocks");
  const Error malformed{{}, "found blocks of another form, expected outlines of 3 to 1000 corners with heights"};
  if (list == object.end() || !list->is_array() || list->size() > kMostBlocks) return malformed;
  std::vector<DrawnBlock> blocks;
  for (const Json& each : *list) {
    if (!each.is_object() || !each.contains("outline") || !each["outline"].is_array()) return malformed;
    const Json& outline = each["outline"];
    const auto z = NumbersIn(each, "z", 2);
    if (outline.size() < 3 || outline.size() > kMostCorners || !z) return malformed;
    DrawnBlock block{{}, (*z)[0] / metres_per_unit, (*z)[1] / metres_per_unit};
    if (block.z_max <= block.z_min)
      return Error{{}, "found a block without height, expected its top above its underside"};
    for (const Json& corner : outline) {
      if (!corner.is_array() || corner.size() != 2) return malformed;
      const auto x = NumberOf(corner[0]);
      const auto y = NumberOf(corner[1]);
      if (!x || !y) return malformed;
      block.outline.emplace_back(*x / metres_per_unit, *y / metres_per_unit);
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

Result<PropertyChange> PropertyChangeIn(const nlohmann::json& object) {
  PropertyChange change{TextIn(object, "property"), {}};
  if (!IsPropertyName(change.property)) {
    return Error{{}, "found the property " + Quoted(change.property) + ", expected a name"};
  }
  const auto given = object.find("value");
  if (given == object.end() || !given->is_string()) return change;
  Result<WrittenValue> read = ReadValueText(given->get<std::string>());
  if (!read.ok()) return read.error();
  change.value = std::move(read).value();
  return change;
}

Result<WrittenProperties> PropertiesIn(const Json& request) {
  WrittenProperties properties;
  const auto given = request.find("properties");
  if (given == request.end()) return properties;
  if (!given->is_object() || given->size() > kMostProperties) return Error{{}, "found no object of properties"};
  for (const auto& [name, text] : given->items()) {
    if (!IsPropertyName(name) || !text.is_string())
      return Error{{}, "found the property " + Quoted(name) + ", expected a text"};
    Result<WrittenValue> value = ReadValueText(text.get<std::string>());
    if (!value.ok()) return Error{{}, Quoted(name) + ": " + value.error().message};
    properties.emplace_back(name, std::move(value).value());
  }
  return properties;
}

Status CheckName(const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 100 && FindInvalidUtf8(name) == std::string::npos &&
                     std::none_of(name.begin(), name.end(),
                                  [](char c) { return c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20; });
  if (plain) return {};
  return Error{{}, "found the name " + Quoted(name) + ", expected 1 to 100 characters without quotes"};
}

}  // namespace troupe
