#include "testing/expectations/rewrite.h"

#include <algorithm>
#include <array>
#include <utility>

namespace troupe {
namespace {

constexpr std::array kShorthands{
    Shorthand{"reached", "reached(PLACE[, TIME[, RADIUS]])", "forall r: eventually[0 s, TIME] at(r, PLACE, RADIUS)",
              "Every robot comes to the place, within TIME."},
    Shorthand{"no_contact", "no_contact[(GAP)]", "forall a, b: always distance(a, b) > GAP",
              "No two robots come nearer to each other than GAP, 1 mm if none is given."},
    Shorthand{"all_alive", "all_alive", "forall r: always alive(r)", "No robot is lost or without energy."},
    Shorthand{"within", "within(REGION)", "forall r: always in(r, REGION)", "No robot leaves the region."},
    Shorthand{"state_hash", "state_hash(TEXT)", "finally hash == TEXT", "The run ends in the state with this hash."},
};

bool IsTruthOperator(const Syntax& syntax) {
  return syntax.kind == SyntaxKind::kOperator &&
         (syntax.name == "and" || syntax.name == "or" || syntax.name == "->" || syntax.name == "not");
}

void SetOffsets(Syntax& syntax, std::size_t offset) {
  syntax.offset = offset;
  for (Syntax& child : syntax.children) SetOffsets(child, offset);
}

// A formula of this program, at the place of the shorthand that stands for it.
Syntax Template(const char* formula, std::size_t offset) {
  Syntax syntax = ParseFormula(formula).value();
  SetOffsets(syntax, offset);
  return syntax;
}

Result<Syntax> Expansion(const Syntax& use) {
  const std::string& name = use.name;
  const std::vector<Syntax>& arguments = use.children;
  const auto* const shorthand =
      std::find_if(kShorthands.begin(), kShorthands.end(), [&](const Shorthand& s) { return s.name == name; });
  const auto wrong_count = [&](std::size_t least, std::size_t most) -> std::optional<Error> {
    if (arguments.size() >= least && arguments.size() <= most) return std::nullopt;
    return TextError(use.offset, "found " + std::to_string(arguments.size()) + " arguments of '" + name +
                                     "', expected " + shorthand->usage);
  };
  if (name == "reached") {
    if (auto error = wrong_count(1, 3)) return *error;
    Syntax formula = Template("forall r: eventually at(r, place)", use.offset);
    Syntax& eventually = formula.children[0];
    Syntax& at = eventually.children[0];
    at.children[1] = arguments[0];
    if (arguments.size() > 1) {
      if (arguments[1].kind != SyntaxKind::kNumber) {
        return TextError(arguments[1].offset, "found something else, expected the TIME of 'reached', such as 300 s");
      }
      eventually.interval = {{0.0, "s"}, arguments[1].number, arguments[1].offset};
    }
    if (arguments.size() > 2) at.children.push_back(arguments[2]);
    return formula;
  }
  if (name == "no_contact") {
    if (auto error = wrong_count(0, 1)) return *error;
    Syntax formula = Template("forall a, b: always distance(a, b) > 1 mm", use.offset);
    if (!arguments.empty()) formula.children[0].children[0].children[1] = arguments[0];
    return formula;
  }
  if (name == "all_alive") {
    if (auto error = wrong_count(0, 0)) return *error;
    return Template("forall r: always alive(r)", use.offset);
  }
  if (name == "within") {
    if (auto error = wrong_count(1, 1)) return *error;
    Syntax formula = Template("forall r: always in(r, region)", use.offset);
    formula.children[0].children[0].children[1] = arguments[0];
    return formula;
  }
  if (auto error = wrong_count(1, 1)) return *error;
  Syntax formula = Template("finally hash == text", use.offset);
  formula.children[0].children[1] = arguments[0];
  return formula;
}

// The formula, or its negation, without "->" and with "not" only where it cannot be moved further inwards.
Syntax Moved(Syntax syntax, bool negate) {
  if (syntax.Is(SyntaxKind::kOperator, "not")) return Moved(std::move(syntax.children[0]), !negate);
  const auto swap = [&](std::string_view one, std::string_view other) {
    if (!negate) return;
    if (syntax.name == one) {
      syntax.name = other;
    } else if (syntax.name == other) {
      syntax.name = one;
    }
  };
  if (IsTruthOperator(syntax)) {
    const bool implies = syntax.name == "->";
    // p -> q is (not p) or q. De Morgan: a negation exchanges "and" and "or" and moves to the parts.
    if (implies) syntax.name = "or";
    swap("and", "or");
    for (std::size_t i = 0; i < syntax.children.size(); ++i) {
      syntax.children[i] = Moved(std::move(syntax.children[i]), negate != (implies && i == 0));
    }
    return syntax;
  }
  const bool is_until = syntax.name == "until" || syntax.name == "since";
  const bool is_truth_bound = syntax.kind == SyntaxKind::kBound && (syntax.name == "forall" || syntax.name == "exists");
  if ((syntax.kind == SyntaxKind::kTemporal && !is_until) || is_truth_bound) {
    swap("always", "eventually");
    swap("historically", "once");
    swap("forall", "exists");
    syntax.children[0] = Moved(std::move(syntax.children[0]), negate);
    return syntax;
  }
  // "until" and "since" have no dual in the language, and numbers no negation: the "not" stays in front.
  for (Syntax& child : syntax.children) child = Moved(std::move(child), false);
  if (!negate) return syntax;
  Syntax negation;
  negation.kind = SyntaxKind::kOperator;
  negation.name = "not";
  negation.offset = syntax.offset;
  negation.children.push_back(std::move(syntax));
  return negation;
}

// Moves an outermost "always" below "and" and "forall", and "eventually" below "or" and "exists".
Syntax Distributed(Syntax syntax) {
  const bool is_always = syntax.Is(SyntaxKind::kTemporal, "always");
  if (is_always || syntax.Is(SyntaxKind::kTemporal, "eventually")) {
    Syntax& inner = syntax.children[0];
    const bool is_chain = inner.Is(SyntaxKind::kOperator, is_always ? "and" : "or");
    if (!is_chain && !inner.Is(SyntaxKind::kBound, is_always ? "forall" : "exists")) {
      // Two without an interval are one.
      if (!inner.Is(SyntaxKind::kTemporal, syntax.name) || inner.interval || syntax.interval) return syntax;
      Syntax one = std::move(inner);
      return Distributed(std::move(one));
    }
    Syntax outer = std::move(inner);
    for (Syntax& child : outer.children) {
      Syntax part = syntax;  // without children: they have moved
      part.children.clear();
      part.children.push_back(std::move(child));
      child = std::move(part);
    }
    return Distributed(std::move(outer));
  }
  const bool is_truth_bound = syntax.kind == SyntaxKind::kBound && (syntax.name == "forall" || syntax.name == "exists");
  if (IsTruthOperator(syntax) || is_truth_bound) {
    for (Syntax& child : syntax.children) child = Distributed(std::move(child));
  }
  return syntax;
}

bool IsPairDistance(const Syntax& syntax, const std::vector<std::string>& variables) {
  if (!syntax.Is(SyntaxKind::kCall, "distance") || syntax.children.size() != 2 || variables.size() != 2) return false;
  const Syntax& a = syntax.children[0];
  const Syntax& b = syntax.children[1];
  if (a.kind != SyntaxKind::kName || b.kind != SyntaxKind::kName) return false;
  return (a.name == variables[0] && b.name == variables[1]) || (a.name == variables[1] && b.name == variables[0]);
}

}  // namespace

std::span<const Shorthand> Shorthands() {
  return kShorthands;
}

Result<Syntax> Expanded(Syntax syntax) {
  if (syntax.kind == SyntaxKind::kName || syntax.kind == SyntaxKind::kCall) {
    const bool is_shorthand = std::any_of(kShorthands.begin(), kShorthands.end(),
                                          [&](const Shorthand& shorthand) { return shorthand.name == syntax.name; });
    if (is_shorthand) return Expansion(syntax);
    return syntax;  // arguments are names and numbers, never formulas
  }
  for (Syntax& child : syntax.children) {
    Result<Syntax> expanded = Expanded(std::move(child));
    if (!expanded.ok()) return expanded.error();
    child = std::move(expanded).value();
  }
  return syntax;
}

Syntax Normalized(Syntax syntax) {
  return WithClosestPairs(Distributed(Moved(std::move(syntax), false)));
}

Syntax WithClosestPairs(Syntax syntax) {
  for (Syntax& child : syntax.children) child = WithClosestPairs(std::move(child));
  if (syntax.kind != SyntaxKind::kBound || (syntax.name != "forall" && syntax.name != "exists")) return syntax;
  const bool is_forall = syntax.name == "forall";
  Syntax* at = syntax.children.data();
  // min over pairs commutes with min over ticks, so "always" may stand between.
  while (at->Is(SyntaxKind::kTemporal, is_forall ? "always" : "eventually")) at = at->children.data();
  bool negated = false;
  if (at->Is(SyntaxKind::kOperator, "not")) {
    negated = true;
    at = at->children.data();
  }
  if (at->kind != SyntaxKind::kOperator || at->children.size() != 2) return syntax;
  const bool greater = at->name == ">" || at->name == ">=";
  if (!greater && at->name != "<" && at->name != "<=") return syntax;
  const std::size_t side = IsPairDistance(at->children[0], syntax.variables) ? 0 : 1;
  Syntax& distance = at->children[side];
  const Syntax& other = at->children[1 - side];
  if (!IsPairDistance(distance, syntax.variables)) return syntax;
  if (Mentions(other, syntax.variables[0]) || Mentions(other, syntax.variables[1])) return syntax;
  // "forall ... distance > C" and "exists ... distance < C" are both decided by the least distance. The other two would
  // need the greatest, which no index finds.
  const bool wants_more = (greater == (side == 0)) != negated;
  if (wants_more != is_forall) return syntax;
  Syntax least = syntax;
  least.name = "min";
  least.children.clear();
  least.children.push_back(std::move(distance));
  distance = std::move(least);
  Syntax result = std::move(syntax.children[0]);
  return result;
}

bool IsClosestPair(const Syntax& bound) {
  return bound.Is(SyntaxKind::kBound, "min") && IsPairDistance(bound.children[0], bound.variables);
}

bool Mentions(const Syntax& syntax, const std::string& name) {
  if (syntax.kind == SyntaxKind::kName && syntax.name == name) return true;
  return std::any_of(syntax.children.begin(), syntax.children.end(),
                     [&](const Syntax& child) { return Mentions(child, name); });
}

}  // namespace troupe
