// Base64: bytes as text, for JSON and web pages. Encoding only.
#pragma once

#include <string>
#include <string_view>

namespace troupe {

// The bytes as text, with padding (RFC 4648, section 4).
std::string Base64(std::string_view bytes);

}  // namespace troupe
