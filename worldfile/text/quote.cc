#include "worldfile/text/quote.h"

#include <fmt/format.h>

namespace troupe {

std::string Quoted(std::string_view text, std::size_t longest) {
  std::string quoted = "'";
  std::size_t i = 0;
  while (i < text.size() && i < longest) {
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
