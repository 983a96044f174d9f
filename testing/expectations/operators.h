// The operators of numbers and of truth, shared by the evaluators of expectations (network.h) and of constraints
// (testing/cases/constraint.h), so that "a < b" means the same in `expect` and in `where`.
//
// Truth is a robustness (troupe/expectation.h): a number whose sign bit is clear if the condition holds, and whose size
// says by how much, in the unit of the comparison. Zero has both cases: 0.0 holds and -0.0 does not, which tells ">="
// from ">" at equality; "not" is the change of the sign, without any other case. An operator is a template argument, so
// that the choice is made once for a node and not for each lane.
#pragma once

#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "testing/expectations/program.h"
#include "testing/expectations/signals.h"

namespace troupe {

// `of_equal`: of two equal numbers. Equality is asked first, since the difference of two equal infinities is NaN. A
// comparison with NaN is false, and infinitely so: no other number can outweigh a missing value.
inline double Difference(double a, double b, double of_equal) {
  const double difference = a - b;
  return a == b ? of_equal : (difference == difference ? difference : -kInfinity);
}

// An operator of two numbers, or of one, which `y` then is not used for.
template <Op op>
inline double Apply(double x, [[maybe_unused]] double y) {
  if constexpr (op == Op::kAdd) return x + y;
  if constexpr (op == Op::kSubtract) return x - y;
  if constexpr (op == Op::kMultiply) return x * y;
  if constexpr (op == Op::kDivide) return x / y;
  if constexpr (op == Op::kSmaller) return x < y ? x : y;
  if constexpr (op == Op::kLarger) return x > y ? x : y;
  if constexpr (op == Op::kNegate || op == Op::kNot) return -x;
  if constexpr (op == Op::kAbsolute) return std::abs(x);
  if constexpr (op == Op::kSquareRoot) return std::sqrt(x);
  if constexpr (op == Op::kGreater) return Difference(x, y, -0.0);
  if constexpr (op == Op::kAtLeast) return Difference(x, y, 0.0);
  if constexpr (op == Op::kEqual) return x == y ? 0.0 : -std::abs(Difference(x, y, 0.0));
  if constexpr (op == Op::kUnequal) return x == y ? -0.0 : std::abs(Difference(x, y, 0.0));
}

// Calls visit.operator()<op>() with the operator as a constant; false if it is none of Apply.
template <typename Visit>
bool VisitOperator(Op op, const Visit& visit) {
  const auto is = [&]<Op known>() {
    if (op != known) return false;
    visit.template operator()<known>();
    return true;
  };
  return is.template operator()<Op::kAdd>() || is.template operator()<Op::kSubtract>() ||
         is.template operator()<Op::kMultiply>() || is.template operator()<Op::kDivide>() ||
         is.template operator()<Op::kSmaller>() || is.template operator()<Op::kLarger>() ||
         is.template operator()<Op::kNegate>() || is.template operator()<Op::kNot>() ||
         is.template operator()<Op::kAbsolute>() || is.template operator()<Op::kSquareRoot>() ||
         is.template operator()<Op::kGreater>() || is.template operator()<Op::kAtLeast>() ||
         is.template operator()<Op::kEqual>() || is.template operator()<Op::kUnequal>();
}

inline bool IsUnary(Op op) {
  return op == Op::kNegate || op == Op::kNot || op == Op::kAbsolute || op == Op::kSquareRoot;
}

// The operator of two numbers that is written like that, and whether its inputs are swapped; nothing for another one.
inline std::optional<std::pair<Op, bool>> OperatorOf(std::string_view sign) {
  if (sign == "+") return std::pair(Op::kAdd, false);
  if (sign == "-") return std::pair(Op::kSubtract, false);
  if (sign == "*") return std::pair(Op::kMultiply, false);
  if (sign == "/") return std::pair(Op::kDivide, false);
  if (sign == ">") return std::pair(Op::kGreater, false);
  if (sign == ">=") return std::pair(Op::kAtLeast, false);
  if (sign == "<") return std::pair(Op::kGreater, true);
  if (sign == "<=") return std::pair(Op::kAtLeast, true);
  if (sign == "==") return std::pair(Op::kEqual, false);
  if (sign == "!=") return std::pair(Op::kUnequal, false);
  return std::nullopt;
}

}  // namespace troupe
