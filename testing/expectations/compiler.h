// Compiler: from the syntax of one expectation or metric to its program. Private to this folder: compile.h is its
// entrance. The sources: compile.cc the two entrances, compile_formula.cc operators, quantifiers and windows,
// compile_signal.cc signals and their arguments, compile_root.cc the outermost operators, which are judged at the first
// tick alone.
//
// An object compiles one text and is spent. Errors do not unwind: the first is kept (ProgramBuilder::Fail), later steps
// return harmless values, and the entrance returns that error. So a visitor function needs no check after each child,
// only before it uses a value to index something.
//
// An expectation is compiled twice: first as it is written, for errors at the user's own words, then in its normal
// form, whose nodes are the program. The nodes of the first pass are thrown away.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "testing/expectations/names.h"
#include "testing/expectations/program_builder.h"
#include "testing/expectations/rewrite.h"

namespace troupe {

class Compiler : private ProgramBuilder {
 public:
  Compiler(std::string_view text, const ExpectationScope& scope);

  // Each is called once, and one of them.
  Result<MonitorProgram> Expectation();
  Result<MonitorProgram> Metric();

 private:
  // A variable of a quantifier, while its formula is compiled.
  struct Scoped {
    std::string name;
    std::size_t variable;
    std::size_t kind;
  };
  // A thing in an argument: of a variable, or one for all lanes.
  struct ThingArgument {
    std::optional<std::size_t> variable = {};
    ThingId thing = 0;
    std::size_t kind = 0;
  };
  using Kinds = std::vector<std::size_t>;  // places in StateTables()

  Result<MonitorProgram> Finished();
  std::size_t Bind(const std::string& name, const std::vector<ThingId>& things, std::size_t kind);
  // The variables without a quantifier, as those of `free`, and the domain of the first: that of its signal.
  void FindFreeVariables(const Syntax& syntax, std::vector<std::string>& bound, Syntax& free);

  // Formulas.
  TypedValue Expression(const Syntax& syntax);
  std::size_t Truth(const Syntax& syntax);
  static TypedValue TruthOf(std::size_t node) { return {node, ValueType::kTruth}; }
  void RequireTruth(const Syntax& at, const TypedValue& value);
  void RequireSameUnit(const Syntax& syntax, const TypedValue& left, const TypedValue& right, const std::string& verb);
  TypedValue Operator(const Syntax& syntax);
  TypedValue Comparison(const Syntax& syntax, const TypedValue& left, const TypedValue& right);
  TypedValue TextComparison(const Syntax& syntax, const TypedValue& left, const TypedValue& right);
  TypedValue Temporal(const Syntax& syntax);
  TypedValue Until(const Syntax& syntax);
  TypedValue Past(const Syntax& syntax);
  TypedValue Quantifier(const Syntax& syntax);
  TypedValue ClosestPair(const Syntax& syntax);
  std::size_t AlwaysOrEventually(const Syntax& syntax, bool is_always);
  std::size_t Windowed(bool is_always, const TickWindow& window, std::size_t inner);
  double Seconds() const { return static_cast<double>(program_.interval_ns) * 1e-9; }
  // In ticks, rounded to a whole number in the direction of the interval's inside.
  Tick Ticks(const IntervalSyntax& at, const NumberSyntax& time, const NumberSyntax& other, bool is_end);
  TickWindow Window(const Syntax& temporal);

  // Binds the variables of a quantifier, and calls compile(variables) for its body; `empty`: what it is worth if
  // there are not enough things for its variables.
  template <typename Result, typename Compile, typename Empty>
  Result WithVariables(const Syntax& bound, const Compile& compile, const Empty& empty) {
    const std::vector<ThingId> domain = Checked(names_.Domain(bound));
    if (error_) return {};
    const std::size_t kind = KindOf(bound.domain);
    std::vector<std::size_t> variables;
    for (const std::string& name : bound.variables) variables.push_back(Bind(name, domain, kind));
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

  // Signals and functions.
  TypedValue Call(const Syntax& syntax);
  TypedValue UnknownName(const Syntax& syntax);
  TypedValue Function(const Syntax& syntax);
  TypedValue Count(const Syntax& argument);
  TypedValue SquareRoot(const Syntax& syntax, TypedValue value);
  // A signal of the state's tables: `kinds`: the tables that have it.
  TypedValue TableSignal(const Syntax& syntax, const Kinds& kinds);
  TypedValue RunSignal(const Syntax& syntax, const SignalInfo& info);
  std::optional<ThingArgument> FindThing(const Syntax& argument, const Kinds& kinds);
  ThingArgument Thing(const Syntax& argument, const Kinds& kinds);
  void PlainArgument(const Syntax& argument, char parameter, SignalUse& signal);
  void EventArgument(const Syntax& argument, SignalUse& signal);
  std::optional<ThingArgument> DistanceTarget(const Syntax& argument, SignalUse& signal);
  bool IsWholeStaticModel(const Syntax& argument, ModelId model);
  // Sets the variables and lanes of a signal's node, and its things by lane.
  void SetLanes(const std::vector<ThingArgument>& things, Node& node);
  // Replaces robots by their parts of one of these kinds that `part` names; the kind of these parts.
  std::size_t FindParts(const Syntax& part, const Kinds& kinds, std::vector<ThingId>& robots);
  // Sets the stores and sensors of a signal of the run, by lane.
  void FindDevices(const Syntax& syntax, const SignalInfo& info, const Syntax* sensor, SignalUse& signal);
  // The unit of a position or speed of joints: that of a turn if all of them turn.
  void SetUnitOfJoints(const Syntax& at, const std::vector<ThingId>& joints, Dimension& dimension);

  // The part of a formula that is judged at the first tick.
  std::size_t Root(const Syntax& syntax);
  std::size_t QuantifiedRoot(const Syntax& syntax);
  std::size_t UntilRoot(const Syntax& syntax);
  std::size_t AddRoot(RootNode root);
  std::size_t RootOf(RootOp op, std::vector<std::size_t> nodes, const TickWindow& window);
  // The formula without its outermost temporal operators, as a node; nothing if it has none.
  std::optional<std::size_t> History(std::size_t number);

  WorldNames names_;
  std::vector<Scoped> scoped_;  // the innermost last
};

}  // namespace troupe
