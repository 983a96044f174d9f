// PlanInsertion: a way of one robot to its goal among the moves that are planned for all others, none of which changes.
//
// Safe interval path planning (Phillips and Likhachev, "SIPP: Safe interval path planning for dynamic environments",
// 2011), with positions in the sequence of moves in place of times: at position p the first p moves have been made. At
// a vertex a robot may rest from one position to another as long as no move between them needs its place. A move of its
// own at a position has to keep clear of all robots that rest there then. Of all ways the one is taken that arrives
// first, by the estimated times of the moves; delays of others count, too. The robot waits at places that no move
// needs.
//
// Cost of a search: a row for each vertex and interval that is reached, with a look at the moves near each exit.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/traffic/formation.h"
#include "common/traffic/traffic_graph.h"

namespace troupe {

// A move of the plan that has not been granted, with the time in which it probably happens.
struct TimedMove {
  RowMove move;
  double start = 0.0;   // s, from now
  double finish = 0.0;  // s
};

class PlanInsertion {
 public:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // A move of the robot, after the first `position` moves of the others.
  struct Step {
    std::size_t position = 0;
    TrafficExit exit;
  };

  // `places`: of all robots before the first move. `moves`: of all robots but `row`; those of `row` do not count.
  // `ready`: s, when the robot may begin. `busy`: by lane, when granted moves near it have been made, s. All outlive
  // it.
  PlanInsertion(const TrafficGraph& graph, const std::vector<bool>& closed, std::span<const std::uint32_t> places,
                std::span<const TimedMove> moves, std::uint32_t row, double ready, std::span<const double> busy);

  // A way that ends at a goal, to stay. `seconds_to_goal`: by vertex. `delay_weight`: of a second that another robot
  // loses, against one of its own. Nothing: there is no such way.
  std::optional<std::vector<Step>> Find(std::uint32_t goal, const std::vector<float>& seconds_to_goal,
                                        double delay_weight);

 private:
  struct Range {
    std::size_t begin = 0;  // the first position
    std::size_t end = 0;    // the last one
  };
  // When others are near a lane, by their positions.
  struct Conflicts {
    bool is_known = false;
    std::vector<std::size_t> positions;  // of moves, ascending
    std::vector<double> latest_finish;   // s, of the moves up to each of these
    std::vector<double> earliest_start;  // s, of the moves from each of these on
  };
  // At rest at a vertex, in the search.
  struct State {
    std::uint32_t vertex = 0;
    std::size_t position = 0;
    Range rest = {};
    double seconds = 0.0;  // at rest there from then on
    double delays = 0.0;   // s, of others
    std::uint32_t parent = Formation::kNone;
    TrafficExit by = {};
  };

  void FindStays();
  void FindHits();
  bool IsFreeAtEnd(std::uint32_t vertex) const;
  Range RestAt(std::uint32_t vertex, std::size_t position) const;
  const std::vector<Range>& FreeRanges(std::uint32_t from, const TrafficExit& exit);
  const Conflicts& ConflictsOf(std::uint32_t lane);
  template <typename Visit>
  void ForEachNext(const State& state, const TrafficExit& exit, double delay_weight, const Visit& visit);

  const TrafficGraph& graph_;
  const std::vector<bool>& closed_;
  std::span<const std::uint32_t> places_;
  std::span<const TimedMove> moves_;
  std::uint32_t row_;
  double ready_;
  std::span<const double> busy_;
  std::vector<std::vector<Range>> stays_;                // by vertex, of others
  std::vector<std::vector<Range>> members_;              // by group
  std::vector<std::vector<std::size_t>> hits_;           // by vertex: moves that need it, ascending
  std::vector<std::optional<std::vector<Range>>> free_;  // by lane and direction
  std::vector<Conflicts> conflicts_;                     // by lane
  std::vector<std::vector<std::size_t>> moves_on_;       // by lane
  std::vector<std::vector<std::size_t>> moves_in_;       // by group
};

}  // namespace troupe
