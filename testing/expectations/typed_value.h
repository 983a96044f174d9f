// TypedValue: what an expression is worth, with its type and unit, as the compiler checks them.
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
