#include "python/native/formulas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "troupe/deterministic_math.h"

namespace troupe::python {
namespace {

constexpr std::array kFormulaOps = {"add",     "subtract", "multiply", "divide",  "negate", "abs",   "sqrt", "sin",
                                    "cos",     "atan2",    "hypot",    "floor",   "wrap",   "min",   "max",  "less",
                                    "at_most", "equal",    "not",      "and",     "or",     "where", "own",  "other",
                                    "sum",     "least",    "greatest", "visited", "visit"};
static_assert(kFormulaOps.size() == static_cast<std::size_t>(FormulaOp::kVisit) + 1);

constexpr double kInfinite = std::numeric_limits<double>::infinity();

bool IsReduction(FormulaOp op) {
  return op == FormulaOp::kSum || op == FormulaOp::kLeast || op == FormulaOp::kGreatest;
}
bool IsSpread(FormulaOp op) {
  return op == FormulaOp::kOwn || op == FormulaOp::kOther;
}
bool IsOfGrid(FormulaOp op) {
  return op == FormulaOp::kVisited || op == FormulaOp::kVisit;
}

double TruthOf(bool truth) {
  return truth ? 1.0 : 0.0;
}

// Calls visit(function) with the operation as a function of three numbers.
template <typename Visit>
void VisitFormulaOp(FormulaOp op, const Visit& visit) {
  switch (op) {
    case FormulaOp::kAdd:
      return visit([](double a, double b, double) { return a + b; });
    case FormulaOp::kSubtract:
      return visit([](double a, double b, double) { return a - b; });
    case FormulaOp::kMultiply:
      return visit([](double a, double b, double) { return a * b; });
    case FormulaOp::kDivide:
      return visit([](double a, double b, double) { return a / b; });
    case FormulaOp::kNegate:
      return visit([](double a, double, double) { return -a; });
    case FormulaOp::kAbs:
      return visit([](double a, double, double) { return std::abs(a); });
    case FormulaOp::kSqrt:
      return visit([](double a, double, double) { return std::sqrt(a); });
    case FormulaOp::kSin:
      return visit([](double a, double, double) { return SinCos(a).sin; });
    case FormulaOp::kCos:
      return visit([](double a, double, double) { return SinCos(a).cos; });
    case FormulaOp::kAtan2:
      return visit([](double a, double b, double) { return Atan2(a, b); });
    case FormulaOp::kHypot:
      return visit([](double a, double b, double) { return std::sqrt(a * a + b * b); });
    case FormulaOp::kFloor:
      return visit([](double a, double, double) { return std::floor(a); });
    case FormulaOp::kWrap:
      return visit([](double a, double, double) { return WrapAngle(a); });
    case FormulaOp::kMin:
      return visit([](double a, double b, double) { return b < a ? b : a; });
    case FormulaOp::kMax:
      return visit([](double a, double b, double) { return b > a ? b : a; });
    case FormulaOp::kLess:
      return visit([](double a, double b, double) { return TruthOf(a < b); });
    case FormulaOp::kAtMost:
      return visit([](double a, double b, double) { return TruthOf(a <= b); });
    case FormulaOp::kEqual:
      return visit([](double a, double b, double) { return TruthOf(a == b); });
    case FormulaOp::kNot:
      return visit([](double a, double, double) { return TruthOf(a == 0.0); });
    case FormulaOp::kAnd:
      return visit([](double a, double b, double) { return TruthOf(a != 0.0 && b != 0.0); });
    case FormulaOp::kOr:
      return visit([](double a, double b, double) { return TruthOf(a != 0.0 || b != 0.0); });
    case FormulaOp::kWhere:
      return visit([](double a, double b, double c) { return a != 0.0 ? b : c; });
    default:
      return;
  }
}

}  // namespace

std::span<const char* const> FormulaOps() {
  return kFormulaOps;
}

bool FormulaProgram::IsValid() const {
  const std::size_t count = pairs.size();
  const auto is_of_robots = [&](std::size_t number) { return number < count && !pairs[number]; };
  for (std::size_t i = 0; i < std::min(inputs + memory, count); ++i) {
    if (pairs[i]) return false;
  }
  if (inputs + memory > count) return false;
  for (const auto& [number, value] : constants) {
    if (number >= count) return false;
  }
  for (const FormulaSection* section : {&start, &step, &observe}) {
    for (const Instruction& each : section->instructions) {
      if (std::max({each.out, each.a, each.b, each.c}) >= count || each.out < inputs + memory) return false;
      const bool wide = pairs[each.out];
      const auto have = [&](bool is_wide) { return pairs[each.a] == is_wide && pairs[each.b] == is_wide; };
      if (IsReduction(each.op) ? wide || !have(true)
          : IsSpread(each.op)  ? !wide || pairs[each.a]
          : IsOfGrid(each.op)  ? wide || !have(false) || width == 0 || height == 0
                               : !have(wide) || pairs[each.c] != wide) {
        return false;
      }
    }
    for (const std::uint16_t result : section->results) {
      if (!is_of_robots(result)) return false;
    }
  }
  return start.results.size() == memory && step.results.size() == memory + 2;
}

FormulaRegisters::FormulaRegisters(const FormulaProgram& program, std::size_t robots)
    : program_(program), robots_(robots) {
  std::size_t total = 0;
  for (const bool wide : program.pairs) {
    first_.push_back(total);
    lanes_.push_back(wide ? robots * robots : robots);
    total += lanes_.back();
  }
  data_.resize(total);
  for (const auto& [number, value] : program.constants) std::fill_n(of(number).begin(), lanes_[number], value);
}

void FormulaRegisters::Run(const FormulaSection& section, std::span<std::uint8_t> grid) {
  for (const Instruction& each : section.instructions) {
    const double* const a = data_.data() + first_[each.a];
    double* const out = data_.data() + first_[each.out];
    if (IsReduction(each.op)) {
      Reduce(each);
    } else if (IsOfGrid(each.op)) {
      Visit(each, grid);
    } else if (IsSpread(each.op)) {
      for (std::size_t i = 0; i < robots_; ++i) {
        for (std::size_t j = 0; j < robots_; ++j) out[i * robots_ + j] = a[each.op == FormulaOp::kOwn ? i : j];
      }
    } else {
      const double* const b = data_.data() + first_[each.b];
      const double* const c = data_.data() + first_[each.c];
      VisitFormulaOp(each.op, [&, lanes = lanes_[each.out]](const auto& compute) {
        for (std::size_t i = 0; i < lanes; ++i) out[i] = compute(a[i], b[i], c[i]);
      });
    }
  }
}

void FormulaRegisters::Reduce(const Instruction& instruction) {
  const std::span<const double> values = of(instruction.a);
  const std::span<const double> counts = of(instruction.b);
  const std::span<double> out = of(instruction.out);
  for (std::size_t i = 0; i < robots_; ++i) {
    double result = instruction.op == FormulaOp::kSum     ? 0.0
                    : instruction.op == FormulaOp::kLeast ? kInfinite
                                                          : -kInfinite;
    for (std::size_t j = 0; j < robots_; ++j) {
      const double value = values[i * robots_ + j];
      if (j == i || counts[i * robots_ + j] == 0.0) continue;
      result = instruction.op == FormulaOp::kSum     ? result + value
               : instruction.op == FormulaOp::kLeast ? std::min(result, value)
                                                     : std::max(result, value);
    }
    out[i] = result;
  }
}

void FormulaRegisters::Visit(const Instruction& instruction, std::span<std::uint8_t> grid) {
  const auto width = static_cast<double>(program_.width);
  const auto height = static_cast<double>(program_.height);
  for (std::size_t i = 0; i < robots_; ++i) {
    // Of points outside the nearest cell; of one that is no number the first.
    const double x = std::floor(of(instruction.a)[i] + width / 2.0);
    const double y = std::floor(of(instruction.b)[i] + height / 2.0);
    const auto column = x > 0.0 ? static_cast<std::size_t>(std::min(x, width - 1.0)) : std::size_t{0};
    const auto row = y > 0.0 ? static_cast<std::size_t>(std::min(y, height - 1.0)) : std::size_t{0};
    std::uint8_t& cell = grid[column * program_.height + row];
    const bool was_visited = cell != 0;
    if (instruction.op == FormulaOp::kVisit) cell = 1;
    of(instruction.out)[i] = TruthOf(was_visited == (instruction.op == FormulaOp::kVisited));
  }
}

}  // namespace troupe::python
