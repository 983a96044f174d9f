#include "testing/cases/constraint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/text.h"
#include "testing/expectations/network.h"
#include "testing/expectations/operators.h"
#include "troupe/enum_names.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

enum class Type : unsigned char { kNumber, kText, kTruth, kAny };  // kAny: a draw, known when it is drawn
constexpr auto NamesOf(Type) {
  return std::array{"a number", "a text", "a condition", "a draw"};
}

bool IsTruthConstant(const Syntax& syntax) {
  return syntax.Is(SyntaxKind::kName, "true") || syntax.Is(SyntaxKind::kName, "false");
}

// The types of the parts of a formula. The first error counts.
class Checker {
 public:
  explicit Checker(const std::vector<std::string>& names) : names_(names) {}

  Type Check(const Syntax& syntax) {
    switch (syntax.kind) {
      case SyntaxKind::kNumber:
        if (!syntax.number.unit.empty()) Fail(syntax, "found the unit '" + syntax.number.unit + "', expected none");
        return Type::kNumber;
      case SyntaxKind::kText:
        return Type::kText;
      case SyntaxKind::kName:
        return CheckName(syntax);
      case SyntaxKind::kOperator:
        return CheckOperator(syntax);
      case SyntaxKind::kCall:
      case SyntaxKind::kTemporal:
      case SyntaxKind::kBound:
        Fail(syntax, "found '" + PlainLine(syntax.name, 40) + "', expected a condition of names in 'vary' and numbers");
        return Type::kTruth;
    }
    return Type::kAny;
  }

  void Require(const Syntax& at, Type found, Type expected) {
    if (found == expected || found == Type::kAny) return;
    Fail(at, std::string("found ") + NameOf(found) + ", expected " + NameOf(expected));
  }

  const std::optional<Error>& error() const { return error_; }

 private:
  void Fail(const Syntax& at, std::string message) {
    if (!error_) error_ = TextError(at.offset, std::move(message));
  }

  Type CheckName(const Syntax& name) {
    if (IsTruthConstant(name)) return Type::kTruth;
    if (std::find(names_.begin(), names_.end(), name.name) == names_.end()) {
      Fail(name,
           "found the name " + Quoted(name.name) + ", expected one of those in 'vary'" + DidYouMean(name.name, names_));
    }
    return Type::kAny;
  }

  Type CheckOperator(const Syntax& syntax) {
    const std::string& name = syntax.name;
    const std::vector<Syntax>& parts = syntax.children;
    if (name == "not" || name == "and" || name == "or" || name == "->") {
      for (const Syntax& part : parts) Require(part, Check(part), Type::kTruth);
      return Type::kTruth;
    }
    std::vector<Type> types;
    for (const Syntax& part : parts) types.push_back(Check(part));
    if (name == "==" || name == "!=") {
      if (types[0] != Type::kAny) Require(parts[1], types[1], types[0]);
      return Type::kTruth;
    }
    for (std::size_t i = 0; i < parts.size(); ++i) Require(parts[i], types[i], Type::kNumber);
    return name[0] == '<' || name[0] == '>' ? Type::kTruth : Type::kNumber;
  }

  const std::vector<std::string>& names_;
  std::optional<Error> error_;
};

// What a part of a formula is worth. Of texts only the equality counts. Truth is a robustness, infinite of a draw.
struct Worth {
  double number = 0.0;
  std::string text = {};  // of a text
  bool is_text = false;
};

Worth WorthOf(const std::string& literal) {
  if (literal == "true") return {kInfinity};
  if (literal == "false") return {-kInfinity};
  if (const std::optional<LeadingNumber> number = ReadLeadingNumber(literal); number && number->is_all) {
    return {number->value};
  }
  const nlohmann::json value = nlohmann::json::parse(literal, nullptr, false);
  return {0.0, value.is_string() ? value.get<std::string>() : literal, true};
}

double Combine(Op op, double x, double y) {
  double result = 0.0;
  VisitOperator(op, [&]<Op known>() { result = Apply<known>(x, y); });
  return result;
}

class Evaluator {
 public:
  Evaluator(const std::vector<std::string>& names, const TestCase& draws) : names_(names), draws_(draws) {}

  Worth Evaluate(const Syntax& syntax) const {
    if (syntax.kind == SyntaxKind::kNumber) return {syntax.number.value};
    if (syntax.kind == SyntaxKind::kText) return {0.0, syntax.name, true};
    if (IsTruthConstant(syntax)) return {syntax.name == "true" ? kInfinity : -kInfinity};
    if (syntax.kind != SyntaxKind::kOperator) {
      const auto name = std::find(names_.begin(), names_.end(), syntax.name);
      return WorthOf(draws_[static_cast<std::size_t>(name - names_.begin())].value);
    }
    const std::string& sign = syntax.name;
    if (sign == "->") return {Greatest(-NumberOf(syntax, 0), NumberOf(syntax, 1))};
    if (sign == "and" || sign == "or") {
      double result = NumberOf(syntax, 0);
      for (std::size_t i = 1; i < syntax.children.size(); ++i) {
        result = sign == "and" ? Least(result, NumberOf(syntax, i)) : Greatest(result, NumberOf(syntax, i));
      }
      return {result};
    }
    const Worth left = Evaluate(syntax.children[0]);
    if (syntax.children.size() == 1) return {-left.number};  // minus or not
    const Worth right = Evaluate(syntax.children[1]);
    // A number never equals a text: "5" and 5 are different values of a scenario.
    if (left.is_text || right.is_text) {
      const bool is_equal = left.is_text == right.is_text && left.text == right.text;
      const bool holds = (sign == "==" && is_equal) || (sign == "!=" && !is_equal);
      return {holds ? kInfinity : -kInfinity};
    }
    const auto [op, is_swapped] = OperatorOf(sign).value();
    return {is_swapped ? Combine(op, right.number, left.number) : Combine(op, left.number, right.number)};
  }

 private:
  double NumberOf(const Syntax& syntax, std::size_t child) const { return Evaluate(syntax.children[child]).number; }

  const std::vector<std::string>& names_;
  const TestCase& draws_;
};

// What a part of a formula can be worth. Rounding keeps order, so that the bounds that are computed hold for all
// numbers that are.
class Bounder {
 public:
  Bounder(const std::vector<std::string>& names, const std::vector<DrawBounds>& draws) : names_(names), draws_(draws) {
    for (std::size_t i = 0; i < draws.size(); ++i) known_.push_back({"", draws[i].value.value_or("")});
  }

  // Nothing: a text, or something else than a number.
  std::optional<Interval> Bounds(const Syntax& syntax) const {
    if (IsKnown(syntax)) {
      const Worth worth = Evaluator(names_, known_).Evaluate(syntax);
      if (worth.is_text) return std::nullopt;
      // A condition that is violated by 0: the least negative number, as 0 counts as true.
      if (IsCondition(syntax) && worth.number == 0.0 && std::signbit(worth.number))
        return Interval{-kMinViolation, -kMinViolation};
      return Interval{worth.number, worth.number};
    }
    if (syntax.kind != SyntaxKind::kOperator) return draws_[IndexOf(syntax)].numbers;
    const std::string& sign = syntax.name;
    if (sign == "and" || sign == "or" || sign == "->") {
      const bool is_and = sign == "and";
      Interval all = is_and ? Interval{kInfinity, kInfinity} : Interval{-kInfinity, -kInfinity};
      for (std::size_t i = 0; i < syntax.children.size(); ++i) {
        Interval part = Bounds(syntax.children[i]).value_or(kAnything);
        if (sign == "->" && i == 0) part = {-part.max, -part.min};
        all.min = is_and ? std::min(all.min, part.min) : std::max(all.min, part.min);
        all.max = is_and ? std::min(all.max, part.max) : std::max(all.max, part.max);
      }
      return all;
    }
    const std::optional<Interval> left = Bounds(syntax.children[0]);
    if (syntax.children.size() == 1) return left ? Interval{-left->max, -left->min} : kAnything;
    const std::optional<Interval> right = Bounds(syntax.children[1]);
    if (!left || !right) return kAnything;
    return OfPair(sign, *left, *right);
  }

 private:
  static constexpr Interval kAnything{-kInfinity, kInfinity};
  static constexpr double kMinViolation = std::numeric_limits<double>::min();

  static bool IsCondition(const Syntax& syntax) {
    const std::string& name = syntax.name;
    return syntax.kind == SyntaxKind::kOperator && name != "+" && name != "-" && name != "*" && name != "/";
  }

  static Interval OfPair(const std::string& sign, const Interval& left, const Interval& right) {
    const auto [op, is_swapped] = OperatorOf(sign).value();
    if (op == Op::kDivide && right.Contains(0.0)) return kAnything;
    // Each operator rises or falls in both of its numbers, but the two of equality, between which zero is.
    Interval bounds{kInfinity, -kInfinity};
    for (const double x : {left.min, left.max}) {
      for (const double y : {right.min, right.max}) {
        const double value = is_swapped ? Combine(op, y, x) : Combine(op, x, y);
        if (std::isnan(value)) return kAnything;
        bounds = {std::min(bounds.min, value), std::max(bounds.max, value)};
      }
    }
    const bool overlap = left.min <= right.max && right.min <= left.max;
    if (overlap && (op == Op::kEqual || op == Op::kUnequal)) {
      bounds = {std::min(bounds.min, 0.0), std::max(bounds.max, 0.0)};
    }
    return bounds;
  }

  std::size_t IndexOf(const Syntax& name) const {
    return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name.name) - names_.begin());
  }

  bool IsKnown(const Syntax& syntax) const {
    if (syntax.kind == SyntaxKind::kOperator) {
      return std::all_of(syntax.children.begin(), syntax.children.end(),
                         [&](const Syntax& child) { return IsKnown(child); });
    }
    return syntax.kind != SyntaxKind::kName || IsTruthConstant(syntax) || draws_[IndexOf(syntax)].value.has_value();
  }

  const std::vector<std::string>& names_;
  const std::vector<DrawBounds>& draws_;
  TestCase known_;
};

}  // namespace

Result<Constraint> Constraint::Parse(std::string_view text, const std::vector<std::string>& names) {
  Result<Syntax> formula = ParseFormula(text, NameSyntax::kPath);
  if (!formula.ok()) return formula.error();
  Checker checker(names);
  checker.Require(formula.value(), checker.Check(formula.value()), Type::kTruth);
  if (checker.error()) return *checker.error();
  return Constraint(std::move(formula).value(), names);
}

bool Constraint::Holds(const TestCase& draws) const {
  return !std::signbit(Evaluator(names_, draws).Evaluate(formula_).number);
}

bool Constraint::CanHold(const std::vector<DrawBounds>& draws) const {
  const std::optional<Interval> bounds = Bounder(names_, draws).Bounds(formula_);
  return !bounds || !(bounds->max < 0.0);
}

}  // namespace troupe
