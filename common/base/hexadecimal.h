// Bytes as text of two lower-case hexadecimal digits each.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace troupe {

std::string ToHexadecimal(std::span<const std::byte> bytes);

// The bytes; nothing if the text is not of such digits.
std::optional<std::string> FromHexadecimal(std::string_view text);

}  // namespace troupe
