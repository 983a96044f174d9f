// Paths from the URIs in ROS requests.
#pragma once

#include <string>
#include <string_view>

#include "common/dds/binding/wire.h"

namespace troupe {

// The path of a "file://" URI; any other text as it is.
inline std::string ResourcePath(const char* uri) {
  const std::string text = dds::Text(uri);
  constexpr std::string_view kScheme = "file://";
  return text.starts_with(kScheme) ? text.substr(kScheme.size()) : text;
}

}  // namespace troupe
