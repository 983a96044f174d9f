// TrafficRoutes: how long the ways from all vertices of a graph to a vertex are, kept from one call to the next.
//
// What it gives depends on its arguments alone; what it keeps only saves time. Memory: kMaxKept numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "common/traffic/traffic_graph.h"

namespace troupe {

class TrafficRoutes {
 public:
  static constexpr std::size_t kMaxKept = 1 << 24;

  explicit TrafficRoutes(std::shared_ptr<const TrafficGraph> graph) : graph_(std::move(graph)) {}

  const TrafficGraph& graph() const { return *graph_; }
  // s, by vertex, from there to `goal` along lanes that are not closed; infinity if there is no way. `closed`: by lane.
  // The result is valid until the next call of Begin.
  const std::vector<float>& To(std::uint32_t goal);
  // Before the calls of To that are for these lanes.
  void Begin(const std::vector<bool>& closed);

 private:
  std::shared_ptr<const TrafficGraph> graph_;
  std::vector<bool> closed_;
  std::map<std::uint32_t, std::vector<float>> kept_;  // by goal
};

}  // namespace troupe
