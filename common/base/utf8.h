// Text of users and peers as UTF-8: where its characters end, and what of it may be shown.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace troupe {

// The length in bytes of the character that starts at `i`, or 0 if there is none.
std::size_t Utf8Length(std::string_view text, std::size_t i);

// The offset of the first byte that is not valid UTF-8, or npos.
std::size_t FindInvalidUtf8(std::string_view text);

// The beginning of the text, of at most `longest` bytes, without a part of a character at its end.
std::string_view CutUtf8(std::string_view text, std::size_t longest);

// Whether the text is valid UTF-8 without control characters: on a terminal it is one line, and commands nothing.
bool IsPlainLine(std::string_view text);

// The text as a plain line, cut to at most `longest` bytes: control characters become spaces, and bytes that are not
// UTF-8 question marks.
std::string PlainLine(std::string_view text, std::size_t longest = std::string_view::npos);

}  // namespace troupe
