// Base64: bytes as text, for JSON and web pages (RFC 4648, section 4).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace troupe {

// The bytes as text, with padding.
std::string Base64(std::string_view bytes);
// The bytes of such a text; nothing for any other text.
std::optional<std::string> FromBase64(std::string_view text);

}  // namespace troupe
