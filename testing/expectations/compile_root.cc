#include <algorithm>
#include <utility>

#include "testing/expectations/compiler.h"

namespace troupe {
namespace {

// Whether an operator in the formula looks into the future.
bool LooksAhead(const Syntax& syntax) {
  const bool ahead = syntax.kind == SyntaxKind::kTemporal && syntax.name != "once" && syntax.name != "historically" &&
                     syntax.name != "since";
  return ahead || std::any_of(syntax.children.begin(), syntax.children.end(), LooksAhead);
}

}  // namespace

std::size_t Compiler::AddRoot(RootNode root) {
  program_.roots.push_back(std::move(root));
  return program_.roots.size() - 1;
}

std::size_t Compiler::Root(const Syntax& syntax) {
  if (error_) return 0;
  at_offset_ = syntax.offset;
  const bool is_not = syntax.Is(SyntaxKind::kOperator, "not");
  const bool is_and = syntax.Is(SyntaxKind::kOperator, "and");
  // Its value at the first tick is known at the first tick: no bounds are needed.
  if (!LooksAhead(syntax)) return RootOf(RootOp::kValue, {Truth(syntax)}, {});
  if (is_not || is_and || syntax.Is(SyntaxKind::kOperator, "or")) {
    std::vector<std::size_t> inputs;
    for (const Syntax& child : syntax.children) inputs.push_back(Root(child));
    RootNode root;
    root.op = is_not ? RootOp::kNot : is_and ? RootOp::kAnd : RootOp::kOr;
    if (!error_) Connect(root, inputs, program_.roots);
    return AddRoot(std::move(root));
  }
  if (syntax.Is(SyntaxKind::kBound, "forall") || syntax.Is(SyntaxKind::kBound, "exists")) return QuantifiedRoot(syntax);
  if (syntax.kind == SyntaxKind::kTemporal) {
    const std::string& name = syntax.name;
    if (name == "always" || name == "eventually") {
      const std::size_t inner = Truth(syntax.children[0]);
      return RootOf(name == "always" ? RootOp::kAlways : RootOp::kEventually, {inner}, Window(syntax));
    }
    if (name == "finally") return RootOf(RootOp::kFinally, {Truth(syntax.children[0])}, {});
    if (name == "until") return UntilRoot(syntax);
  }
  return RootOf(RootOp::kValue, {Truth(syntax)}, {});
}

// "P until[A, B] Q" waits for the slower of its sides, which may be known only at the end of the run. What one side
// alone says is known earlier: Q has to hold in the window and P before it, and Q at the first tick is enough if A is
// 0. Each part is a bound of the robustness of the whole, which so is the same with them and without.
std::size_t Compiler::UntilRoot(const Syntax& syntax) {
  const std::size_t left = Truth(syntax.children[0]);
  const std::size_t right = Truth(syntax.children[1]);
  const TickWindow window = Window(syntax);
  std::size_t until = RootOf(RootOp::kUntil, {left, right}, window);
  if (error_) return 0;
  const auto is_constant = [&](std::size_t node) { return Now(node).op == Op::kConstant; };
  const bool are_known_together = Now(left).level == Now(right).level && Now(left).delay == Now(right).delay;
  if (are_known_together || is_constant(left) || is_constant(right)) return until;
  const auto bounded_by = [&](RootOp join, RootOp op, std::size_t side, const TickWindow& its_window) {
    const std::size_t bound = RootOf(op, {side}, its_window);
    program_.roots[bound].is_bound = true;
    RootNode root;
    root.op = join;
    Connect(root, {bound, until}, program_.roots);
    until = AddRoot(std::move(root));
  };
  if (window.from == 0) {
    bounded_by(RootOp::kOr, RootOp::kValue, right, {});
  } else {
    bounded_by(RootOp::kAnd, RootOp::kAlways, left, {0, window.from - 1});
  }
  bounded_by(RootOp::kAnd, RootOp::kEventually, right, window);
  return until;
}

std::size_t Compiler::QuantifiedRoot(const Syntax& syntax) {
  const bool is_forall = syntax.Is(SyntaxKind::kBound, "forall");
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

std::size_t Compiler::RootOf(RootOp op, std::vector<std::size_t> nodes, const TickWindow& window) {
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
std::optional<std::size_t> Compiler::History(std::size_t number) {
  const RootNode root = program_.roots[number];
  if (root.is_bound) return std::nullopt;
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
      for (const NodeInput& input : root.inputs) {
        if (const std::optional<std::size_t> node = History(input.node)) inputs.push_back(*node);
      }
      if (inputs.empty()) return std::nullopt;
      return Make(root.op == RootOp::kNot ? Op::kNot : root.op == RootOp::kAnd ? Op::kAnd : Op::kOr, std::move(inputs));
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

}  // namespace troupe
