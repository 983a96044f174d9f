#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/text.h"
#include "testing/expectations/compiler.h"
#include "testing/expectations/operators.h"

namespace troupe {
namespace {

constexpr Tick kMaxInterval = 1'000'000'000;  // ticks

bool IsBodyKind(std::string_view table) {
  return table == "robots" || table == "objects" || table == "people";
}

std::string PlainNumber(double number) {
  Syntax syntax;
  syntax.number.value = number;
  return ToString(syntax);
}

}  // namespace

void Compiler::RequireTruth(const Syntax& at, const TypedValue& value) {
  if (!error_ && value.type != ValueType::kTruth) {
    Fail(at, "found " + NameOf(value) + ", expected a condition, such as a comparison");
  }
}

TypedValue Compiler::Quantifier(const Syntax& syntax) {
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
  const Kind& kind = *std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& k) { return syntax.name == k.name; });
  // Pairs grow with the square of the fleet: the signal searches the index instead of computing each lane.
  if (IsClosestPair(syntax) && IsBodyKind(syntax.domain)) return ClosestPair(syntax);
  const bool of_truth = kind.op == Op::kForall || kind.op == Op::kExists || kind.op == Op::kCount;
  return WithVariables<TypedValue>(
      syntax,
      [&](const std::vector<std::size_t>& variables) {
        TypedValue value = Expression(syntax.children[0]);
        if (error_) return value;
        if (of_truth) {
          RequireTruth(syntax.children[0], value);
        } else if (value.type != ValueType::kNumber) {
          return Fail(syntax.children[0], "found " + NameOf(value) + ", expected a number for '" + syntax.name + "'");
        }
        // A count is a number without unit, although its input is a condition.
        if (kind.op == Op::kCount) value = {value.node, ValueType::kNumber};
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
      [&](TypedValue value) {
        value.node = Constant(kind.of_none);
        return value;
      });
}

TypedValue Compiler::ClosestPair(const Syntax& syntax) {
  const std::vector<ThingId> domain = Checked(names_.Domain(syntax));
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
  return {Add(std::move(node)), ValueType::kNumber, {1, 0, 0, 0}, false};
}

// Intervals.

// In ticks, rounded to a whole number in the direction of the interval's inside.
Tick Compiler::Ticks(const IntervalSyntax& at, const NumberSyntax& time, const NumberSyntax& other, bool is_end) {
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
    // 0.3 s of 0.1 s ticks is 2.9999999999999996 in doubles: what is near a whole number is meant as one.
    ticks = std::abs(ticks - nearest) <= 1e-6 ? nearest : is_end ? std::floor(ticks) : std::ceil(ticks);
  }
  if (!(ticks <= static_cast<double>(kMaxInterval))) {
    Fail(place, "found an interval beyond " + std::to_string(kMaxInterval) + " ticks, expected a shorter one");
    return 0;
  }
  return static_cast<Tick>(ticks);
}

TickWindow Compiler::Window(const Syntax& temporal) {
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

// Formulas.

std::size_t Compiler::Truth(const Syntax& syntax) {
  const TypedValue value = Expression(syntax);
  RequireTruth(syntax, value);
  return value.node;
}

std::size_t Compiler::AlwaysOrEventually(const Syntax& syntax, bool is_always) {
  const std::size_t inner = Truth(syntax.children[0]);
  const TickWindow window = Window(syntax);
  return Windowed(is_always, window, inner);
}

std::size_t Compiler::Windowed(bool is_always, const TickWindow& window, std::size_t inner) {
  if (error_) return 0;
  // Without an end the value at any tick depends on the last one: it is computed backwards from there.
  if (!window.has_end()) return AfterTheRun(is_always ? Op::kSuffixMin : Op::kSuffixMax, {inner}, window.from);
  Node node;
  node.window = window;
  const std::size_t made = Make(is_always ? Op::kWindowMin : Op::kWindowMax, {inner}, std::move(node));
  // The last tick of the window must have come before the first result.
  if (!error_) Now(made).delay += window.to;
  return made;
}

TypedValue Compiler::Temporal(const Syntax& syntax) {
  const std::string& name = syntax.name;
  if (name == "always" || name == "eventually") return TruthOf(AlwaysOrEventually(syntax, name == "always"));
  if (name == "finally") return TruthOf(AfterTheRun(Op::kLastValue, {Truth(syntax.children[0])}, 0));
  if (name == "since") {
    const std::size_t left = Truth(syntax.children[0]);
    return TruthOf(Make(Op::kSince, {left, Truth(syntax.children[1])}));
  }
  return name == "until" ? Until(syntax) : Past(syntax);
}

TypedValue Compiler::Until(const Syntax& syntax) {
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

TypedValue Compiler::Past(const Syntax& syntax) {
  const bool is_min = syntax.name == "historically";
  std::size_t inner = Truth(syntax.children[0]);
  const TickWindow window = Window(syntax);
  if (error_) return {};
  if (window.from > 0) {
    Node shift;
    shift.ticks = window.from;
    // Before the run there is nothing that could violate "historically" or satisfy "once".
    shift.number = is_min ? kInfinity : -kInfinity;
    inner = Make(Op::kPastShift, {inner}, std::move(shift));
  }
  Node node;
  node.ticks = window.has_end() ? window.to - window.from : kForever;
  return TruthOf(Make(is_min ? Op::kPastMin : Op::kPastMax, {inner}, std::move(node)));
}

TypedValue Compiler::Comparison(const Syntax& syntax, const TypedValue& left, const TypedValue& right) {
  const std::string& name = syntax.name;
  if (left.type != right.type) {
    return Fail(syntax, "found " + NameOf(left) + " compared with " + NameOf(right) + ", expected two numbers");
  }
  if (left.type == ValueType::kTruth) {
    return Fail(syntax,
                "found conditions compared by '" + name + "', expected numbers; 'a -> b' and 'not' join conditions");
  }
  if (left.type == ValueType::kText) return TextComparison(syntax, left, right);
  RequireSameUnit(syntax, left, right, "compared with");
  if (error_) return {};
  const auto [op, is_swapped] = OperatorOf(name).value();
  return TruthOf(is_swapped ? Make(op, {right.node, left.node}) : Make(op, {left.node, right.node}));
}

TypedValue Compiler::TextComparison(const Syntax& syntax, const TypedValue& left, const TypedValue& right) {
  const bool is_equality = syntax.name == "==" || syntax.name == "!=";
  const bool is_left = left.read != nullptr;
  if (is_left == (right.read != nullptr) || !is_equality) {
    return Fail(syntax,
                "found texts compared, expected hash == \"...\" or hash != \"...\", or another signal that is a text");
  }
  const TypedValue& read = is_left ? left : right;
  const std::string& text = is_left ? right.text : left.text;
  // A hash with a typing error would be a formula that never holds: found here instead.
  const bool is_digits = text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (read.read->signal.kind == SignalKind::kHash && !is_digits) {
    return Fail(syntax, "found the hash '" + PlainLine(text, 40) + "', expected 16 digits of 0 to 9 and a to f");
  }
  const std::vector<std::string>& possible = read.possible;
  if (!possible.empty() && std::find(possible.begin(), possible.end(), text) == possible.end()) {
    return Fail(syntax, "found the text '" + PlainLine(text, 40) + "', expected one of " +
                            WorldNames::Listing(possible) + DidYouMean(text, possible));
  }
  Node node = *read.read;
  node.signal.text = text;
  node.signal.negated = syntax.name == "!=";
  return TruthOf(Add(std::move(node)));
}

void Compiler::RequireSameUnit(const Syntax& syntax, const TypedValue& left, const TypedValue& right,
                               const std::string& verb) {
  if (error_ || left.is_plain || right.is_plain || left.dimension == right.dimension) return;
  Fail(syntax, "found " + NameOf(left) + " " + verb + " " + NameOf(right) + ", expected one unit on both sides");
}

TypedValue Compiler::Operator(const Syntax& syntax) {
  const std::string& name = syntax.name;
  if (name == "not") return TruthOf(Make(Op::kNot, {Truth(syntax.children[0])}));
  if (name == "and" || name == "or" || name == "->") {
    std::vector<std::size_t> inputs;
    for (const Syntax& child : syntax.children) inputs.push_back(Truth(child));
    if (name == "->" && !error_) inputs[0] = Make(Op::kNot, {inputs[0]});
    return TruthOf(Make(name == "and" ? Op::kAnd : Op::kOr, std::move(inputs)));
  }
  const TypedValue left = Expression(syntax.children[0]);
  if (error_) return {};
  if (syntax.children.size() == 1) {  // minus
    if (left.type != ValueType::kNumber)
      return Fail(syntax, "found '-' before " + NameOf(left) + ", expected a number");
    return {Make(Op::kNegate, {left.node}), ValueType::kNumber, left.dimension, left.is_plain, {}};
  }
  const TypedValue right = Expression(syntax.children[1]);
  if (error_) return {};
  const bool is_product = name == "*" || name == "/";
  if (!is_product && name != "+" && name != "-") return Comparison(syntax, left, right);
  if (left.type != ValueType::kNumber || right.type != ValueType::kNumber) {
    const TypedValue& wrong = left.type != ValueType::kNumber ? left : right;
    return Fail(syntax, "found '" + name + "' with " + NameOf(wrong) + ", expected two numbers");
  }
  const bool is_plain = left.is_plain && right.is_plain;
  if (is_product) {
    return {Make(OperatorOf(name)->first, {left.node, right.node}),
            ValueType::kNumber,
            Product(left.dimension, right.dimension, name == "*" ? 1 : -1),
            is_plain,
            {}};
  }
  RequireSameUnit(syntax, left, right, name == "+" ? "added to" : "in a difference with");
  if (error_) return {};
  const Dimension dimension = left.is_plain ? right.dimension : left.dimension;
  return {Make(OperatorOf(name)->first, {left.node, right.node}), ValueType::kNumber, dimension, is_plain, {}};
}

TypedValue Compiler::Expression(const Syntax& syntax) {
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
      TypedValue value;
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

}  // namespace troupe
