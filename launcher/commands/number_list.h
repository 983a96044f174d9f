// ParseNumberList: numbers on a command line.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace troupe {

// The finite numbers of "1,-2.5,3"; nothing if it is anything else.
inline std::optional<std::vector<double>> ParseNumberList(const std::string& text) {
  std::vector<double> numbers;
  const char* position = text.data();
  const char* const end = text.data() + text.size();
  for (;;) {
    double number = 0.0;
    const auto [next, fault] = std::from_chars(position, end, number);
    if (fault != std::errc() || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
    if (next == end) return numbers;
    if (*next != ',') return std::nullopt;
    position = next + 1;
  }
}

}  // namespace troupe
