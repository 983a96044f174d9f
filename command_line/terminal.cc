#include "command_line/terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

namespace troupe {
namespace {

// Parameters of ECMA-48's sequence "select graphic rendition".
const char* CodeOf(TerminalStyle style) {
  switch (style) {
    case TerminalStyle::kBold:
      return "1";
    case TerminalStyle::kDim:
      return "2";
    case TerminalStyle::kError:
      return "1;31";
    case TerminalStyle::kWarning:
      return "33";
    case TerminalStyle::kLink:
      return "1;4";
  }
  return "0";
}

}  // namespace

// TERM=dumb is what editors set for the output of a build.
bool HasStyles(std::FILE* stream) {
  const char* const none = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  const bool is_allowed = none == nullptr || *none == '\0';
  return is_allowed && terminal != nullptr && std::string_view(terminal) != "dumb" && isatty(fileno(stream)) == 1;
}

std::string Styled(TerminalStyle style, std::string_view text, bool has_styles) {
  return has_styles ? fmt::format("\033[{}m{}\033[0m", CodeOf(style), text) : std::string(text);
}

// Only a word that begins the message: "error: " in a quoted text stays plain.
std::string StyledLine(std::string_view line, bool has_styles) {
  if (!has_styles) return std::string(line);
  struct Marked {
    std::string_view word;
    TerminalStyle style;
  };
  for (const auto& [word, style] :
       {Marked{"error: ", TerminalStyle::kError}, Marked{"warning: ", TerminalStyle::kWarning}}) {
    const std::size_t at = line.find(word);
    const bool begins_message = at == 0 || (at != std::string_view::npos && line.substr(0, at).ends_with(": "));
    if (!begins_message) continue;
    const std::string_view text = word.substr(0, word.size() - 1);
    return std::string(line.substr(0, at)) + Styled(style, text, true) + std::string(line.substr(at + text.size()));
  }
  if (!line.starts_with(kPageLine)) return std::string(line);
  return std::string(kPageLine) + Styled(TerminalStyle::kLink, line.substr(kPageLine.size()), true);
}

void ClearLine() {
  if (isatty(STDERR_FILENO) != 1) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
}

}  // namespace troupe
