#include "worldfile/text/quote.h"

#include <fmt/format.h>

namespace troupe {
namespace {

// The length of the UTF-8 character that starts at `i`, or 0 if there is none (Unicode 15, table 3-7).
std::size_t CharacterLength(std::string_view text, std::size_t i) {
  const auto byte = [text](std::size_t at) { return at < text.size() ? static_cast<unsigned char>(text[at]) : 0; };
  const auto continues = [byte](std::size_t at) { return byte(at) >= 0x80 && byte(at) <= 0xbf; };
  const int first = byte(i);
  const int second = byte(i + 1);
  if (first < 0x80) return 1;
  if (first < 0xc2 || first > 0xf4 || !continues(i + 1)) return 0;
  if (first < 0xe0) return 2;
  if (!continues(i + 2)) return 0;
  if (first < 0xf0) return (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ? 0 : 3;
  if (!continues(i + 3)) return 0;
  return (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f) ? 0 : 4;
}

}  // namespace

std::size_t FindInvalidUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = CharacterLength(text, i);
    if (length == 0) return i;
    i += length;
  }
  return std::string_view::npos;
}

std::string Quoted(std::string_view text, std::size_t longest) {
  std::string quoted = "'";
  std::size_t i = 0;
  while (i < text.size() && i < longest) {
    const std::size_t length = CharacterLength(text, i);
    const unsigned char byte = static_cast<unsigned char>(text[i]);
    if (length == 0 || byte < 0x20 || byte == 0x7f) {
      quoted += fmt::format("\\x{:02x}", byte);
      ++i;
    } else {
      quoted += text.substr(i, length);
      i += length;
    }
  }
  if (i < text.size()) quoted += "...";
  return quoted + "'";
}

std::string CountText(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string NumberText(double value) {
  return fmt::format("{:.10g}", value);
}

}  // namespace troupe
