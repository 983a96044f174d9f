#include "common/run/ros_lockstep.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "common/base/text.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxLength = 200;  // bytes

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

bool IsPart(std::string_view part) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || IsDigit(c) || c == '_';
  };
  return !part.empty() && !IsDigit(part.front()) && std::all_of(part.begin(), part.end(), is_allowed);
}

// "/anna/cmd_vel": each part behind a slash.
bool IsTopic(std::string_view text) {
  while (text.starts_with("/")) {
    const std::size_t end = std::min(text.find('/', 1), text.size());
    if (!IsPart(text.substr(1, end - 1))) return false;
    text.remove_prefix(end);
    if (text.empty()) return true;
  }
  return false;
}

}  // namespace

Status CheckRosLockstepName(const std::string& name) {
  const bool is_below_robot = name.starts_with("~/");
  const bool is_topic = IsTopic(is_below_robot ? std::string_view(name).substr(1) : name);
  if (name.size() <= kMaxLength && (is_topic || IsPart(name))) return {};
  return Error{{},
               "found '" + PlainLine(name, kMaxLength) +
                   "', expected a topic such as '/anna/cmd_vel' or '~/cmd_vel', or the name of a node"};
}

}  // namespace troupe
