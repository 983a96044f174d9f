#include "worldfile/edit/text_change.h"

#include <fmt/format.h>

#include <algorithm>

namespace troupe {

namespace {

bool IsBlankAt(char c) {
  return c == ' ' || c == '\t';
}
bool EndsLine(char c) {
  return c == '\n' || c == '\r';
}

}  // namespace

std::string ApplyChanges(std::string_view text, std::vector<TextChange> changes) {
  std::stable_sort(changes.begin(), changes.end(),
                   [](const TextChange& a, const TextChange& b) { return a.span.begin < b.span.begin; });
  std::string result;
  std::size_t at = 0;
  for (const TextChange& change : changes) {
    result.append(text.substr(at, change.span.begin - at));
    result.append(change.replacement);
    at = change.span.end;
  }
  result.append(text.substr(at));
  return result;
}

std::size_t LineStart(std::string_view text, std::size_t offset) {
  while (offset > 0 && !EndsLine(text[offset - 1])) --offset;
  return offset;
}

std::size_t LineEnd(std::string_view text, std::size_t offset) {
  while (offset < text.size() && !EndsLine(text[offset])) ++offset;
  return offset;
}

std::string IndentOf(std::string_view text, std::size_t offset) {
  const std::size_t start = LineStart(text, offset);
  std::size_t end = start;
  while (end < text.size() && IsBlankAt(text[end])) ++end;
  return std::string(text.substr(start, end - start));
}

std::string EndOfLineIn(std::string_view text) {
  const std::size_t first = text.find('\n');
  return first != std::string_view::npos && first > 0 && text[first - 1] == '\r' ? "\r\n" : "\n";
}

TextSpan WithSurroundings(std::string_view text, TextSpan span) {
  std::size_t begin = span.begin;
  while (begin > 0 && IsBlankAt(text[begin - 1])) --begin;
  const bool starts_line = begin == 0 || EndsLine(text[begin - 1]);
  std::size_t end = span.end;
  while (end < text.size() && IsBlankAt(text[end])) ++end;
  const bool ends_line = end == text.size() || EndsLine(text[end]);
  if (!starts_line) return {begin, ends_line ? end : span.end};
  if (!ends_line) return {span.begin, end};
  if (end < text.size()) {
    const char first = text[end++];
    if (end < text.size() && EndsLine(text[end]) && text[end] != first) ++end;
  }
  return {begin, end};
}

std::string PlainNumber(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

}  // namespace troupe
