// MoveSequence: the moves of a plan that have not been granted, in their order, with the times at which they probably
// happen, and an index of all that a search for another way among them asks for.
//
// Positions in the sequence are labels: a move has one, a larger one than all moves before it. A robot that rests from
// a position on is there for all moves with labels of at least that. Positions stay what they are when moves are added
// or taken out.
//
// Times follow the order: a move begins once its robot is ready, and all moves before it that conflict with it have
// been finished. So along the moves of one lane or of one group both times ascend. A change of the sequence moves on
// exactly those times that depend on it.
//
// Cost: linear in the moves to make it; a change costs a look at the order, and at the neighbours of each move whose
// times change. A query looks at the moves near one lane or vertex.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/traffic/formation.h"
#include "common/traffic/traffic_graph.h"

namespace troupe {

class MoveSequence {
 public:
  using Position = std::uint64_t;
  // After all moves.
  static constexpr Position kEnd = std::numeric_limits<Position>::max();
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // Both ends belong to it.
  struct Range {
    Position begin = 0;
    Position end = 0;
  };
  // A move that is made before the first one whose label is not less than `position`.
  struct Step {
    Position position = 0;
    std::uint32_t lane = 0;
    std::uint32_t to = 0;
  };
  struct Times {
    double latest_finish = 0.0;      // s, of the moves before a position
    double earliest_start = kNever;  // s, of those from it on
  };

  // `places`: by row, after the `granted` moves. `moves`: possible in their order. The graph outlives it.
  MoveSequence(const TrafficGraph& graph, std::span<const std::uint32_t> places, std::span<const RowMove> granted,
               std::span<const RowMove> moves);

  // In their order.
  std::vector<RowMove> moves() const;

  // Takes a robot out, with its moves, which it returns. REQUIRES: no other one is out.
  std::vector<Step> TakeOut(std::uint32_t row);
  // Puts it back on a way from its place. REQUIRES: it has been taken out; the way is possible, its positions ascend.
  void PutBack(std::uint32_t row, std::span<const Step> steps);

  // s, from now: when the granted moves of a robot have been made; when those near a lane have been.
  double ready(std::uint32_t row) const { return ready_[row]; }
  double busy(std::uint32_t lane) const { return busy_[lane]; }
  std::uint32_t place(std::uint32_t row) const { return places_[row]; }

  // The positions around one, from and to which a robot may rest at a vertex without keeping another one from a move.
  Range RestAt(std::uint32_t vertex, Position position) const;
  // The positions within a range at which no robot at rest keeps another one from a move along a lane; ascending,
  // apart.
  void FindFree(std::uint32_t lane, std::uint32_t to, const Range& within, std::vector<Range>& free) const;
  // A robot rests at a vertex after all moves.
  bool IsTakenAtEnd(std::uint32_t vertex) const { return !stays_[vertex].empty() && stays_[vertex].back().end == kEnd; }
  // Another robot may rest there after all moves.
  bool IsFreeAtEnd(std::uint32_t vertex) const;
  // s, when the last move that needs a vertex has been made; 0 without one.
  double LastFinishNear(std::uint32_t vertex) const;
  // Of the moves that conflict with one along a lane.
  Times TimesNear(std::uint32_t lane, Position position) const;
  // The label of the first such move from a position on; kEnd without one.
  Position NextNear(std::uint32_t lane, Position position) const;

 private:
  // A move in a list: labels are beside the numbers, for the search.
  struct Entry {
    Position label = 0;
    std::uint32_t number = 0;
  };
  using List = std::vector<Entry>;  // ascending
  struct Move {
    RowMove move;
    Position label = 0;
    double start = 0.0;   // s, from now
    double finish = 0.0;  // s
  };

  template <typename Visit>
  void ForEachListNear(std::uint32_t lane, const Visit& visit) const;
  template <typename Visit>
  void ForEachListOf(const RowMove& move, const Visit& visit);
  void AddStays(std::uint32_t row);
  void RemoveStays(std::uint32_t row);
  template <typename Visit>
  void ForEachStay(std::uint32_t row, const Visit& visit) const;
  bool Update(Move& move, std::optional<std::uint32_t> before) const;
  void MoveOn(std::vector<Entry> changed);
  void Spread(std::uint32_t out);

  const TrafficGraph& graph_;
  std::vector<std::uint32_t> places_;      // by row
  std::vector<double> ready_;              // by row
  std::vector<double> busy_;               // by lane
  std::vector<double> groups_busy_;        // by group
  std::vector<Move> all_;                  // by number; also those that have been taken out
  List order_;                             // all moves
  std::vector<List> moves_on_;             // by lane
  std::vector<List> moves_to_;             // by direction
  std::vector<List> moves_in_;             // by group
  std::vector<List> moves_of_;             // by row
  std::vector<std::vector<Range>> stays_;  // by vertex, ascending
};

}  // namespace troupe
