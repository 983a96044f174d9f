// Places in a text: spans of bytes, and their lines.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// A part of a text, in bytes: [begin, end).
struct TextSpan {
  std::size_t begin = 0;
  std::size_t end = 0;

  std::size_t size() const { return end - begin; }
  bool Contains(std::size_t offset) const { return begin <= offset && offset < end; }
  std::string_view Of(std::string_view text) const { return text.substr(begin, size()); }
};

// The lines of a text, each ended by a LF.
class TextLines {
 public:
  explicit TextLines(std::string_view text);

  // Lines and columns count from 1, columns in bytes.
  SourceLocation Where(const std::string& file, std::size_t offset) const;
  // The other way; the nearest offset, if the text has no such place.
  std::size_t OffsetOf(int line, int column) const;

 private:
  std::vector<std::size_t> starts_{0};
  std::size_t size_ = 0;
};

}  // namespace troupe
