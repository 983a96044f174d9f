// Syntax as text.
#include <array>
#include <charconv>
#include <cstdlib>

#include "testing/expectations/syntax.h"

namespace troupe {
namespace {

std::string NumberText(double value) {
  std::array<char, 32> buffer{};
  const auto [end, problem] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  static_cast<void>(problem);  // the shortest text of any double fits
  return {buffer.data(), end};
}

std::string TextOf(const NumberSyntax& number) {
  return NumberText(number.value) + (number.unit.empty() || number.unit == "%" ? "" : " ") + number.unit;
}

std::string Quoted(const std::string& text) {
  const char quote = text.find('"') == std::string::npos ? '"' : '\'';
  return quote + text + quote;
}

// How strongly a node binds: the levels of the grammar.
int Level(const Syntax& syntax) {
  if (syntax.kind == SyntaxKind::kBound) return 0;
  if (syntax.kind == SyntaxKind::kTemporal) return syntax.children.size() == 2 ? 4 : 5;
  if (syntax.kind != SyntaxKind::kOperator) return 10;
  const std::string& name = syntax.name;
  if (name == "->") return 1;
  if (name == "or") return 2;
  if (name == "and") return 3;
  if (name == "not") return 5;
  if (name == "+" || (name == "-" && syntax.children.size() == 2)) return 7;
  if (name == "*" || name == "/") return 8;
  if (name == "-") return 9;
  return 6;
}

// The child, in parentheses if it binds less than `least`.
std::string Inside(const Syntax& child, int least) {
  const std::string text = ToString(child);
  return Level(child) < least ? "(" + text + ")" : text;
}

std::string TextOf(const std::optional<IntervalSyntax>& interval) {
  if (!interval) return {};
  return "[" + TextOf(interval->from) + ", " + (interval->to ? TextOf(*interval->to) : "end") + "]";
}

}  // namespace

std::string ToString(const Dimension& dimension) {
  if (dimension == Dimension{0, -1, 0, 1}) return "W";
  std::string over;
  std::string under;
  const auto add = [&](int exponent, const char* name) {
    std::string& text = exponent > 0 ? over : under;
    if (exponent == 0) return;
    if (!text.empty()) text += "*";
    text += name;
    if (std::abs(exponent) > 1) text += "^" + std::to_string(std::abs(exponent));
  };
  add(dimension.joule, "J");
  add(dimension.metre, "m");
  add(dimension.radian, "rad");
  add(dimension.second, "s");
  if (under.empty()) return over;
  return (over.empty() ? "1" : over) + "/" + (under.find('*') == std::string::npos ? under : "(" + under + ")");
}

std::string ToString(const Syntax& syntax) {
  const std::vector<Syntax>& children = syntax.children;
  switch (syntax.kind) {
    case SyntaxKind::kNumber:
      return TextOf(syntax.number);
    case SyntaxKind::kText:
      return Quoted(syntax.name);
    case SyntaxKind::kName:
      return syntax.name;
    case SyntaxKind::kCall: {
      std::string text = syntax.name + "(";
      for (std::size_t i = 0; i < children.size(); ++i) text += (i > 0 ? ", " : "") + ToString(children[i]);
      return text + ")";
    }
    case SyntaxKind::kOperator: {
      const int level = Level(syntax);
      if (syntax.name == "not") return "not " + Inside(children[0], 5);
      if (children.size() == 1) return syntax.name + Inside(children[0], 9);
      std::string text;
      for (std::size_t i = 0; i < children.size(); ++i) {
        // Sums group to the left, "->" to the right; chains of "and" and "or" are one node.
        const bool groups = (syntax.name == "->" && i == 1) || (level >= 7 && i == 0);
        if (i > 0) text += " " + syntax.name + " ";
        text += Inside(children[i], groups ? level : level + 1);
      }
      return text;
    }
    case SyntaxKind::kTemporal: {
      const std::string name = syntax.name + TextOf(syntax.interval) + " ";
      if (children.size() == 2) return Inside(children[0], 5) + " " + name + Inside(children[1], 4);
      return name + Inside(children[0], 5);
    }
    case SyntaxKind::kBound: {
      std::string text = syntax.name;
      for (std::size_t i = 0; i < syntax.variables.size(); ++i) text += (i > 0 ? ", " : " ") + syntax.variables[i];
      const bool is_of_robots = syntax.domain == "robots";
      if (!is_of_robots) text += " in " + syntax.domain;
      if (syntax.pattern) text += (is_of_robots ? " in " : " ") + Quoted(*syntax.pattern);
      return text + ": " + ToString(children[0]);
    }
  }
  return {};
}

std::string ToString(const MetricSyntax& metric) {
  constexpr std::array<const char*, 6> kBeginnings{"time of first ", "time of last ", "min of ",
                                                   "max of ",        "mean of ",      "final of "};
  return kBeginnings[static_cast<std::size_t>(metric.kind)] + ToString(metric.of);
}

}  // namespace troupe
