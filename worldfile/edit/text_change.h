// Changes of a text that leave every other byte as it is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "worldfile/text/text_span.h"

namespace troupe {

struct TextChange {
  TextSpan span;
  std::string replacement;
};

// REQUIRES: the spans are within the text and do not overlap.
std::string ApplyChanges(std::string_view text, std::vector<TextChange> changes);

// The start of the line that `offset` is on, and its end, before the line's end characters.
std::size_t LineStart(std::string_view text, std::size_t offset);
std::size_t LineEnd(std::string_view text, std::size_t offset);

// The blanks at the start of the line that `offset` is on.
std::string IndentOf(std::string_view text, std::size_t offset);

// The characters that end the text's lines.
std::string EndOfLineIn(std::string_view text);

// The span with what its removal leaves behind: the whole lines if they hold nothing else, else the blanks before it.
TextSpan WithSurroundings(std::string_view text, TextSpan span);

// A number in the form of both languages, without exponent: at most `decimals` digits after the point.
std::string PlainNumber(double value, int decimals = 4);

}  // namespace troupe
