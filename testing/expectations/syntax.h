// The syntax of expectations, and of the constraints of tests: a text as a tree, and a tree as text. What names mean is
// not known here (compile.h), so that the same grammar serves worlds and draws of cases.
//
//   formula    = or ["->" formula]
//   or         = and {"or" and}
//   and        = until {"and" until}
//   until      = unary [("until" [interval] | "since") until]
//   unary      = ("not" | ("always" | "eventually" | "historically" | "once") [interval] | "finally") unary
//              | comparison
//   comparison = sum [("<" | "<=" | ">" | ">=" | "==" | "!=") sum]
//   sum        = product {("+" | "-") product}
//   product    = factor {("*" | "/") factor}
//   factor     = "-" factor | number [unit] | text | name ["(" [formula {"," formula}] ")"] | "(" formula ")" | bound
//   bound      = ("forall" | "exists" | "min" | "max" | "sum" | "mean" | "count") name {"," name} [domain] ":" formula
//   domain     = "in" (text | name [text])
//   interval   = "[" number [unit] "," (number [unit] | "end") "]"
//
// The grammar has one comparison without chains ("a < b < c" is an error), since a chain of robustnesses has no meaning
// that users agree on. Texts are bounded in bytes and depth: the parser is recursive, and a text may come from anyone.
// ToString and ParseFormula are inverse to each other; tests and the fuzz target `expectation` check it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// The error of a place in a text, as expectation.h says.
Error TextError(std::size_t offset, std::string message);

struct NumberSyntax {
  double value = 0.0;  // as written
  std::string unit;    // of kUnits; "ticks"; empty: none
};

// The units of the language, as they are written: factor to the SI unit, and exponents of its parts.
struct Dimension {
  std::int8_t metre = 0;
  std::int8_t second = 0;
  std::int8_t radian = 0;
  std::int8_t joule = 0;
  bool operator==(const Dimension&) const = default;
};
struct Unit {
  const char* name;
  double factor;
  Dimension dimension;
};
// Null for an unknown name. "ticks" has the factor 1: the caller knows how long a tick is.
const Unit* FindUnit(std::string_view name);
// "m", "m/s", "rad/s", "J", "" for a ratio; in SI units.
std::string ToString(const Dimension& dimension);

struct IntervalSyntax {
  NumberSyntax from;
  std::optional<NumberSyntax> to;  // nothing: the end of the run
  std::size_t offset = 0;
};

enum class SyntaxKind : std::uint8_t {
  kNumber,
  kText,      // name: without quotes
  kName,      // a name alone: a variable, a place, a robot, a signal without arguments
  kCall,      // name(children)
  kOperator,  // name: "and", "or", "not", "->", "<", ..., "+", "-" (one child: minus), "*", "/"
  kTemporal,  // name: "always", ..., "until", "since"
  kBound,     // name: "forall", ...; variables; one child
};

struct Syntax {
  SyntaxKind kind = SyntaxKind::kNumber;
  std::size_t offset = 0;  // of its first byte, of an operator: of the operator
  std::string name = {};
  NumberSyntax number = {};
  std::optional<IntervalSyntax> interval = {};
  std::vector<std::string> variables = {};
  std::string domain = "robots";  // of a quantifier: a table of the state
  std::size_t domain_offset = 0;
  std::optional<std::string> pattern = {};  // of names in the domain
  std::size_t pattern_offset = 0;
  std::vector<Syntax> children = {};

  bool Is(SyntaxKind its_kind, std::string_view its_name) const { return kind == its_kind && name == its_name; }
};

inline constexpr std::size_t kMaxExpectationLength = 8192;  // bytes
inline constexpr std::size_t kMaxExpectationDepth = 200;    // nested operators

// kPath: a name may be a path to a value of a scenario, as `vary` has them: "spawn[0].count".
enum class NameSyntax : std::uint8_t { kWord, kPath };
Result<Syntax> ParseFormula(std::string_view text, NameSyntax names = NameSyntax::kWord);

// Of a metric.
enum class MetricKind : std::uint8_t { kFirst, kLast, kMin, kMax, kMean, kFinal };
struct MetricSyntax {
  MetricKind kind = MetricKind::kFinal;
  Syntax of;
};
Result<MetricSyntax> ParseMetric(std::string_view text);

// In the language's own spelling, with the parentheses that it needs: reading it again gives the same tree.
std::string ToString(const Syntax& syntax);
std::string ToString(const MetricSyntax& metric);

}  // namespace troupe
