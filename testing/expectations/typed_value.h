// TypedValue: an expression's result while it is compiled: its node, type and unit. Units are exponents of metre,
// second, radian and joule, so that products and quotients of any signals have one, and a comparison of a speed with a
// length is an error at its place instead of a wrong verdict.
//
// Numbers without unit ("0.5", "2 * 3") fit every unit: users write "speed(r) < 0.5". As soon as one part has a unit
// the whole has it. Nothing of this exists at run time: a program has bare doubles in SI units.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "testing/expectations/program.h"
#include "testing/expectations/syntax.h"

namespace troupe {

struct TypedValue {
  std::size_t node = 0;
  ValueType type = ValueType::kTruth;
  Dimension dimension = {};
  bool is_plain = false;  // made of numbers without units: it has any unit
  std::string text = {};  // of a text that is written in the formula
  // Of a text that is read: the node that is added when it is compared.
  std::shared_ptr<const Node> read = {};
  std::vector<std::string> possible = {};  // the texts that it can have; empty: any
};

// "a length (m)", "a number without unit"; "a condition", "a text".
std::string NameOf(const Dimension& dimension);
std::string NameOf(const TypedValue& value);

// Of a product (sign 1) or a quotient (-1).
Dimension Product(const Dimension& a, const Dimension& b, int sign);
// Of a unit of fields (kFieldUnits); "m or rad": a length. Ticks, bytes and the like are numbers without unit.
Dimension DimensionOf(std::string_view unit);

}  // namespace troupe
