#include "common/base/source_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.h"

namespace troupe {

TextLines::TextLines(std::string_view text) : size_(text.size()) {
  for (std::size_t i = text.find('\n'); i != std::string_view::npos; i = text.find('\n', i + 1)) {
    starts_.push_back(i + 1);
  }
}

SourceLocation TextLines::Where(const std::string& file, std::size_t offset) const {
  // starts_ begins with 0: next - 1 exists for every offset.
  const auto next = std::upper_bound(starts_.begin(), starts_.end(), offset);
  return {file, static_cast<int>(next - starts_.begin()), static_cast<int>(offset - *(next - 1)) + 1};
}

std::size_t TextLines::OffsetOf(int line, int column) const {
  const auto index = static_cast<std::size_t>(std::max(line, 1)) - 1;
  if (index >= starts_.size()) return size_;
  return std::min(starts_[index] + static_cast<std::size_t>(std::max(column, 1)) - 1, size_);
}

std::string Quoted(std::string_view text, std::size_t longest) {
  std::string quoted = "'";
  std::size_t i = 0;
  while (i < text.size() && i < longest) {
    // Whole characters, so that a cut never leaves half of one in a message.
    const std::size_t length = Utf8Length(text, i);
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
