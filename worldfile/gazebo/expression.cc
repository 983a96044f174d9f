#include "worldfile/gazebo/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "troupe/deterministic_math.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr int kMaxBrackets = 100;
constexpr std::size_t kMaxExpressionText = 100'000;  // bytes, of a text that is joined

bool IsNameStart(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool IsNamePart(char c) {
  return IsNameStart(c) || (c >= '0' && c <= '9') || c == '.';
}

double NumberIn(const ExpressionValue& value) {
  if (const double* const number = std::get_if<double>(&value)) return *number;
  if (const bool* const truth = std::get_if<bool>(&value)) return *truth ? 1.0 : 0.0;
  return std::nan("");
}

// Recursive descent, from the weakest operator to the strongest.
class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, const NameLookup& lookup) : text_(text), lookup_(lookup) {}

  Result<ExpressionValue> Parse() {
    ExpressionValue value = Choice();
    SkipBlanks();
    if (!error_ && at_ < text_.size())
      Fail("found " + Quoted(text_.substr(at_)) + ", expected the end of the expression");
    if (error_) return *error_;
    return value;
  }

 private:
  void Fail(const std::string& message) {
    if (!error_) error_ = Error{{}, message + " in ${" + std::string(text_.substr(0, 200)) + "}"};
  }

  void SkipBlanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
      ++at_;
  }

  bool Take(std::string_view sign) {
    SkipBlanks();
    if (!text_.substr(at_).starts_with(sign)) return false;
    at_ += sign.size();
    return true;
  }

  bool TakeWord(std::string_view word) {
    SkipBlanks();
    if (!text_.substr(at_).starts_with(word)) return false;
    if (at_ + word.size() < text_.size() && IsNamePart(text_[at_ + word.size()])) return false;
    at_ += word.size();
    return true;
  }

  ExpressionValue Choice() {
    if (++depth_ > kMaxBrackets) Fail("found too many brackets");
    if (error_) return 0.0;
    ExpressionValue value = Or();
    if (TakeWord("if")) {
      const ExpressionValue condition = Or();
      if (!TakeWord("else")) Fail("found 'if' without 'else'");
      ExpressionValue otherwise = Choice();
      if (!IsTrue(condition)) value = std::move(otherwise);
    }
    --depth_;
    return value;
  }

  ExpressionValue Or() {
    ExpressionValue value = And();
    while (TakeWord("or")) {
      ExpressionValue other = And();
      if (!IsTrue(value)) value = std::move(other);
    }
    return value;
  }

  ExpressionValue And() {
    ExpressionValue value = Not();
    while (TakeWord("and")) {
      ExpressionValue other = Not();
      if (IsTrue(value)) value = std::move(other);
    }
    return value;
  }

  ExpressionValue Not() {
    int count = 0;
    while (TakeWord("not")) ++count;
    ExpressionValue value = Comparison();
    return count == 0 ? value : ExpressionValue((count % 2 == 1) != IsTrue(value));
  }

  ExpressionValue Comparison() {
    ExpressionValue value = Sum();
    for (const char* sign : {"==", "!=", "<=", ">=", "<", ">"}) {
      if (!Take(sign)) continue;
      const ExpressionValue other = Sum();
      const auto* const a = std::get_if<std::string>(&value);
      const auto* const b = std::get_if<std::string>(&other);
      int order = 0;
      if (a != nullptr && b != nullptr) {
        order = a->compare(*b);
      } else if (a != nullptr || b != nullptr) {
        order = 1;  // a text is no number
      } else {
        order = NumberIn(value) < NumberIn(other) ? -1 : NumberIn(value) > NumberIn(other) ? 1 : 0;
      }
      const std::string_view s = sign;
      return s == "=="   ? order == 0
             : s == "!=" ? order != 0
             : s == "<=" ? order <= 0
             : s == ">=" ? order >= 0
             : s == "<"  ? order < 0
                         : order > 0;
    }
    return value;
  }

  double Number(const ExpressionValue& value) {
    const double number = NumberIn(value);
    if (std::isnan(number)) Fail("found the text " + Quoted(ToText(value)) + ", expected a number");
    return number;
  }

  ExpressionValue Sum() {
    ExpressionValue value = Product();
    for (;;) {
      if (error_) return value;
      if (Take("+")) {
        const ExpressionValue other = Product();
        if (auto* const text = std::get_if<std::string>(&value)) {
          *text += ToText(other);
          if (text->size() > kMaxExpressionText) Fail("found a text that is too long");
        } else {
          value = Number(value) + Number(other);
        }
      } else if (Take("-")) {
        const ExpressionValue other = Product();
        value = Number(value) - Number(other);
      } else {
        return value;
      }
    }
  }

  ExpressionValue Product() {
    ExpressionValue value = Sign();
    for (;;) {
      if (error_) return value;
      SkipBlanks();
      if (text_.substr(at_).starts_with("**")) return value;
      const bool is_floor = Take("//");
      const char sign = is_floor ? '/' : Take("*") ? '*' : Take("/") ? '/' : Take("%") ? '%' : ' ';
      if (sign == ' ') return value;
      const double a = Number(value);
      const double b = Number(Sign());
      if (sign == '*') {
        value = a * b;
        continue;
      }
      if (b == 0.0) {
        Fail("found a division by 0");
        return 0.0;
      }
      value = sign == '%' ? a - b * std::floor(a / b) : is_floor ? std::floor(a / b) : a / b;
    }
  }

  ExpressionValue Sign() {
    if (Take("-")) return -Number(Sign());
    if (Take("+")) return Number(Sign());
    ExpressionValue base = Atom();
    if (!error_ && Take("**")) {
      const double exponent = Number(Sign());
      const double whole = std::round(exponent);
      if (exponent != whole || std::fabs(whole) > 64) {
        Fail("found the power " + NumberText(exponent) + ", expected a whole number");
        return 0.0;
      }
      double result = 1.0;
      for (int i = 0; i < static_cast<int>(std::fabs(whole)); ++i) result *= Number(base);
      return whole < 0 ? 1.0 / result : result;
    }
    return base;
  }

  ExpressionValue Atom() {
    SkipBlanks();
    if (error_) return 0.0;
    if (Take("(")) {
      ExpressionValue value = Choice();
      if (!Take(")")) Fail("found an opening bracket without a closing one");
      return value;
    }
    if (at_ >= text_.size()) {
      Fail("found the end, expected a value");
      return 0.0;
    }
    const char c = text_[at_];
    if (c == '\'' || c == '"') {
      const std::size_t end = text_.find(c, at_ + 1);
      if (end == std::string_view::npos) {
        Fail("found a text without its closing quote");
        return 0.0;
      }
      std::string text(text_.substr(at_ + 1, end - at_ - 1));
      at_ = end + 1;
      return text;
    }
    if ((c >= '0' && c <= '9') || c == '.') {
      double number = 0.0;
      const std::from_chars_result read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), number);
      if (read.ec != std::errc()) Fail("found " + Quoted(text_.substr(at_)) + ", expected a number");
      at_ = static_cast<std::size_t>(read.ptr - text_.data());
      return number;
    }
    if (!IsNameStart(c)) {
      Fail("found " + Quoted(text_.substr(at_, 20)) + ", expected a number, a text or a name");
      return 0.0;
    }
    std::size_t end = at_;
    while (end < text_.size() && IsNamePart(text_[end])) ++end;
    std::string name(text_.substr(at_, end - at_));
    at_ = end;
    for (const char* const prefix : {"math.", "python.", "xacro."}) {
      if (name.starts_with(prefix)) name = name.substr(std::string_view(prefix).size());
    }
    SkipBlanks();
    if (text_.substr(at_).starts_with("[")) {
      Fail("found a list or a dictionary, which only the program 'xacro' reads,");
      return 0.0;
    }
    if (Take("(")) return Call(name);
    if (name == "True" || name == "true") return true;
    if (name == "False" || name == "false") return false;
    Result<std::optional<ExpressionValue>> found = lookup_(name);
    if (!found.ok()) {
      if (!error_) error_ = found.error();
      return 0.0;
    }
    if (found.value()) return *found.value();
    if (name == "pi") return kPi;
    if (name == "None") return std::string();
    Fail("found the name " + Quoted(name) + ", expected a property or an argument,");
    return 0.0;
  }

  ExpressionValue Call(const std::string& name) {
    std::vector<ExpressionValue> arguments;
    while (!error_ && !Take(")")) {
      arguments.push_back(Choice());
      if (Take(",")) continue;
      if (!Take(")")) Fail("found a call without its closing bracket");
      break;
    }
    if (error_) return 0.0;
    const auto number = [&](std::size_t i) { return i < arguments.size() ? Number(arguments[i]) : 0.0; };
    if (arguments.size() == 1 && name == "str") return ToText(arguments[0]);
    if (arguments.size() == 1) {
      const ExpressionValue& a = arguments[0];
      const auto* const text = std::get_if<std::string>(&a);
      if ((name == "float" || name == "int") && text != nullptr) arguments[0] = ValueOfText(*text);
      constexpr std::string_view kFunctions[] = {"sin",  "cos",     "tan",     "asin", "acos", "atan",
                                                 "sqrt", "radians", "degrees", "abs",  "fabs", "float",
                                                 "int",  "round",   "floor",   "ceil", "bool"};
      const bool is_known = std::find(std::begin(kFunctions), std::end(kFunctions), name) != std::end(kFunctions);
      const double x = is_known ? number(0) : 0.0;
      const SinCosResult angle = SinCos(std::fabs(x) < 1e5 ? x : 0.0);
      if (name == "sin") return angle.sin;
      if (name == "cos") return angle.cos;
      if (name == "tan") return angle.sin / angle.cos;
      if (name == "asin") return Atan2(x, std::sqrt(std::max(0.0, 1.0 - x * x)));
      if (name == "acos") return Atan2(std::sqrt(std::max(0.0, 1.0 - x * x)), x);
      if (name == "atan") return Atan2(x, 1.0);
      if (name == "sqrt") return std::sqrt(std::max(0.0, x));
      if (name == "radians") return DegreesToRadians(x);
      if (name == "degrees") return RadiansToDegrees(x);
      if (name == "abs" || name == "fabs") return std::fabs(x);
      if (name == "float") return x;
      if (name == "int") return std::trunc(x);
      if (name == "round") return std::nearbyint(x);
      if (name == "floor") return std::floor(x);
      if (name == "ceil") return std::ceil(x);
      if (name == "bool") return x != 0.0;
    }
    if (arguments.size() == 2 && name == "atan2") return Atan2(number(0), number(1));
    if (arguments.size() >= 2 && (name == "min" || name == "max")) {
      double best = number(0);
      for (std::size_t i = 1; i < arguments.size(); ++i)
        best = name == "min" ? std::min(best, number(i)) : std::max(best, number(i));
      return best;
    }
    Fail("found a call of " + Quoted(name) + ", which only the program 'xacro' knows,");
    return 0.0;
  }

  std::string_view text_;
  const NameLookup& lookup_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Result<ExpressionValue> Evaluate(std::string_view text, const NameLookup& lookup) {
  return ExpressionParser(text, lookup).Parse();
}

std::string ToText(const ExpressionValue& value) {
  if (const auto* const text = std::get_if<std::string>(&value)) return *text;
  if (const bool* const truth = std::get_if<bool>(&value)) return *truth ? "True" : "False";
  return fmt::format("{}", std::get<double>(value));
}

ExpressionValue ValueOfText(std::string_view text) {
  const std::optional<LeadingNumber> number = ReadLeadingNumber(text);
  if (number && number->is_all) return number->value;
  if (text == "true" || text == "True") return true;
  if (text == "false" || text == "False") return false;
  return std::string(text);
}

bool IsTrue(const ExpressionValue& value) {
  if (const auto* const text = std::get_if<std::string>(&value)) return !text->empty();
  return NumberIn(value) != 0.0;
}

}  // namespace troupe
