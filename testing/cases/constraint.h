// Constraint: a condition that the draws of a case must meet, as `where` of a test has it: "spawn[0].count * 2 <= n".
// It is a formula of the language of expectations, about draws instead of signals, without time and quantifiers; the
// same parser and operators serve both.
//
// It is interpreted from its tree: a constraint is small and is asked some thousand times, so that a compilation would
// not pay. A draw's type is known only when it is drawn ("values" may mix numbers and texts), therefore draws fit every
// type at parsing, and a text in arithmetic counts as 0. Immutable; any thread may ask.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "testing/cases/variation.h"
#include "testing/expectations/syntax.h"
#include "troupe/interval.h"
#include "troupe/result.h"

namespace troupe {

// What is known of a draw before it is drawn.
struct DrawBounds {
  std::optional<std::string> value = {};  // JSON
  std::optional<Interval> numbers = {};   // if there is no value: it is a number within these; nothing: anything
};

class Constraint {
 public:
  // Names are the paths `names`; numbers, "texts" or 'texts', true and false; + - * /, comparisons, and, or, not, ->.
  // The error's column counts from 1 in `text`.
  static Result<Constraint> Parse(std::string_view text, const std::vector<std::string>& names);

  // REQUIRES: `draws` begin with one for each name, in their order.
  bool Holds(const TestCase& draws) const;
  // False only if it holds for no draws within these bounds: by the bounds of each part of the formula, so that it may
  // be true although there are none. REQUIRES: as Holds
  bool CanHold(const std::vector<DrawBounds>& draws) const;

 private:
  Constraint(Syntax formula, std::vector<std::string> names) : formula_(std::move(formula)), names_(std::move(names)) {}

  Syntax formula_;
  std::vector<std::string> names_;
};

}  // namespace troupe
