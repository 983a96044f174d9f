#include "testing/expectations/program_builder.h"

#include <algorithm>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kMaxNodes = 20'000;

}  // namespace

std::size_t ProgramBuilder::Lanes(const std::vector<std::size_t>& variables) {
  std::size_t lanes = 1;
  for (const std::size_t variable : variables) {
    lanes *= program_.variables[variable].things.size();
    if (lanes > kMaxLanes) {
      if (!error_) {
        error_ = TextError(at_offset_, "found more than " + std::to_string(kMaxLanes) +
                                           " combinations of things, expected fewer variables or a pattern of names");
      }
      return 1;
    }
  }
  return lanes;
}

// For each lane of `variables` the lane of those in `some` of them.
std::vector<std::uint32_t> ProgramBuilder::LaneMap(const std::vector<std::size_t>& variables,
                                                   const std::vector<std::size_t>& some, std::size_t lanes) {
  std::vector<std::uint32_t> map(lanes);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    std::size_t rest = lane;
    std::size_t stride = 1;
    std::size_t result = 0;
    std::size_t next = some.size();
    for (std::size_t i = variables.size(); i-- > 0;) {
      const std::size_t size = program_.variables[variables[i]].things.size();
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

std::size_t ProgramBuilder::Add(Node node) {
  if (program_.nodes.size() >= kMaxNodes && !error_) {
    error_ = TextError(at_offset_, "found too many operators, expected a shorter expectation");
  }
  // Node 0 exists from here on, so that results after an error are valid indices.
  if (error_ && !program_.nodes.empty()) return 0;
  if (node.op == Op::kSignal) {
    // A signal that a formula names twice is read once.
    const auto same = std::find_if(program_.nodes.begin(), program_.nodes.end(), [&](const Node& other) {
      return other.op == Op::kSignal && other.variables == node.variables && other.signal == node.signal;
    });
    if (same != program_.nodes.end()) return static_cast<std::size_t>(same - program_.nodes.begin());
  }
  program_.nodes.push_back(std::move(node));
  return program_.nodes.size() - 1;
}

std::size_t ProgramBuilder::Constant(double number) {
  Node node;
  node.number = number;
  return Add(std::move(node));
}

std::size_t ProgramBuilder::Make(Op op, std::vector<std::size_t> inputs, Node node) {
  if (error_) return 0;
  Align(inputs);
  node.op = op;
  Connect(node, inputs, program_.nodes);
  if (error_) return 0;
  for (const std::size_t input : inputs) {
    const Node& source = program_.nodes[input];
    node.names_cause = node.names_cause || source.names_cause;
    // Constants have a value at any time: they delay nothing and belong to every level.
    if (source.op == Op::kConstant) continue;
    node.delay = source.delay;
    node.level = source.level;
  }
  return Add(std::move(node));
}

// Replaces nodes by ones of equal levels and delays.
void ProgramBuilder::Align(std::vector<std::size_t>& nodes) {
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
std::size_t ProgramBuilder::PlayedBack(Op op, const std::vector<std::size_t>& inputs, std::size_t level, Tick from) {
  if (error_) return 0;
  Node node;
  node.op = op;
  node.level = level;
  node.window.from = from;
  for (const std::size_t input : inputs) Now(input).recorded = true;
  Connect(node, inputs, program_.nodes);
  return Add(std::move(node));
}

std::size_t ProgramBuilder::AfterTheRun(Op op, std::vector<std::size_t> inputs, Tick from) {
  if (error_) return 0;
  Align(inputs);
  std::size_t level = 0;
  for (const std::size_t input : inputs) level = std::max(level, Now(input).level);
  return PlayedBack(op, inputs, level + 1, from);
}

// The lanes of `variables` in which all stand for different bodies. All domains are equal.
std::vector<std::uint32_t> ProgramBuilder::CountedLanes(const std::vector<std::size_t>& variables, std::size_t lanes) {
  std::vector<std::uint32_t> counted;
  if (variables.size() < 2) return counted;
  std::vector<std::size_t> digits(variables.size());
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    std::size_t rest = lane;
    bool differ = true;
    for (std::size_t i = variables.size(); i-- > 0;) {
      const std::size_t size = program_.variables[variables[i]].things.size();
      digits[i] = rest % size;
      rest /= size;
      for (std::size_t j = i + 1; j < digits.size(); ++j) differ = differ && digits[i] != digits[j];
    }
    if (differ) counted.push_back(static_cast<std::uint32_t>(lane));
  }
  return counted;
}

}  // namespace troupe
