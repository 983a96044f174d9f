// Formation: where the robots of a traffic rest, one at a vertex, and the moves that are possible one after another.
//
// The invariant of all plans: robots that rest do not conflict (traffic_graph.h), and a move keeps it, with its whole
// lane. Robots that began in a conflict may move apart, never together.
//
// Robots are numbered by their rows. Moves can be undone in reverse order, so that searches need no copies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/traffic/traffic_graph.h"

namespace troupe {

// A robot's way along one lane, in a sequence of such.
struct RowMove {
  std::uint32_t row = 0;
  std::uint32_t lane = 0;
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

class Formation {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  // `places`: the vertex of each robot. REQUIRES: all are different.
  Formation(const TrafficGraph& graph, std::vector<std::uint32_t> places);

  std::uint32_t place(std::uint32_t row) const { return places_[row]; }
  const std::vector<std::uint32_t>& places() const { return places_; }
  std::uint32_t occupant(std::uint32_t vertex) const { return occupants_[vertex]; }

  // Calls visit(row) for each robot that keeps `row` from the move along `lane` to `to`; some of them twice.
  template <typename Visit>
  void ForEachBlocker(std::uint32_t row, std::uint32_t lane, std::uint32_t to, const Visit& visit) const {
    const TrafficGraph::Need& need = graph_->NeedOf(lane, to);
    const auto visit_other = [&](std::uint32_t other) {
      if (other != kNone && other != row) visit(other);
    };
    for (const std::uint32_t vertex : need.vertices) visit_other(occupants_[vertex]);
    for (const std::uint32_t group : need.groups) {
      for (const std::uint32_t other : members_[group]) visit_other(other);
    }
  }
  // Calls visit(row) for each robot near a lane or in a group of it.
  template <typename Visit>
  void ForEachNear(std::uint32_t lane, const Visit& visit) const {
    for (const std::uint32_t vertex : graph_->VerticesNearLane(lane)) {
      if (occupants_[vertex] != kNone) visit(occupants_[vertex]);
    }
    for (const std::uint32_t group : graph_->GroupsOfLane(lane)) {
      for (const std::uint32_t other : members_[group]) visit(other);
    }
  }
  bool CanMove(std::uint32_t row, std::uint32_t lane, std::uint32_t to) const;
  // Appends it to the moves.
  void Move(std::uint32_t row, std::uint32_t lane, std::uint32_t to);

  const std::vector<RowMove>& moves() const { return moves_; }
  // Undoes all but the first `count` moves.
  void UndoTo(std::size_t count);

 private:
  void Place(std::uint32_t row, std::uint32_t vertex);
  void Remove(std::uint32_t row);

  const TrafficGraph* graph_;
  std::vector<std::uint32_t> places_;
  std::vector<std::uint32_t> occupants_;             // by vertex
  std::vector<std::vector<std::uint32_t>> members_;  // by group
  std::vector<RowMove> moves_;
};

}  // namespace troupe
