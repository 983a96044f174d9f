#include "worldfile/text/number_text.h"

#include <charconv>
#include <cmath>
#include <system_error>

namespace troupe {

std::optional<LeadingNumber> ReadLeadingNumber(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return std::nullopt;
  text.remove_prefix(begin);
  if (text.front() == '+' && text.substr(1, 1) != "-") text.remove_prefix(1);
  LeadingNumber number;
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, number.value);
  if (read.ec != std::errc() || !std::isfinite(number.value)) return std::nullopt;
  number.is_all = std::string_view(read.ptr, static_cast<std::size_t>(end - read.ptr)).find_first_not_of(kBlanks) ==
                  std::string_view::npos;
  return number;
}

}  // namespace troupe
