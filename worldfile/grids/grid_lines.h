// The lines of the text files of grids, with places, and the words of a line.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/result.h"

namespace troupe {

struct GridWord {
  std::string_view text;
  SourceLocation where;

  // The whole word as a number that fits Number.
  template <typename Number>
  std::optional<Number> To() const {
    Number number{};
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
    return number;
  }
};

struct GridLine {
  std::string_view text;  // without its end and blanks before that
  SourceLocation where;   // of its first column

  SourceLocation At(std::size_t offset) const {
    return {where.file, where.line, where.column + static_cast<int>(offset)};
  }
  // Separated by blanks and tabs.
  std::vector<GridWord> Words() const {
    std::vector<GridWord> words;
    for (std::size_t i = 0; i < text.size();) {
      if (text[i] == ' ' || text[i] == '\t') {
        ++i;
        continue;
      }
      std::size_t end = i;
      while (end < text.size() && text[end] != ' ' && text[end] != '\t') ++end;
      words.push_back({text.substr(i, end - i), At(i)});
      i = end;
    }
    return words;
  }
};

// All lines; the text outlives them.
inline std::vector<GridLine> GridLinesOf(std::string_view text, const std::string& file) {
  std::vector<GridLine> lines;
  int number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
    lines.push_back({line, {file, number, 1}});
    begin = end + 1;
  }
  return lines;
}

}  // namespace troupe
