#include "testing/expectations/typed_value.h"

#include <algorithm>
#include <array>
#include <utility>

namespace troupe {

// Words for the usual quantities, so that an error reads as "found a speed (m/s), expected a length (m)".
std::string NameOf(const Dimension& dimension) {
  constexpr std::array<std::pair<Dimension, const char*>, 7> kNames{{{{1, 0, 0, 0}, "a length"},
                                                                     {{0, 1, 0, 0}, "a time"},
                                                                     {{1, -1, 0, 0}, "a speed"},
                                                                     {{0, 0, 1, 0}, "an angle"},
                                                                     {{0, -1, 1, 0}, "a yaw rate"},
                                                                     {{0, 0, 0, 1}, "an energy"},
                                                                     {{0, -1, 0, 1}, "a power"}}};
  for (const auto& [its_dimension, name] : kNames) {
    if (its_dimension == dimension) return std::string(name) + " (" + ToString(dimension) + ")";
  }
  return dimension == Dimension{} ? "a number without unit" : "a quantity in " + ToString(dimension);
}

std::string NameOf(const TypedValue& value) {
  if (value.type == ValueType::kTruth) return "a condition";
  if (value.type == ValueType::kText) return "a text";
  return NameOf(value.dimension);
}

// Exponents are bounded: a long product of units must not overflow.
Dimension Product(const Dimension& a, const Dimension& b, int sign) {
  const auto add = [&](int one, int other) {
    return static_cast<std::int8_t>(std::clamp(one + sign * other, -100, 100));
  };
  return {add(a.metre, b.metre), add(a.second, b.second), add(a.radian, b.radian), add(a.joule, b.joule)};
}

// "m or rad" has the first unit here; SetUnitOfJoints turns it for joints that turn. Ticks are counts.
Dimension DimensionOf(std::string_view unit) {
  if (unit == "tick") return {};
  const Unit* const known = FindUnit(unit.substr(0, unit.find(" or ")));
  return known == nullptr ? Dimension{} : known->dimension;
}

}  // namespace troupe
