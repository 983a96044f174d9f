#include "testing/cases/constraint.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr int kMaxDepth = 100;

enum class Type : unsigned char { kNumber, kText, kTruth, kAny };  // kAny: a draw, known when it is drawn

const char* NameOf(Type type) {
  switch (type) {
    case Type::kNumber:
      return "a number";
    case Type::kText:
      return "a text";
    case Type::kTruth:
      return "a condition";
    case Type::kAny:
      return "a draw";
  }
  return "";
}

}  // namespace

Constraint::Value Constraint::ValueOf(const std::string& json) {
  if (json == "true") return {1.0, "", false};
  if (json == "false") return {0.0, "", false};
  if (const std::optional<LeadingNumber> number = ReadLeadingNumber(json); number && number->is_all) {
    return {number->value, "", false};
  }
  const nlohmann::json value = nlohmann::json::parse(json, nullptr, false);
  return {0.0, value.is_string() ? value.get<std::string>() : json, true};
}

// A recursive descent. The first error is kept, and ends it.
struct Constraint::Parser {
  struct Part {
    Expression expression;
    Type type = Type::kAny;
    std::size_t at = 0;
  };

  std::string_view text;
  const std::vector<std::string>& names;
  std::size_t position = 0;
  int depth = 0;
  std::optional<Error> error = std::nullopt;

  void Fail(std::size_t at, const std::string& message) {
    if (!error) error = Error{{"", 1, static_cast<int>(at) + 1}, message};
    position = text.size();
  }

  void SkipBlanks() {
    while (position < text.size() && std::isspace(static_cast<unsigned char>(text[position])) != 0) ++position;
  }

  std::string Next() {
    SkipBlanks();
    return position < text.size() ? Quoted(text.substr(position, 12)) : "the end";
  }

  static bool IsWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '$'; }

  bool Accept(std::string_view token) {
    SkipBlanks();
    if (!text.substr(position).starts_with(token)) return false;
    const std::size_t end = position + token.size();
    if (IsWord(token.back()) && end < text.size() && IsWord(text[end])) return false;
    position = end;
    return true;
  }

  void Require(const Part& part, Type type) {
    if (part.type == type || part.type == Type::kAny || error) return;
    Fail(part.at, fmt::format("found {}, expected {}", NameOf(part.type), NameOf(type)));
  }

  Part Nothing() const {
    return {[](const TestCase&) { return Value{}; }, Type::kAny, position};
  }

  Part Or() {
    Part left = And();
    while (!error && Accept("or")) {
      Part right = And();
      Require(left, Type::kTruth);
      Require(right, Type::kTruth);
      left = {[a = left.expression, b = right.expression](const TestCase& draws) {
                return Value{a(draws).number != 0.0 || b(draws).number != 0.0 ? 1.0 : 0.0, "", false};
              },
              Type::kTruth, left.at};
    }
    return left;
  }

  Part And() {
    Part left = Not();
    while (!error && Accept("and")) {
      Part right = Not();
      Require(left, Type::kTruth);
      Require(right, Type::kTruth);
      left = {[a = left.expression, b = right.expression](const TestCase& draws) {
                return Value{a(draws).number != 0.0 && b(draws).number != 0.0 ? 1.0 : 0.0, "", false};
              },
              Type::kTruth, left.at};
    }
    return left;
  }

  Part Not() {
    SkipBlanks();
    const std::size_t at = position;
    if (!Accept("not")) return Comparison();
    if (++depth > kMaxDepth) Fail(at, "found a condition of more than 100 levels, expected fewer");
    Part inner = error ? Nothing() : Not();
    --depth;
    Require(inner, Type::kTruth);
    return {[a = inner.expression](const TestCase& draws) {
              return Value{a(draws).number != 0.0 ? 0.0 : 1.0, "", false};
            },
            Type::kTruth, at};
  }

  Part Comparison() {
    Part left = Sum();
    static constexpr std::array<std::string_view, 6> kOperators = {"<=", ">=", "==", "!=", "<", ">"};
    for (std::size_t i = 0; i < kOperators.size() && !error; ++i) {
      if (!Accept(kOperators[i])) continue;
      Part right = Sum();
      const bool ordered = i != 2 && i != 3;
      for (const Part* part : {&left, &right}) {
        if (ordered) Require(*part, Type::kNumber);
      }
      if (left.type != right.type && left.type != Type::kAny && right.type != Type::kAny) Require(right, left.type);
      return {[a = left.expression, b = right.expression, i](const TestCase& draws) {
                const Value x = a(draws);
                const Value y = b(draws);
                const bool equal = x.is_text == y.is_text && x.number == y.number && x.text == y.text;
                const std::array<bool, 6> outcomes = {x.number <= y.number, x.number >= y.number, equal, !equal,
                                                      x.number<y.number, x.number> y.number};
                return Value{outcomes[i] ? 1.0 : 0.0, "", false};
              },
              Type::kTruth, left.at};
    }
    return left;
  }

  Part Sum() {
    Part left = Product();
    while (!error) {
      const bool plus = Accept("+");
      if (!plus && !Accept("-")) break;
      Part right = Product();
      Require(left, Type::kNumber);
      Require(right, Type::kNumber);
      left = {[a = left.expression, b = right.expression, plus](const TestCase& draws) {
                return Value{a(draws).number + (plus ? 1.0 : -1.0) * b(draws).number, "", false};
              },
              Type::kNumber, left.at};
    }
    return left;
  }

  Part Product() {
    Part left = Factor();
    while (!error) {
      const bool times = Accept("*");
      if (!times && !Accept("/")) break;
      Part right = Factor();
      Require(left, Type::kNumber);
      Require(right, Type::kNumber);
      left = {[a = left.expression, b = right.expression, times](const TestCase& draws) {
                const double x = a(draws).number;
                const double y = b(draws).number;
                return Value{times ? x * y : x / y, "", false};
              },
              Type::kNumber, left.at};
    }
    return left;
  }

  Part Factor() {
    SkipBlanks();
    const std::size_t at = position;
    if (Accept("(")) {
      if (++depth > kMaxDepth) Fail(at, "found a condition of more than 100 levels, expected fewer");
      Part inner = error ? Nothing() : Or();
      --depth;
      if (!error && !Accept(")")) Fail(position, fmt::format("found {}, expected ')'", Next()));
      return inner;
    }
    if (Accept("-")) {
      if (++depth > kMaxDepth) Fail(at, "found a condition of more than 100 levels, expected fewer");
      Part inner = error ? Nothing() : Factor();
      --depth;
      Require(inner, Type::kNumber);
      return {[a = inner.expression](const TestCase& draws) {
                return Value{-a(draws).number, "", false};
              },
              Type::kNumber, at};
    }
    if (at < text.size() && (text[at] == '"' || text[at] == '\'')) return Text(at);
    double number = 0.0;
    const auto read = std::from_chars(text.data() + at, text.data() + text.size(), number);
    if (at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0 && read.ec == std::errc()) {
      position = static_cast<std::size_t>(read.ptr - text.data());
      return {[number](const TestCase&) { return Value{number, "", false}; }, Type::kNumber, at};
    }
    return Name(at);
  }

  Part Text(std::size_t at) {
    const std::size_t end = text.find(text[at], at + 1);
    if (end == std::string_view::npos) {
      Fail(at, "found a text without an end, expected a quote behind it");
      return Nothing();
    }
    position = end + 1;
    return {[value = std::string(text.substr(at + 1, end - at - 1))](const TestCase&) {
              return Value{0.0, value, true};
            },
            Type::kText, at};
  }

  Part Name(std::size_t at) {
    std::size_t end = at;
    while (end < text.size() && (IsWord(text[end]) || text[end] == '.' || text[end] == '[')) {
      if (text[end] == '[') end = std::min(text.find(']', end), text.size() - 1);
      ++end;
    }
    const std::string name(text.substr(at, end - at));
    if (name.empty()) {
      Fail(at, fmt::format("found {}, expected a number, a text, or a name in 'vary'", Next()));
      return Nothing();
    }
    position = end;
    for (const bool truth : {true, false}) {
      if (name != (truth ? "true" : "false")) continue;
      return {[truth](const TestCase&) { return Value{truth ? 1.0 : 0.0, "", false}; }, Type::kTruth, at};
    }
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      Fail(at,
           fmt::format("found the name {}, expected one of those in 'vary'{}", Quoted(name), DidYouMean(name, names)));
      return Nothing();
    }
    const auto index = static_cast<std::size_t>(found - names.begin());
    return {[index](const TestCase& draws) { return ValueOf(draws[index].value); }, Type::kAny, at};
  }
};

Result<Constraint> Constraint::Parse(std::string_view text, const std::vector<std::string>& names) {
  Parser parser{text, names};
  Parser::Part whole = parser.Or();
  parser.Require(whole, Type::kTruth);
  parser.SkipBlanks();
  if (parser.position < text.size()) {
    parser.Fail(parser.position, fmt::format("found {}, expected 'and', 'or' or the end", parser.Next()));
  }
  if (parser.error) return *parser.error;
  return Constraint(std::move(whole.expression));
}

bool Constraint::Holds(const TestCase& draws) const {
  return expression_(draws).number != 0.0;
}

}  // namespace troupe
