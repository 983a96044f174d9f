#include "testing/expectations/compile.h"

#include <algorithm>
#include <utility>

#include "testing/expectations/compiler.h"

namespace troupe {

Compiler::Compiler(std::string_view text, const ExpectationScope& scope) : names_(scope) {
  program_.text = text;
  program_.things = names_.things_of_world();
  program_.interval_ns = scope.world.interval_ns;
}

Result<MonitorProgram> Compiler::Expectation() {
  Result<Syntax> parsed = ParseFormula(program_.text);
  if (!parsed.ok()) return parsed.error();
  Result<Syntax> expanded = Expanded(std::move(parsed).value());
  if (!expanded.ok()) return expanded.error();
  program_.formula = ToString(expanded.value());
  // Errors are found in the text as it is written, before it is changed.
  const Syntax checked = WithClosestPairs(expanded.value());
  RequireTruth(checked, Expression(checked));
  if (error_) return *error_;
  // The second pass begins empty: only its nodes are run.
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

Result<MonitorProgram> Compiler::Metric() {
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
  std::vector<std::string> names;
  FindFreeVariables(metric.of, names, bound);
  if (bound.variables.size() > 4) {
    return TextError(0, "found more than 4 variables without a quantifier, expected fewer");
  }
  bound.name = "min";
  // "min of distance(a, b)": the same as the least pair of each tick, without a lane for each pair.
  if (metric.kind == MetricKind::kMin && bound.variables.size() == 2) {
    bound.children.push_back(metric.of);
    if (IsClosestPair(bound)) {
      metric.of = bound;
      bound.variables.clear();
    }
  }
  const std::vector<ThingId> domain = names_.Domain(bound).value();  // without a pattern
  std::vector<std::size_t> variables;
  for (const std::string& name : bound.variables) variables.push_back(Bind(name, domain, KindOf(bound.domain)));
  const TypedValue value = Expression(metric.of);
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
  // Too few things for different ones: no lane counts, and the metric does not exist.
  if (domain.size() < variables.size()) program_.counted = {SignalUse::kNone};
  program_.dimension = is_time ? Dimension{0, 1, 0, 0} : value.dimension;
  return Finished();
}

Result<MonitorProgram> Compiler::Finished() {
  if (error_) return *error_;
  for (const Node& node : program_.nodes) program_.levels = std::max(program_.levels, node.level + 1);
  return std::move(program_);
}

std::size_t Compiler::Bind(const std::string& name, const std::vector<ThingId>& things, std::size_t kind) {
  program_.variables.push_back({name, things});
  scoped_.push_back({name, program_.variables.size() - 1, kind});
  return program_.variables.size() - 1;
}

void Compiler::FindFreeVariables(const Syntax& syntax, std::vector<std::string>& bound, Syntax& free) {
  const std::size_t count = bound.size();
  bound.insert(bound.end(), syntax.variables.begin(), syntax.variables.end());
  for (const Syntax& child : syntax.children) {
    FindFreeVariables(child, bound, free);
    if (syntax.kind != SyntaxKind::kCall || child.kind != SyntaxKind::kName || child.name.size() != 1) continue;
    const auto is_in = [&](const std::vector<std::string>& names) {
      return std::find(names.begin(), names.end(), child.name) != names.end();
    };
    if (is_in(bound) || is_in(free.variables) || names_.IsName(child.name) || IsSignalOrFunction(child.name) ||
        IsFunction(syntax.name)) {
      continue;
    }
    free.variables.push_back(child.name);
    const std::vector<std::size_t> kinds = KindsWith(syntax.name);
    // position(r, "NAME") is of a robot.
    const bool is_of_robots = kinds.empty() || kinds.front() == RobotKind() || syntax.children.size() == 2;
    // "max of opening(d)" is about doors: the first variable's signal says of which table.
    if (!is_of_robots && free.variables.size() == 1) free.domain = StateTables()[kinds.front()].name;
  }
  bound.resize(count);
}

Result<MonitorProgram> CompileExpectation(std::string_view text, const ExpectationScope& scope) {
  return Compiler(text, scope).Expectation();
}

Result<MonitorProgram> CompileMetric(std::string_view text, const ExpectationScope& scope) {
  return Compiler(text, scope).Metric();
}

}  // namespace troupe
