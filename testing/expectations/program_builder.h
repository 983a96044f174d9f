// ProgramBuilder: adds nodes to a program such that its invariants hold (program.h): inputs stand before their users,
// all inputs of a node have one level and delay, and lanes are mapped where variables differ. The compiler says what to
// compute; here is when and for which lanes.
//
// After the first error nothing is added, and results are node 0: a valid index with a meaningless value. Bounds:
// kMaxLanes combinations of things and kMaxNodes operators, so that neither a text of 8 kB nor a world of thousands of
// robots can exhaust memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "testing/expectations/program.h"
#include "testing/expectations/typed_value.h"
#include "troupe/result.h"

namespace troupe {

// Once there is an error nothing is added any more, and all results are of no use, but harmless.
class ProgramBuilder {
 protected:
  Node& Now(std::size_t node) { return program_.nodes[node]; }

  // The first error counts.
  TypedValue Fail(const Syntax& at, std::string message) { return Fail(TextError(at.offset, std::move(message))); }
  TypedValue Fail(Error error) {
    if (!error_) error_ = std::move(error);
    return {};
  }
  template <typename T>
  T Checked(Result<T> result) {
    if (result.ok()) return std::move(result).value();
    Fail(result.error());
    return {};
  }

  // Of the product of the domains of `variables`.
  std::size_t Lanes(const std::vector<std::size_t>& variables);
  // For each lane of `variables` the lane of those in `some` of them.
  std::vector<std::uint32_t> LaneMap(const std::vector<std::size_t>& variables, const std::vector<std::size_t>& some,
                                     std::size_t lanes);
  // The lanes of `variables` in which all stand for different things. All domains are equal.
  std::vector<std::uint32_t> CountedLanes(const std::vector<std::size_t>& variables, std::size_t lanes);

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
      NodeInput connection{input, {}};
      const std::vector<std::size_t>& its = sources[input].variables;
      if (its != node.variables && sources[input].lanes != 1)
        connection.lane_of = LaneMap(node.variables, its, node.lanes);
      node.inputs.push_back(std::move(connection));
    }
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

  std::size_t Add(Node node);
  std::size_t Constant(double number);
  // A node of these inputs, once they are aligned.
  std::size_t Make(Op op, std::vector<std::size_t> inputs, Node node = {});
  // Replaces nodes by ones of equal levels and delays.
  void Align(std::vector<std::size_t>& nodes);
  // Inputs of one level and delay.
  std::size_t PlayedBack(Op op, const std::vector<std::size_t>& inputs, std::size_t level, Tick from);
  std::size_t AfterTheRun(Op op, std::vector<std::size_t> inputs, Tick from);

  MonitorProgram program_;
  std::size_t at_offset_ = 0;  // of the part that is compiled
  std::optional<Error> error_;
};

}  // namespace troupe
