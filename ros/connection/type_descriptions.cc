#include "ros/connection/type_descriptions.h"

#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

namespace troupe::ros {
namespace {

// "header:1:0:0:std_msgs/msg/Header"
DescribedField ReadField(const std::string& text) {
  std::istringstream parts(text);
  DescribedField field;
  std::string type;
  std::string capacity;
  std::string string_capacity;
  std::getline(parts, field.name, ':');
  std::getline(parts, type, ':');
  std::getline(parts, capacity, ':');
  std::getline(parts, string_capacity, ':');
  std::getline(parts, field.nested_type);
  field.type = static_cast<std::uint8_t>(std::stoul(type));
  field.capacity = std::stoull(capacity);
  field.string_capacity = std::stoull(string_capacity);
  return field;
}

std::optional<DescribedType> Find(const std::string& ros_type) {
  if (ros_type.empty() || ros_type.find_first_of(" \n") != std::string::npos) return std::nullopt;
  const std::string_view text = kTypeDescriptionsText;
  const std::size_t found = text.find("\n" + ros_type + " ");
  if (found == std::string_view::npos) return std::nullopt;
  const std::size_t start = found + 1;
  std::istringstream line(std::string(text.substr(start, text.find('\n', start) - start)));
  DescribedType type;
  line >> type.name;
  for (std::string field; line >> field;) type.fields.push_back(ReadField(field));
  return type;
}

void FindNested(const DescribedType& type, std::map<std::string, DescribedType>& found) {
  for (const DescribedField& field : type.fields) {
    if (field.nested_type.empty() || found.contains(field.nested_type)) continue;
    std::optional<DescribedType> nested = Find(field.nested_type);
    if (!nested) continue;
    const auto added = found.emplace(field.nested_type, *std::move(nested)).first;
    FindNested(added->second, found);
  }
}

constexpr const char* kMark = "typehash=";
constexpr const char* kServiceMark = "sertypehash=";

}  // namespace

std::vector<DescribedType> DescribeType(const std::string& ros_type) {
  std::optional<DescribedType> type = Find(ros_type);
  if (!type) return {};
  std::map<std::string, DescribedType> nested;
  FindNested(*type, nested);
  std::vector<DescribedType> types = {*std::move(type)};
  for (auto& [name, description] : nested) types.push_back(std::move(description));
  return types;
}

std::string RosTypeName(const std::string& dds_type_name) {
  constexpr std::string_view kMiddle = "::dds_::";
  const std::size_t middle = dds_type_name.find(kMiddle);
  if (middle == std::string::npos || dds_type_name.back() != '_') return "";
  std::string package = dds_type_name.substr(0, middle);  // "std_msgs::msg"
  const std::size_t colons = package.find("::");
  if (colons == std::string::npos) return "";
  package.replace(colons, 2, "/");
  const std::string name = dds_type_name.substr(middle + kMiddle.size());
  return package + "/" + name.substr(0, name.size() - 1);
}

std::string TypeHash(const std::string& dds_type_name) {
  return HashOfRosType(RosTypeName(dds_type_name));
}

std::string HashOfRosType(const std::string& ros_type) {
  const std::string_view text = kTypeHashesText;
  const std::string key = "\"" + ros_type + "\": \"";
  const std::size_t start = text.find(key);
  if (start == std::string_view::npos) return "";
  const std::size_t begin = start + key.size();
  return std::string(text.substr(begin, text.find('"', begin) - begin));
}

std::string TypeMark(Distribution distribution, const std::string& dds_type_name) {
  if (distribution == Distribution::kHumble) return "";
  const std::string type = RosTypeName(dds_type_name);
  // Of a type that has another layout from Kilted on, both hashes are known.
  const std::string later = distribution >= Distribution::kKilted ? HashOfRosType("kilted/" + type) : "";
  std::string mark = kMark + (later.empty() ? HashOfRosType(type) : later) + ";";
  if (distribution < Distribution::kLyrical) return mark;
  for (const std::string_view part : {"_Request", "_Response"}) {
    if (!type.ends_with(part)) continue;
    mark += kServiceMark + HashOfRosType(type.substr(0, type.size() - part.size())) + ";";
  }
  return mark;
}

}  // namespace troupe::ros
