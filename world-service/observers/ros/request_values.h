// Values of ROS requests: poses, twists, and paths with their formats.
#pragma once

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "ros/messages/messages.h"
#include "transport/dds/binding/wire.h"
#include "troupe/pose.h"
#include "troupe/result.h"

namespace troupe {

// X_WE of an entity E. `frame`: "map" or "world", which are one frame; "" means map. Fails on another frame, on a
// number that is not finite, on a quaternion of zeros, and on a pose that is tilted about x or y.
Result<Pose> PoseFromRos(const char* frame, const ros::PoseMessage& pose);

// A twist of a robot in its frame R: the components that a drive has. The error is another component, or a number that
// is not finite.
Result<Twist> TwistFromRos(const ros::TwistMessage& twist);

// The path of a "file://" URI; any other text as it is.
inline std::string ResourcePath(const char* uri) {
  const std::string text = dds::Text(uri);
  constexpr std::string_view kScheme = "file://";
  return text.starts_with(kScheme) ? text.substr(kScheme.size()) : text;
}

// Whether the text of a file has another format than a Stage world or a scenario: XML, as of URDF and SDF.
inline bool IsOtherText(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '<';
}

// Whether a resource that cannot be used has a format other than those with the endings: another ending, or another
// scheme. A name without an ending, as of a model, has none.
inline bool HasOtherFormat(const std::string& path, std::initializer_list<std::string_view> endings) {
  if (path.find("://") != std::string::npos) return true;
  const std::string ending = std::filesystem::path(path.substr(0, path.rfind('#'))).extension().string();
  return !ending.empty() && std::find(endings.begin(), endings.end(), ending) == endings.end();
}

}  // namespace troupe
