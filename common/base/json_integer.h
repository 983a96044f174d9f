// IntegerOf: an integer in a JSON value of nlohmann::json that comes from another process.
#pragma once

#include <concepts>
#include <cstdint>
#include <stdexcept>
#include <utility>

namespace troupe {

// Throws std::out_of_range for a value of another type, with a fraction, or beyond the range of Integer, which a
// conversion of nlohmann's would turn into any number.
template <std::integral Integer, typename Json>
Integer IntegerOf(const Json& json) {
  if (json.is_number_unsigned()) {
    const auto value = json.template get<std::uint64_t>();
    if (std::in_range<Integer>(value)) return static_cast<Integer>(value);
  } else if (json.is_number_integer()) {
    const auto value = json.template get<std::int64_t>();
    if (std::in_range<Integer>(value)) return static_cast<Integer>(value);
  }
  throw std::out_of_range("found " + json.dump() + ", expected an integer in range");
}

}  // namespace troupe
