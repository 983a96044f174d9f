#include "testing/cases/constraint.h"

#include <algorithm>
#include <cmath>
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

}  // namespace troupe
