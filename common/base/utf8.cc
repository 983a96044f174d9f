#include "common/base/utf8.h"

#include <algorithm>

namespace troupe {
namespace {

constexpr std::size_t kLongestCharacter = 4;  // bytes

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U;
}

// U+0000 to U+001F and U+007F to U+009F. REQUIRES: a character of `length` bytes starts at `i`.
bool IsControl(std::string_view text, std::size_t i, std::size_t length) {
  const auto first = static_cast<unsigned char>(text[i]);
  if (length == 1) return first < 0x20 || first == 0x7f;
  return length == 2 && first == 0xc2 && static_cast<unsigned char>(text[i + 1]) < 0xa0;
}

}  // namespace

// Unicode 15, table 3-7.
std::size_t Utf8Length(std::string_view text, std::size_t i) {
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

std::size_t FindInvalidUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = Utf8Length(text, i);
    if (length == 0) return i;
    i += length;
  }
  return std::string_view::npos;
}

std::string_view CutUtf8(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && longest - end < kLongestCharacter && IsContinuation(text[end])) --end;
  // Bytes of which none begins a character are no UTF-8: they are cut anywhere.
  return text.substr(0, IsContinuation(text[end]) ? longest : end);
}

bool IsPlainLine(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = Utf8Length(text, i);
    if (length == 0 || IsControl(text, i, length)) return false;
    i += length;
  }
  return true;
}

std::string PlainLine(std::string_view text, std::size_t longest) {
  const std::string_view part = CutUtf8(text, longest);
  std::string line;
  line.reserve(part.size());
  for (std::size_t i = 0; i < part.size();) {
    const std::size_t length = Utf8Length(part, i);
    if (length == 0) {
      line += '?';
    } else if (IsControl(part, i, length)) {
      line += ' ';
    } else {
      line += part.substr(i, length);
    }
    i += std::max<std::size_t>(length, 1);
  }
  return line;
}

}  // namespace troupe
