#include "ros/service_bridge/serialized_text.h"

#include <cstddef>

namespace troupe::ros {

std::optional<std::string> SerializedText(std::span<const std::uint8_t> sample) {
  constexpr std::size_t kText = 8;  // after the encoding and the length
  if (sample.size() < kText || sample[0] != 0 || sample[1] > 1) return std::nullopt;
  const bool little_endian = sample[1] == 1;
  std::size_t length = 0;
  for (unsigned i = 0; i < 4; ++i) length |= std::size_t{sample[4 + i]} << 8U * (little_endian ? i : 3 - i);
  // With the zero at its end.
  if (length == 0 || length > sample.size() - kText || sample[kText + length - 1] != 0) return std::nullopt;
  return std::string(reinterpret_cast<const char*>(sample.data()) + kText, length - 1);
}

}  // namespace troupe::ros
