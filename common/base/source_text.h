// The texts of users' files: places in them, and their parts in messages. Nothing in here knows a format.
//
// Columns count bytes, as compilers do. Texts of users are escaped in messages, because a terminal would obey control
// characters in them.
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
  // The offset of a place; the nearest one if the text has no such place.
  std::size_t OffsetOf(int line, int column) const;

 private:
  std::vector<std::size_t> starts_{0};
  std::size_t size_ = 0;
};

// 'text', cut to `longest` bytes, with control characters and bytes that are not UTF-8 written as \xNN.
std::string Quoted(std::string_view text, std::size_t longest = 40);

// The same for a path, which is rarely cut.
inline std::string QuotedPath(std::string_view path) {
  return Quoted(path, 500);
}

// "1 value", "3 values".
std::string CountText(std::size_t count, const std::string& noun);

// A number in its usual form: "5", "0.25".
std::string NumberText(double value);

}  // namespace troupe
