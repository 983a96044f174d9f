#include "ros/connection/type_hash.h"

#include <string_view>

namespace troupe::ros {
namespace {

constexpr const char* kMark = "typehash=";
constexpr const char* kServiceMark = "sertypehash=";

}  // namespace

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
  std::string mark = kMark + HashOfRosType(type) + ";";
  if (distribution < Distribution::kLyrical) return mark;
  for (const std::string_view part : {"_Request", "_Response"}) {
    if (!type.ends_with(part)) continue;
    mark += kServiceMark + HashOfRosType(type.substr(0, type.size() - part.size())) + ";";
  }
  return mark;
}

}  // namespace troupe::ros
