// PrintPlain: text for a terminal. Names of files, robots and hosts come from users and peers and may have control
// characters, which would command the terminal or forge a line.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/base/text.h"

namespace troupe {

// The value as a plain line (text.h) if it is text, else unchanged.
template <typename Value>
auto PlainValue(const Value& value) {
  if constexpr (std::is_convertible_v<const Value&, std::string_view>) {
    return PlainLine(value);
  } else {
    return value;
  }
}

// fmt::print with each text value on one line. The format itself is printed as it is.
template <typename... Values>
void PrintPlain(std::FILE* stream, fmt::format_string<decltype(PlainValue(std::declval<const Values&>()))...> format,
                const Values&... values) {
  fmt::print(stream, format, PlainValue(values)...);
}

}  // namespace troupe
