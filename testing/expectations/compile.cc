#include "testing/expectations/compile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "testing/expectations/names.h"
#include "testing/expectations/rewrite.h"

namespace troupe {
namespace {

constexpr Tick kMaxInterval = 1'000'000'000;  // ticks
constexpr std::size_t kMaxNodes = 20'000;
constexpr std::array<const char*, 5> kFunctions{"abs", "sqrt", "min", "max", "count"};

// What an expression is worth.
struct Value {
  std::size_t node = 0;
  ValueType type = ValueType::kTruth;
  Dimension dimension = {};
  bool is_plain = false;  // made of numbers without units: it has any unit
  std::string text = {};  // of a text
};

std::string NameOf(const Dimension& dimension) {
  constexpr std::array<std::pair<Dimension, const char*>, 7> kNames{{{{1, 0, 0, 0}, "a length"},
                                                                     {{0, 1, 0, 0}, "a time"},
                                                                     {{1, -1, 0, 0}, "a speed"},
                                                                     {{0, 0, 1, 0}, "an angle"},
                                                                     {{0, -1, 1, 0}, "a yaw rate"},
                                                                     {{0, 0, 0, 1}, "an energy"},
                                                                     {{0, -1, 0, 1}, "a power"}}};
  for (const auto& [its_dimension, name] : kNames) {
    if (its_dimension == dimension) return std::string(name) + " (" + ToString(dimension) + ")";
  }
  return dimension == Dimension{} ? "a number without unit" : "a quantity in " + ToString(dimension);
}

std::string NameOf(const Value& value) {
  if (value.type == ValueType::kTruth) return "a condition";
  if (value.type == ValueType::kText) return "a text";
  return NameOf(value.dimension);
}

Dimension Product(const Dimension& a, const Dimension& b, int sign) {
  const auto add = [&](int one, int other) {
    return static_cast<std::int8_t>(std::clamp(one + sign * other, -100, 100));
  };
  return {add(a.metre, b.metre), add(a.second, b.second), add(a.radian, b.radian), add(a.joule, b.joule)};
}

// Whether an operator in the formula looks into the future.
bool LooksAhead(const Syntax& syntax) {
  const bool ahead = syntax.kind == SyntaxKind::kTemporal && syntax.name != "once" && syntax.name != "historically" &&
                     syntax.name != "since";
  return ahead || std::any_of(syntax.children.begin(), syntax.children.end(), LooksAhead);
}

class Compiler {
 public:
  Compiler(std::string_view text, const ExpectationScope& scope) : names_(scope) {
    program_.text = text;
    program_.body_names = names_.bodies();
    program_.robots = scope.world.robots.size();
    program_.interval_ns = scope.world.interval_ns;
  }

  Result<MonitorProgram> Expectation() {
    Result<Syntax> parsed = ParseFormula(program_.text);
    if (!parsed.ok()) return parsed.error();
    Result<Syntax> expanded = Expanded(std::move(parsed).value());
    if (!expanded.ok()) return expanded.error();
    program_.formula = ToString(expanded.value());
    // Errors are found in the text as it is written, before it is changed.
    const Syntax checked = WithClosestPairs(expanded.value());
    RequireTruth(checked, Expression(checked));
    if (error_) return *error_;
    program_.nodes.clear();
    program_.variables.clear();
    Root(Normalized(std::move(expanded).value()));
    if (!error_) {
      if (const std::optional<std::size_t> history = History(program_.roots.size() - 1)) {
        program_.history = *history;
      }
    }
    return Finished();
  }

  Result<MonitorProgram> Metric() {
    Result<MetricSyntax> parsed = ParseMetric(program_.text);
    if (!parsed.ok()) return parsed.error();
    MetricSyntax metric = std::move(parsed).value();
    Result<Syntax> expanded = Expanded(std::move(metric.of));
    if (!expanded.ok()) return expanded.error();
    metric.of = std::move(expanded).value();
    program_.metric = metric.kind;
    program_.formula = ToString(metric);
    const bool is_time = metric.kind == MetricKind::kFirst || metric.kind == MetricKind::kLast;
    // Variables without a quantifier.
    Syntax bound;
    bound.kind = SyntaxKind::kBound;
    FindFreeVariables(metric.of, bound.variables);
    if (bound.variables.size() > 4) {
      return TextError(0, "found more than 4 variables without a quantifier, expected fewer");
    }
    bound.name = "min";
    if (metric.kind == MetricKind::kMin && bound.variables.size() == 2) {
      bound.children.push_back(metric.of);
      if (IsClosestPair(bound)) {
        metric.of = bound;
        bound.variables.clear();
      }
    }
    const std::vector<std::uint32_t> domain = names_.Domain(bound).value();  // without a pattern
    std::vector<std::size_t> variables;
    for (const std::string& name : bound.variables) variables.push_back(Bind(name, domain, DomainKind::kRobots));
    const Value value = Expression(metric.of);
    if (is_time) {
      RequireTruth(metric.of, value);
    } else if (!error_ && value.type != ValueType::kNumber) {
      Fail(metric.of, "found " + NameOf(value) + ", expected a number");
    }
    if (!error_ && !variables.empty() && metric.kind == MetricKind::kFinal) {
      Fail(metric.of,
           "found variables without a quantifier, expected 'min r: ...', 'mean r: ...' or the like: a final "
           "value is one number");
    }
    if (error_) return *error_;
    program_.value = value.node;
    if (variables.size() > 1) program_.counted = CountedLanes(Now(value.node).variables, Now(value.node).lanes);
    if (domain.size() < variables.size()) program_.counted = {SignalUse::kNone};
    program_.dimension = is_time ? Dimension{0, 1, 0, 0} : value.dimension;
    return Finished();
  }

 private:
  struct Scoped {
    std::string name;
    std::size_t variable;
    bool is_robot;
  };

  Node& Now(std::size_t node) { return program_.nodes[node]; }

  Result<MonitorProgram> Finished() {
    if (error_) return *error_;
    for (const Node& node : program_.nodes) program_.levels = std::max(program_.levels, node.level + 1);
    return std::move(program_);
  }

  // The first error counts. Values after it are of no use, but harmless.
  Value Fail(const Syntax& at, std::string message) {
    if (!error_) error_ = TextError(at.offset, std::move(message));
    return {};
  }
  Value Fail(Error error) {
    if (!error_) error_ = std::move(error);
    return {};
  }
  template <typename T>
  T Checked(Result<T> result) {
    if (result.ok()) return std::move(result).value();
    Fail(result.error());
    return {};
  }

  void RequireTruth(const Syntax& at, const Value& value) {
    if (!error_ && value.type != ValueType::kTruth) {
      Fail(at, "found " + NameOf(value) + ", expected a condition, such as a comparison");
    }
  }

  // Nodes.

  std::size_t Lanes(const std::vector<std::size_t>& variables) {
    std::size_t lanes = 1;
    for (const std::size_t variable : variables) {
      lanes *= program_.variables[variable].bodies.size();
      if (lanes > kMaxLanes) {
        if (!error_) {
          error_ = TextError(at_offset_, "found more than " + std::to_string(kMaxLanes) +
                                             " combinations of robots, expected fewer variables or a pattern of names");
        }
        return 1;
      }
    }
    return lanes;
  }

  // For each lane of `variables` the lane of those in `some` of them.
  std::vector<std::uint32_t> LaneMap(const std::vector<std::size_t>& variables, const std::vector<std::size_t>& some,
                                     std::size_t lanes) {
    std::vector<std::uint32_t> map(lanes);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      std::size_t rest = lane;
      std::size_t stride = 1;
      std::size_t result = 0;
      std::size_t next = some.size();
      for (std::size_t i = variables.size(); i-- > 0;) {
        const std::size_t size = program_.variables[variables[i]].bodies.size();
        if (next > 0 && some[next - 1] == variables[i]) {
          result += rest % size * stride;
          stride *= size;
          --next;
        }
        rest /= size;
      }
      map[lane] = static_cast<std::uint32_t>(result);
    }
    return map;
  }

  // Sets the variables, lanes and inputs of a node or root from its inputs.
  template <typename AnyNode, typename Source>
  void Connect(AnyNode& node, const std::vector<std::size_t>& inputs, const std::vector<Source>& sources) {
    for (const std::size_t input : inputs) {
      std::vector<std::size_t> all;
      std::set_union(node.variables.begin(), node.variables.end(), sources[input].variables.begin(),
                     sources[input].variables.end(), std::back_inserter(all));
      node.variables = std::move(all);
    }
    node.lanes = Lanes(node.variables);
    if (error_) return;
    for (const std::size_t input : inputs) {
      Input connection{input, {}};
      const std::vector<std::size_t>& its = sources[input].variables;
      if (its != node.variables && sources[input].lanes != 1)
        connection.lane_of = LaneMap(node.variables, its, node.lanes);
      node.inputs.push_back(std::move(connection));
    }
  }

  std::size_t Add(Node node) {
    if (program_.nodes.size() >= kMaxNodes && !error_) {
      error_ = TextError(at_offset_, "found too many operators, expected a shorter expectation");
    }
    if (error_ && !program_.nodes.empty()) return 0;
    program_.nodes.push_back(std::move(node));
    return program_.nodes.size() - 1;
  }

  std::size_t Constant(double number) {
    Node node;
    node.number = number;
    return Add(std::move(node));
  }

  std::size_t Make(Op op, std::vector<std::size_t> inputs, Node node = {}) {
    if (error_) return 0;
    Align(inputs);
    node.op = op;
    Connect(node, inputs, program_.nodes);
    if (error_) return 0;
    for (const std::size_t input : inputs) {
      const Node& source = program_.nodes[input];
      node.names_cause = node.names_cause || source.names_cause;
      if (source.op == Op::kConstant) continue;
      node.delay = source.delay;
      node.level = source.level;
    }
    return Add(std::move(node));
  }

  // Replaces nodes by ones of equal levels and delays.
  void Align(std::vector<std::size_t>& nodes) {
    std::size_t level = 0;
    for (const std::size_t node : nodes) level = std::max(level, Now(node).level);
    Tick delay = 0;
    for (std::size_t& node : nodes) {
      if (Now(node).op == Op::kConstant) continue;
      if (Now(node).level < level) node = PlayedBack(Op::kPlayback, {node}, level, 0);
      delay = std::max(delay, Now(node).delay);
    }
    for (std::size_t& node : nodes) {
      if (Now(node).op == Op::kConstant || Now(node).delay == delay) continue;
      Node later;
      later.op = Op::kDelay;
      later.ticks = delay - Now(node).delay;
      later.delay = delay;
      later.level = level;
      Connect(later, {node}, program_.nodes);
      node = Add(std::move(later));
    }
  }

  // Inputs of one level and delay.
  std::size_t PlayedBack(Op op, const std::vector<std::size_t>& inputs, std::size_t level, Tick from) {
    if (error_) return 0;
    Node node;
    node.op = op;
    node.level = level;
    node.window.from = from;
    for (const std::size_t input : inputs) Now(input).recorded = true;
    Connect(node, inputs, program_.nodes);
    return Add(std::move(node));
  }

  std::size_t AfterTheRun(Op op, std::vector<std::size_t> inputs, Tick from) {
    if (error_) return 0;
    Align(inputs);
    std::size_t level = 0;
    for (const std::size_t input : inputs) level = std::max(level, Now(input).level);
    return PlayedBack(op, inputs, level + 1, from);
  }

  // Bound variables.

  std::size_t Bind(const std::string& name, const std::vector<std::uint32_t>& bodies, DomainKind kind) {
    program_.variables.push_back({name, bodies});
    scoped_.push_back({name, program_.variables.size() - 1, kind == DomainKind::kRobots});
    return program_.variables.size() - 1;
  }

  // The lanes of `variables` in which all stand for different bodies. All domains are equal.
  std::vector<std::uint32_t> CountedLanes(const std::vector<std::size_t>& variables, std::size_t lanes) {
    std::vector<std::uint32_t> counted;
    if (variables.size() < 2) return counted;
    std::vector<std::size_t> digits(variables.size());
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      std::size_t rest = lane;
      bool differ = true;
      for (std::size_t i = variables.size(); i-- > 0;) {
        const std::size_t size = program_.variables[variables[i]].bodies.size();
        digits[i] = rest % size;
        rest /= size;
        for (std::size_t j = i + 1; j < digits.size(); ++j) differ = differ && digits[i] != digits[j];
      }
      if (differ) counted.push_back(static_cast<std::uint32_t>(lane));
    }
    return counted;
  }

  // Sets the parts of a reduction over `bound` variables, of a node or root with one input.
  template <typename AnyNode>
  void Reduce(AnyNode& node, const std::vector<std::size_t>& bound, const AnyNode& source) {
    for (const std::size_t variable : source.variables) {
      const bool is_bound = std::find(bound.begin(), bound.end(), variable) != bound.end();
      (is_bound ? node.reduced_variables : node.variables).push_back(variable);
    }
    node.lanes = Lanes(node.variables);
    node.reduced = Lanes(node.reduced_variables);
    node.counted = CountedLanes(node.reduced_variables, node.reduced);
    node.level = source.level;
  }

  // Binds the variables of a quantifier, and calls compile(variables) for its body; `empty`: what it is worth if
  // there are not enough bodies for its variables.
  template <typename Result, typename Compile, typename Empty>
  Result WithVariables(const Syntax& bound, const Compile& compile, const Empty& empty) {
    const std::vector<std::uint32_t> domain = Checked(names_.Domain(bound));
    if (error_) return {};
    std::vector<std::size_t> variables;
    for (const std::string& name : bound.variables) variables.push_back(Bind(name, domain, bound.domain));
    at_offset_ = bound.offset;
    Result result = compile(variables);
    scoped_.resize(scoped_.size() - variables.size());
    for (const std::string& name : bound.variables) {
      if (!error_ && !Mentions(bound.children[0], name)) {
        Fail(bound, "found the variable '" + name + "' that is not used, expected it in the formula behind ':'");
      }
    }
    if (!error_ && domain.size() < variables.size()) return empty(result);
    return result;
  }

  Value Quantifier(const Syntax& syntax) {
    struct Kind {
      const char* name;
      Op op;
      double of_none;
    };
    constexpr std::array<Kind, 7> kKinds{{{"forall", Op::kForall, kInfinity},
                                          {"exists", Op::kExists, -kInfinity},
                                          {"min", Op::kMinimum, kInfinity},
                                          {"max", Op::kMaximum, -kInfinity},
                                          {"sum", Op::kSum, 0.0},
                                          {"mean", Op::kMean, std::numeric_limits<double>::quiet_NaN()},
                                          {"count", Op::kCount, 0.0}}};
    const Kind& kind =
        *std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& k) { return syntax.name == k.name; });
    if (IsClosestPair(syntax)) return ClosestPair(syntax);
    const bool of_truth = kind.op == Op::kForall || kind.op == Op::kExists || kind.op == Op::kCount;
    return WithVariables<Value>(
        syntax,
        [&](const std::vector<std::size_t>& variables) {
          Value value = Expression(syntax.children[0]);
          if (error_) return value;
          if (of_truth) {
            RequireTruth(syntax.children[0], value);
          } else if (value.type != ValueType::kNumber) {
            return Fail(syntax.children[0], "found " + NameOf(value) + ", expected a number for '" + syntax.name + "'");
          }
          if (kind.op == Op::kCount) value = {value.node, ValueType::kNumber, {}, false, {}};
          if (error_) return value;
          Node node;
          node.op = kind.op;
          const Node& source = Now(value.node);
          Reduce(node, variables, source);
          node.inputs.push_back({value.node, {}});
          node.delay = source.delay;
          node.names_cause = true;
          value.node = Add(std::move(node));
          return value;
        },
        [&](Value value) {
          value.node = Constant(kind.of_none);
          return value;
        });
  }

  Value ClosestPair(const Syntax& syntax) {
    const std::vector<std::uint32_t> domain = Checked(names_.Domain(syntax));
    Node node;
    if (domain.size() >= 2) {
      node.op = Op::kSignal;
      node.signal.kind = SignalKind::kClosestPair;
      node.signal.subjects = domain;
      node.signal.others = domain;
      node.names_cause = true;
    } else {
      node.number = kInfinity;
    }
    return {Add(std::move(node)), ValueType::kNumber, {1, 0, 0, 0}, false, {}};
  }

  // Intervals.

  double Seconds() const { return static_cast<double>(program_.interval_ns) * 1e-9; }

  // In ticks, rounded to a whole number in the direction of the interval's inside.
  Tick Ticks(const IntervalSyntax& at, const NumberSyntax& time, const NumberSyntax& other, bool is_end) {
    Syntax place;
    place.offset = at.offset;
    const std::string& unit = time.unit.empty() ? other.unit : time.unit;
    double ticks = time.value;
    if (unit == "ticks") {
      if (ticks != std::floor(ticks)) Fail(place, "found a part of a tick, expected a whole number of ticks");
    } else {
      const Unit* const known = FindUnit(unit.empty() ? "s" : unit);
      if (known->dimension != Dimension{0, 1, 0, 0}) {
        Fail(place, "found " + NameOf(known->dimension) + " in an interval, expected times in s or ticks");
      }
      ticks = time.value * known->factor / Seconds();
      const double nearest = std::round(ticks);
      ticks = std::abs(ticks - nearest) <= 1e-6 ? nearest : is_end ? std::floor(ticks) : std::ceil(ticks);
    }
    if (!(ticks <= static_cast<double>(kMaxInterval))) {
      Fail(place, "found an interval beyond " + std::to_string(kMaxInterval) + " ticks, expected a shorter one");
      return 0;
    }
    return static_cast<Tick>(ticks);
  }

  TickWindow Window(const Syntax& temporal) {
    if (!temporal.interval) return {};
    const IntervalSyntax& interval = *temporal.interval;
    TickWindow window;
    window.from = Ticks(interval, interval.from, interval.to.value_or(interval.from), false);
    if (!interval.to) return window;
    window.to = Ticks(interval, *interval.to, interval.from, true);
    Syntax place;
    place.offset = interval.offset;
    if (!error_ && window.from > window.to) {
      Fail(place, "found an interval without a tick in it (a tick is " + PlainNumber(Seconds()) +
                      " s), expected its end not before its beginning");
    }
    return window;
  }

  static std::string PlainNumber(double number) {
    Syntax syntax;
    syntax.number.value = number;
    return ToString(syntax);
  }

  // Formulas.

  Value TruthOf(std::size_t node) { return {node, ValueType::kTruth, {}, false, {}}; }

  std::size_t Truth(const Syntax& syntax) {
    const Value value = Expression(syntax);
    RequireTruth(syntax, value);
    return value.node;
  }

  std::size_t AlwaysOrEventually(const Syntax& syntax, bool is_always) {
    const std::size_t inner = Truth(syntax.children[0]);
    const TickWindow window = Window(syntax);
    return Windowed(is_always, window, inner);
  }

  std::size_t Windowed(bool is_always, const TickWindow& window, std::size_t inner) {
    if (error_) return 0;
    if (!window.has_end()) return AfterTheRun(is_always ? Op::kSuffixMin : Op::kSuffixMax, {inner}, window.from);
    Node node;
    node.window = window;
    const std::size_t made = Make(is_always ? Op::kWindowMin : Op::kWindowMax, {inner}, std::move(node));
    if (!error_) Now(made).delay += window.to;
    return made;
  }

  Value Temporal(const Syntax& syntax) {
    const std::string& name = syntax.name;
    if (name == "always" || name == "eventually") return TruthOf(AlwaysOrEventually(syntax, name == "always"));
    if (name == "finally") return TruthOf(AfterTheRun(Op::kLastValue, {Truth(syntax.children[0])}, 0));
    if (name == "since") {
      const std::size_t left = Truth(syntax.children[0]);
      return TruthOf(Make(Op::kSince, {left, Truth(syntax.children[1])}));
    }
    if (name == "until") {
      const std::size_t left = Truth(syntax.children[0]);
      const std::size_t right = Truth(syntax.children[1]);
      const TickWindow window = Window(syntax);
      if (error_) return {};
      // It holds on the left before the window begins, and the rest of the way inside of it.
      std::size_t rest = 0;
      if (window.has_end()) {
        Node node;
        node.window = window;
        rest = Make(Op::kUntil, {left, right}, std::move(node));
        if (!error_) Now(rest).delay += window.to;
      } else {
        rest = AfterTheRun(Op::kSuffixUntil, {left, right}, window.from);
      }
      if (window.from == 0 || error_) return TruthOf(rest);
      return TruthOf(Make(Op::kAnd, {Windowed(true, {0, window.from - 1}, left), rest}));
    }
    const bool is_min = name == "historically";
    std::size_t inner = Truth(syntax.children[0]);
    const TickWindow window = Window(syntax);
    if (error_) return {};
    if (window.from > 0) {
      Node shift;
      shift.ticks = window.from;
      shift.number = is_min ? kInfinity : -kInfinity;
      inner = Make(Op::kPastShift, {inner}, std::move(shift));
    }
    Node node;
    node.ticks = window.has_end() ? window.to - window.from : kForever;
    return TruthOf(Make(is_min ? Op::kPastMin : Op::kPastMax, {inner}, std::move(node)));
  }

  Value Comparison(const Syntax& syntax, const Value& left, const Value& right) {
    const std::string& name = syntax.name;
    const bool is_equality = name == "==" || name == "!=";
    if (left.type != right.type) {
      return Fail(syntax, "found " + NameOf(left) + " compared with " + NameOf(right) + ", expected two numbers");
    }
    if (left.type == ValueType::kTruth) {
      return Fail(syntax,
                  "found conditions compared by '" + name + "', expected numbers; 'a -> b' and 'not' join conditions");
    }
    if (left.type == ValueType::kText) {
      const bool hash_left = left.text.empty();
      if (hash_left == right.text.empty() || !is_equality) {
        return Fail(syntax, "found texts compared, expected hash == \"...\" or hash != \"...\"");
      }
      const std::string& digits = hash_left ? right.text : left.text;
      const bool is_hash = digits.size() == 16 && digits.find_first_not_of("0123456789abcdef") == std::string::npos;
      if (!is_hash) {
        return Fail(syntax, "found the hash '" + PlainLine(digits, 40) + "', expected 16 digits of 0 to 9 and a to f");
      }
      Node node;
      node.op = Op::kSignal;
      node.signal.kind = SignalKind::kHash;
      node.signal.text = digits;
      node.signal.negated = name == "!=";
      return TruthOf(Add(std::move(node)));
    }
    RequireSameUnit(syntax, left, right, "compared with");
    if (error_) return {};
    if (name == ">") return TruthOf(Make(Op::kGreater, {left.node, right.node}));
    if (name == ">=") return TruthOf(Make(Op::kAtLeast, {left.node, right.node}));
    if (name == "<") return TruthOf(Make(Op::kGreater, {right.node, left.node}));
    if (name == "<=") return TruthOf(Make(Op::kAtLeast, {right.node, left.node}));
    return TruthOf(Make(name == "==" ? Op::kEqual : Op::kUnequal, {left.node, right.node}));
  }

  void RequireSameUnit(const Syntax& syntax, const Value& left, const Value& right, const std::string& verb) {
    if (error_ || left.is_plain || right.is_plain || left.dimension == right.dimension) return;
    Fail(syntax, "found " + NameOf(left) + " " + verb + " " + NameOf(right) + ", expected one unit on both sides");
  }

  Value Operator(const Syntax& syntax) {
    const std::string& name = syntax.name;
    if (name == "not") return TruthOf(Make(Op::kNot, {Truth(syntax.children[0])}));
    if (name == "and" || name == "or" || name == "->") {
      std::vector<std::size_t> inputs;
      for (const Syntax& child : syntax.children) inputs.push_back(Truth(child));
      if (name == "->" && !error_) inputs[0] = Make(Op::kNot, {inputs[0]});
      return TruthOf(Make(name == "and" ? Op::kAnd : Op::kOr, std::move(inputs)));
    }
    const Value left = Expression(syntax.children[0]);
    if (error_) return {};
    if (syntax.children.size() == 1) {  // minus
      if (left.type != ValueType::kNumber)
        return Fail(syntax, "found '-' before " + NameOf(left) + ", expected a number");
      return {Make(Op::kNegate, {left.node}), ValueType::kNumber, left.dimension, left.is_plain, {}};
    }
    const Value right = Expression(syntax.children[1]);
    if (error_) return {};
    const bool is_product = name == "*" || name == "/";
    if (!is_product && name != "+" && name != "-") return Comparison(syntax, left, right);
    if (left.type != ValueType::kNumber || right.type != ValueType::kNumber) {
      const Value& wrong = left.type != ValueType::kNumber ? left : right;
      return Fail(syntax, "found '" + name + "' with " + NameOf(wrong) + ", expected two numbers");
    }
    const bool is_plain = left.is_plain && right.is_plain;
    if (is_product) {
      const Op op = name == "*" ? Op::kMultiply : Op::kDivide;
      return {Make(op, {left.node, right.node}),
              ValueType::kNumber,
              Product(left.dimension, right.dimension, name == "*" ? 1 : -1),
              is_plain,
              {}};
    }
    RequireSameUnit(syntax, left, right, name == "+" ? "added to" : "in a difference with");
    if (error_) return {};
    const Dimension dimension = left.is_plain ? right.dimension : left.dimension;
    return {Make(name == "+" ? Op::kAdd : Op::kSubtract, {left.node, right.node}),
            ValueType::kNumber,
            dimension,
            is_plain,
            {}};
  }

  Value Expression(const Syntax& syntax) {
    if (error_) return {};
    at_offset_ = syntax.offset;
    switch (syntax.kind) {
      case SyntaxKind::kNumber: {
        const Unit* const unit = syntax.number.unit.empty() ? nullptr : FindUnit(syntax.number.unit);
        double factor = unit == nullptr ? 1.0 : unit->factor;
        if (syntax.number.unit == "ticks") factor = Seconds();
        return {Constant(syntax.number.value * factor),
                ValueType::kNumber,
                unit == nullptr ? Dimension{} : unit->dimension,
                unit == nullptr,
                {}};
      }
      case SyntaxKind::kText: {
        if (syntax.name.empty()) return Fail(syntax, "found an empty text, expected characters between the quotes");
        Value value;
        value.type = ValueType::kText;
        value.text = syntax.name;
        return value;
      }
      case SyntaxKind::kName:
        if (syntax.name == "true" || syntax.name == "false") {
          return TruthOf(Constant(syntax.name == "true" ? kInfinity : -kInfinity));
        }
        return Call(syntax);
      case SyntaxKind::kCall:
        return Call(syntax);
      case SyntaxKind::kOperator:
        return Operator(syntax);
      case SyntaxKind::kTemporal:
        return Temporal(syntax);
      case SyntaxKind::kBound:
        return Quantifier(syntax);
    }
    return {};
  }

  // Signals and functions.

  Value Call(const Syntax& syntax) {
    for (const char* const function : kFunctions) {
      if (syntax.Is(SyntaxKind::kCall, function)) return Function(syntax);
    }
    const std::span<const SignalInfo> signals = Signals();
    const auto found =
        std::find_if(signals.begin(), signals.end(), [&](const SignalInfo& info) { return syntax.name == info.name; });
    if (found != signals.end()) return Signal(syntax, *found);
    std::vector<std::string> names;
    for (const SignalInfo& info : signals) names.emplace_back(info.name);
    for (const char* const function : kFunctions) names.emplace_back(function);
    for (const Shorthand& shorthand : Shorthands()) names.emplace_back(shorthand.name);
    const bool is_variable =
        std::any_of(scoped_.begin(), scoped_.end(), [&](const Scoped& scoped) { return scoped.name == syntax.name; });
    if (is_variable) {
      return Fail(syntax, "found the variable '" + syntax.name + "' alone, expected a signal of it, such as x(" +
                              syntax.name + ")");
    }
    return Fail(syntax, "found '" + PlainLine(syntax.name, 40) +
                            "', expected a signal or a function (docs/testing.md " + "lists them)" +
                            DidYouMean(syntax.name, names));
  }

  Value Function(const Syntax& syntax) {
    const std::string& name = syntax.name;
    const std::vector<Syntax>& arguments = syntax.children;
    const std::size_t count = name == "min" || name == "max" ? 2 : 1;
    if (arguments.size() != count) {
      return Fail(syntax, "found " + std::to_string(arguments.size()) + " arguments of '" + name + "', expected " +
                              std::to_string(count));
    }
    if (name == "count") {
      if (!arguments[0].Is(SyntaxKind::kCall, "event")) {
        return Fail(arguments[0],
                    "found no event in 'count(...)', expected count(event(TYPE)); 'count r: ...' counts robots");
      }
      const Value value = Call(arguments[0]);
      if (error_) return {};
      Now(value.node).signal.kind = SignalKind::kEventCount;
      return {value.node, ValueType::kNumber, {}, false, {}};
    }
    std::vector<Value> values;
    for (const Syntax& argument : arguments) {
      values.push_back(Expression(argument));
      if (error_) return {};
      if (values.back().type != ValueType::kNumber) {
        return Fail(argument, "found " + NameOf(values.back()) + ", expected a number for '" + name + "'");
      }
    }
    Value value = values[0];
    if (name == "abs") {
      value.node = Make(Op::kAbsolute, {value.node});
    } else if (name == "sqrt") {
      const Dimension& squared = value.dimension;
      if (squared.metre % 2 != 0 || squared.second % 2 != 0 || squared.radian % 2 != 0 || squared.joule % 2 != 0) {
        return Fail(syntax, "found the square root of " + NameOf(value) + ", expected a square such as m^2");
      }
      value.dimension = {static_cast<std::int8_t>(squared.metre / 2), static_cast<std::int8_t>(squared.second / 2),
                         static_cast<std::int8_t>(squared.radian / 2), static_cast<std::int8_t>(squared.joule / 2)};
      value.node = Make(Op::kSquareRoot, {value.node});
    } else {
      RequireSameUnit(syntax, values[0], values[1], "beside");
      if (values[0].is_plain) value.dimension = values[1].dimension;
      value.is_plain = values[0].is_plain && values[1].is_plain;
      value.node = Make(name == "min" ? Op::kSmaller : Op::kLarger, {values[0].node, values[1].node});
    }
    return value;
  }

  // A body in an argument: of a variable, or one for all lanes.
  struct BodyArgument {
    std::optional<std::size_t> variable = {};
    std::uint32_t body = 0;
  };

  std::optional<BodyArgument> FindBodyArgument(const Syntax& argument, char parameter) {
    const bool wants_robot = parameter == 'r';
    const bool wants_object = parameter == 'o';
    const std::string expected = wants_robot ? "a robot" : wants_object ? "an object" : "a robot or object";
    const auto check = [&](bool is_robot) {
      if ((wants_robot && !is_robot) || (wants_object && is_robot)) {
        Fail(argument, "found '" + argument.name + "', which is " + (is_robot ? "a robot" : "an object") +
                           ", expected " + expected);
      }
    };
    if (argument.kind == SyntaxKind::kName) {
      for (auto scoped = scoped_.rbegin(); scoped != scoped_.rend(); ++scoped) {
        if (scoped->name != argument.name) continue;
        check(scoped->is_robot);
        return BodyArgument{scoped->variable, 0};
      }
    }
    if (argument.kind == SyntaxKind::kName || argument.kind == SyntaxKind::kText) {
      if (const std::optional<std::uint32_t> body = names_.FindBody(argument.name)) {
        check(names_.is_robot(*body));
        return BodyArgument{{}, *body};
      }
    }
    return std::nullopt;
  }

  BodyArgument Body(const Syntax& argument, char parameter) {
    if (const std::optional<BodyArgument> found = FindBodyArgument(argument, parameter)) return *found;
    std::vector<std::string> names;
    for (const Scoped& scoped : scoped_) names.push_back(scoped.name);
    if (parameter != 'o') {
      for (std::string& name : names_.RobotNames()) names.push_back(std::move(name));
    }
    if (parameter != 'r') {
      for (std::string& name : names_.ObjectNames()) names.push_back(std::move(name));
    }
    const std::string expected = parameter == 'r' ? "a robot" : parameter == 'o' ? "an object" : "a robot or object";
    Fail(WorldNames::Unknown(argument, "a variable or " + expected, names));
    return {};
  }

  // The arguments of a signal that are no bodies.
  void PlainArgument(const Syntax& argument, char parameter, SignalUse& signal) {
    const bool is_named = argument.kind == SyntaxKind::kName || argument.kind == SyntaxKind::kText;
    if (parameter == 'l') {
      const Unit* const unit = argument.number.unit.empty() ? nullptr : FindUnit(argument.number.unit);
      const bool is_length =
          argument.kind == SyntaxKind::kNumber && (unit == nullptr || unit->dimension == Dimension{1, 0, 0, 0});
      if (!is_length) Fail(argument, "found something else, expected a length such as 0.2 m");
      signal.number = argument.number.value * (unit == nullptr ? 1.0 : unit->factor);
      return;
    }
    if (parameter == 'p') {
      const NamedPlace* const place = is_named ? names_.FindPlace(argument.name) : nullptr;
      if (place == nullptr) {
        Fail(WorldNames::Unknown(argument, "a place", names_.PlaceNames()));
        return;
      }
      signal.point = place->X_WN.translation();
      return;
    }
    if (parameter == 'g') {
      const NamedRegion* const region = is_named ? names_.FindRegion(argument.name) : nullptr;
      if (region == nullptr) {
        Fail(WorldNames::Unknown(argument, "a region", names_.RegionNames()));
        return;
      }
      signal.region = region->outline;
      return;
    }
    if (parameter == 'e') {
      std::vector<std::string> types;
      for (int i = 0; i <= static_cast<int>(LastOf(EventType{})); ++i) {
        types.emplace_back(ToString(static_cast<EventType>(i)));
        if (!is_named || types.back() != argument.name) continue;
        signal.event = static_cast<EventType>(i);
        return;
      }
      Fail(WorldNames::Unknown(argument, "a type of event", types));
      return;
    }
    if (argument.kind != SyntaxKind::kText) {
      Fail(argument, "found something else, expected a text in quotes");
      return;
    }
    if (parameter == 'x') signal.text = argument.name;
  }

  // The second argument of distance: a body, a static model or a place.
  std::optional<BodyArgument> DistanceTarget(const Syntax& argument, SignalUse& signal) {
    if (const std::optional<BodyArgument> body = FindBodyArgument(argument, 'd')) return body;
    if (argument.kind == SyntaxKind::kName || argument.kind == SyntaxKind::kText) {
      if (const NamedPlace* const place = names_.FindPlace(argument.name)) {
        signal.point = place->X_WN.translation();
        return std::nullopt;
      }
      if (const std::optional<ModelId> model = names_.FindStaticModel(argument.name)) {
        const WorldDescription& world = names_.world();
        for (std::size_t i = 0; i < world.models.size(); ++i) {
          if (!IsInTree(world, ModelId(i), *model)) continue;
          if (world.shape(world.models[i].shape).area) {
            Fail(argument, "found the dense map '" + argument.name + "', expected a model with an outline");
          }
        }
        for (std::uint32_t body = 0; body < names_.bodies().size(); ++body) {
          const ModelId root =
              names_.is_robot(body) ? world.robots[body].root : world.objects[body - world.robots.size()];
          if (IsInTree(world, *model, root)) {
            Fail(argument, "found a part of '" + names_.bodies()[body] + "', expected the robot or object as a whole");
          }
        }
        signal.model = *model;
        return std::nullopt;
      }
    }
    std::vector<std::string> names = names_.bodies();
    for (std::string& name : names_.PlaceNames()) names.push_back(std::move(name));
    for (const ModelDescription& model : names_.world().models) {
      if (!model.removed && !model.parent) names.push_back(model.name);
    }
    Fail(WorldNames::Unknown(argument, "a variable, robot, object, model or place", names));
    return std::nullopt;
  }

  Value Signal(const Syntax& syntax, const SignalInfo& info) {
    const std::string_view parameters = info.parameters;
    const std::size_t optional = parameters.find('?');
    const std::size_t most = parameters.size() - (optional == std::string_view::npos ? 0 : 1);
    const std::size_t least = std::min(optional, most);
    const std::vector<Syntax>& arguments = syntax.children;
    if (arguments.size() < least || arguments.size() > most) {
      return Fail(syntax, "found " + std::to_string(arguments.size()) + " arguments of '" + syntax.name +
                              "', expected " + info.usage);
    }
    if (info.kind == SignalKind::kHash) {
      Value value;
      value.type = ValueType::kText;
      return value;
    }
    Node node;
    node.op = Op::kSignal;
    node.signal.kind = info.kind;
    if (info.kind == SignalKind::kAt) node.signal.number = 0.2;
    std::vector<BodyArgument> bodies;
    const Syntax* part = nullptr;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      const char parameter = parameters[i + (i >= optional ? 1 : 0)];
      if (parameter == 'd') {
        if (const std::optional<BodyArgument> body = DistanceTarget(arguments[i], node.signal)) bodies.push_back(*body);
      } else if (parameter == 'r' || parameter == 'o' || parameter == 'b') {
        bodies.push_back(Body(arguments[i], parameter));
      } else {
        PlainArgument(arguments[i], parameter, node.signal);
        if (parameter == 'j' || parameter == 's') part = &arguments[i];
      }
      if (error_) return {};
    }
    for (const BodyArgument& body : bodies) {
      if (body.variable) node.variables.push_back(*body.variable);
    }
    std::sort(node.variables.begin(), node.variables.end());
    node.variables.erase(std::unique(node.variables.begin(), node.variables.end()), node.variables.end());
    node.lanes = Lanes(node.variables);
    if (error_) return {};
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      std::vector<std::uint32_t>& by_lane = i == 0 ? node.signal.subjects : node.signal.others;
      if (!bodies[i].variable) {
        by_lane.assign(node.lanes, bodies[i].body);
        continue;
      }
      by_lane = LaneMap(node.variables, {*bodies[i].variable}, node.lanes);
      for (std::uint32_t& body : by_lane) body = program_.variables[*bodies[i].variable].bodies[body];
    }
    Value value{0, info.type, info.dimension, false, {}};
    FindParts(syntax, info, part, node.signal, value.dimension);
    if (error_) return {};
    value.node = Add(std::move(node));
    return value;
  }

  // Joints, stores and sensors of the robots, by lane.
  void FindParts(const Syntax& syntax, const SignalInfo& info, const Syntax* part, SignalUse& signal,
                 Dimension& dimension) {
    bool is_first = true;
    bool turns = false;
    for (const std::uint32_t robot : signal.subjects) {
      if (error_) return;
      switch (info.kind) {
        case SignalKind::kJoint:
        case SignalKind::kJointSpeed:
        case SignalKind::kBlocked: {
          signal.parts.push_back(Checked(names_.FindJoint(robot, *part)));
          if (error_) return;
          const bool its = names_.world().joints[signal.parts.back()].type == JointType::kRevolute;
          if (!is_first && its != turns && info.kind != SignalKind::kBlocked) {
            Fail(*part, "found joints that turn and joints that shift, expected joints of one unit");
          }
          turns = its;
          is_first = false;
          break;
        }
        case SignalKind::kAlive:
          signal.parts.push_back(names_.FindFiniteStore(robot));
          break;
        case SignalKind::kEnergy:
        case SignalKind::kCapacity:
        case SignalKind::kCharging:
          signal.parts.push_back(Checked(names_.FindStore(robot, syntax)));
          break;
        case SignalKind::kRange:
        case SignalKind::kMeanRange:
        case SignalKind::kPressed:
        case SignalKind::kHeard:
          signal.parts.push_back(Checked(names_.FindSensor(robot, info.kind, part, syntax)));
          break;
        default:
          return;
      }
    }
    if (turns && info.kind != SignalKind::kBlocked) {
      dimension.radian = dimension.metre;
      dimension.metre = 0;
    }
  }

  // The part of a formula that is judged at the first tick.

  std::size_t AddRoot(RootNode root) {
    program_.roots.push_back(std::move(root));
    return program_.roots.size() - 1;
  }

  std::size_t Root(const Syntax& syntax) {
    if (error_) return 0;
    at_offset_ = syntax.offset;
    const bool is_not = syntax.Is(SyntaxKind::kOperator, "not");
    const bool is_and = syntax.Is(SyntaxKind::kOperator, "and");
    if (!LooksAhead(syntax)) return RootOf(RootOp::kValue, {Truth(syntax)}, {});
    if (is_not || is_and || syntax.Is(SyntaxKind::kOperator, "or")) {
      std::vector<std::size_t> inputs;
      for (const Syntax& child : syntax.children) inputs.push_back(Root(child));
      RootNode root;
      root.op = is_not ? RootOp::kNot : is_and ? RootOp::kAnd : RootOp::kOr;
      if (!error_) Connect(root, inputs, program_.roots);
      return AddRoot(std::move(root));
    }
    const bool is_forall = syntax.Is(SyntaxKind::kBound, "forall");
    if (is_forall || syntax.Is(SyntaxKind::kBound, "exists")) {
      return WithVariables<std::size_t>(
          syntax,
          [&](const std::vector<std::size_t>& variables) {
            const std::size_t inner = Root(syntax.children[0]);
            RootNode root;
            root.op = is_forall ? RootOp::kForall : RootOp::kExists;
            if (error_) return inner;
            Reduce(root, variables, program_.roots[inner]);
            root.inputs.push_back({inner, {}});
            return AddRoot(std::move(root));
          },
          [&](std::size_t) { return RootOf(RootOp::kValue, {Constant(is_forall ? kInfinity : -kInfinity)}, {}); });
    }
    if (syntax.kind == SyntaxKind::kTemporal) {
      const std::string& name = syntax.name;
      if (name == "always" || name == "eventually") {
        const std::size_t inner = Truth(syntax.children[0]);
        return RootOf(name == "always" ? RootOp::kAlways : RootOp::kEventually, {inner}, Window(syntax));
      }
      if (name == "finally") return RootOf(RootOp::kFinally, {Truth(syntax.children[0])}, {});
      if (name == "until") {
        const std::size_t left = Truth(syntax.children[0]);
        const std::size_t right = Truth(syntax.children[1]);
        return RootOf(RootOp::kUntil, {left, right}, Window(syntax));
      }
    }
    return RootOf(RootOp::kValue, {Truth(syntax)}, {});
  }

  std::size_t RootOf(RootOp op, std::vector<std::size_t> nodes, const TickWindow& window) {
    if (error_) return 0;
    Align(nodes);
    RootNode root;
    root.op = op;
    root.window = window;
    Connect(root, nodes, program_.nodes);
    for (const std::size_t node : nodes) root.level = std::max(root.level, Now(node).level);
    return AddRoot(std::move(root));
  }

  // The formula without its outermost temporal operators, as a node; nothing if it has none.
  std::optional<std::size_t> History(std::size_t number) {
    const RootNode root = program_.roots[number];
    switch (root.op) {
      case RootOp::kValue:
        return std::nullopt;
      case RootOp::kAlways:
      case RootOp::kEventually:
      case RootOp::kFinally:
        return root.inputs[0].node;
      case RootOp::kUntil:
        return Make(Op::kOr, {root.inputs[0].node, root.inputs[1].node});
      case RootOp::kNot:
      case RootOp::kAnd:
      case RootOp::kOr: {
        std::vector<std::size_t> inputs;
        for (const Input& input : root.inputs) {
          if (const std::optional<std::size_t> node = History(input.node)) inputs.push_back(*node);
        }
        if (inputs.empty()) return std::nullopt;
        return Make(root.op == RootOp::kNot   ? Op::kNot
                    : root.op == RootOp::kAnd ? Op::kAnd
                                              : Op::kOr,
                    std::move(inputs));
      }
      case RootOp::kForall:
      case RootOp::kExists: {
        const std::optional<std::size_t> inner = History(root.inputs[0].node);
        if (!inner) return std::nullopt;
        Node node;
        node.op = root.op == RootOp::kForall ? Op::kForall : Op::kExists;
        const Node& source = Now(*inner);
        Reduce(node, root.reduced_variables, source);
        node.inputs.push_back({*inner, {}});
        node.delay = source.delay;
        return Add(std::move(node));
      }
    }
    return std::nullopt;
  }

  // Metrics.

  void FindFreeVariables(const Syntax& syntax, std::vector<std::string>& variables) {
    std::vector<std::string> bound;
    FindFreeVariables(syntax, bound, variables);
  }
  void FindFreeVariables(const Syntax& syntax, std::vector<std::string>& bound, std::vector<std::string>& variables) {
    const std::size_t count = bound.size();
    bound.insert(bound.end(), syntax.variables.begin(), syntax.variables.end());
    for (const Syntax& child : syntax.children) {
      FindFreeVariables(child, bound, variables);
      if (syntax.kind != SyntaxKind::kCall || child.kind != SyntaxKind::kName || child.name.size() != 1) continue;
      const auto is_in = [&](const std::vector<std::string>& names) {
        return std::find(names.begin(), names.end(), child.name) != names.end();
      };
      if (is_in(bound) || is_in(variables) || names_.FindBody(child.name) || names_.FindStaticModel(child.name) ||
          names_.FindPlace(child.name) != nullptr || names_.FindRegion(child.name) != nullptr) {
        continue;
      }
      const std::span<const SignalInfo> signals = Signals();
      const bool is_signal =
          std::any_of(signals.begin(), signals.end(), [&](const SignalInfo& info) { return child.name == info.name; });
      const bool is_function =
          std::any_of(kFunctions.begin(), kFunctions.end(), [&](const char* name) { return syntax.name == name; });
      if (!is_signal && !is_function) variables.push_back(child.name);
    }
    bound.resize(count);
  }

  WorldNames names_;
  MonitorProgram program_;
  std::vector<Scoped> scoped_;  // the innermost last
  std::size_t at_offset_ = 0;   // of the part that is compiled
  std::optional<Error> error_;
};

}  // namespace

Result<MonitorProgram> CompileExpectation(std::string_view text, const ExpectationScope& scope) {
  return Compiler(text, scope).Expectation();
}

Result<MonitorProgram> CompileMetric(std::string_view text, const ExpectationScope& scope) {
  return Compiler(text, scope).Metric();
}

}  // namespace troupe
