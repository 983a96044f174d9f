// Expressions of xacro: the part of Python's that robot files use. Numbers, texts and truth values; + - * / // % **,
// comparisons, and, or, not, `a if b else c`, brackets, sin, cos, tan, asin, acos, atan, sqrt, radians, degrees, abs,
// min, max, int, float, str, round, pi. Everything else is an error that names it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "troupe/result.h"

namespace troupe {

using ExpressionValue = std::variant<double, std::string, bool>;

// The value of a name; nothing if there is none. An error ends the evaluation.
using NameLookup = std::function<Result<std::optional<ExpressionValue>>(const std::string& name)>;

// The error has no place.
Result<ExpressionValue> Evaluate(std::string_view text, const NameLookup& lookup);

// As Python prints it: 1 is "1", and 0.5 "0.5".
std::string ToText(const ExpressionValue& value);

// A number, true or false if the text is one; else the text.
ExpressionValue ValueOfText(std::string_view text);

bool IsTrue(const ExpressionValue& value);

}  // namespace troupe
