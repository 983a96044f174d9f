// The text of a serialized std_msgs/String.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace troupe::ros {

// Nothing for a sample of another layout.
std::optional<std::string> SerializedText(std::span<const std::uint8_t> sample);

}  // namespace troupe::ros
