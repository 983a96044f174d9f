// Numbers at the beginning of texts, as Stage and map_server read them, in any locale.
#pragma once

#include <optional>
#include <string_view>

namespace troupe {

struct LeadingNumber {
  double value = 0.0;
  bool is_all = false;  // nothing but blanks follows
};

// The number that the text begins with, after blanks and perhaps a plus sign: of "1.2.3" it is 1.2, of "5 m" 5.
// Nothing: it begins with none, or with one that is not finite.
std::optional<LeadingNumber> ReadLeadingNumber(std::string_view text);

}  // namespace troupe
