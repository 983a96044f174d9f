// Changes of a formula before it is compiled: shorthands become the formulas that they abbreviate, and the formula gets
// a form of the same robustness that is decided as early as possible.
//
// All rewriting is from syntax to syntax, before names are known: so it cannot depend on the world, and the text that
// `formula` shows is an ordinary formula that can be written in a test. Each rule keeps the robustness itself, not only
// the truth: minimum and maximum commute with "always" and "eventually", and "not" exchanges them exactly, since it
// only changes signs.
#pragma once

#include <span>
#include <string>

#include "testing/expectations/syntax.h"
#include "troupe/result.h"

namespace troupe {

struct Shorthand {
  const char* name;
  const char* usage;    // "reached(PLACE[, TIME[, RADIUS]])"
  const char* formula;  // "forall r: eventually[0, TIME] at(r, PLACE, RADIUS)"
  const char* meaning;
};
std::span<const Shorthand> Shorthands();

// The error is a shorthand with wrong arguments.
Result<Syntax> Expanded(Syntax syntax);

// The same formula, without "->" and without "not" but before signals, comparisons and "until"; "always" is moved below
// "and" and "forall", "eventually" below "or" and "exists" as far as they are outermost: so each of their parts is
// judged by itself. With closest pairs.
Syntax Normalized(Syntax syntax);

// "forall a, b: distance(a, b) > C" as "(min a, b: distance(a, b)) > C", and the same with "always" behind the
// quantifier, for exists, and for either order of the comparison: the robustness is the same.
Syntax WithClosestPairs(Syntax syntax);

// True for `min a, b: distance(a, b)`, which one signal reads for all pairs at once (SignalKind::kClosestPair).
bool IsClosestPair(const Syntax& bound);

// Whether the name stands in the formula.
bool Mentions(const Syntax& syntax, const std::string& name);

}  // namespace troupe
