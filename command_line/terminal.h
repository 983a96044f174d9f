// Styles of text on a terminal. Only a terminal gets them: text in a pipe or file has none, nor has any if the
// environment has NO_COLOR (https://no-color.org) or a TERM without colours. Styles are added to finished lines, so
// that messages themselves, their tests and logs stay plain.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace troupe {

enum class TerminalStyle { kBold, kDim, kError, kWarning, kLink };

// Whether texts on the stream have styles.
bool HasStyles(std::FILE* stream);

// The text in the style, if `has_styles`.
std::string Styled(TerminalStyle style, std::string_view text, bool has_styles);

// The line in which a viewer states the address of its page begins with it.
inline constexpr std::string_view kPageLine = "viewer: ";

// A line of a program for users: the words "error:" and "warning:" and the address of a viewer have their styles.
std::string StyledLine(std::string_view line, bool has_styles);

// Removes what the terminal of standard error shows on its line, for instance the ^C of the user.
void ClearLine();

}  // namespace troupe
