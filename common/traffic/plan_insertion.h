// PlanInsertion: a way of one robot to its goal among the moves that are planned for all others, none of which changes.
//
// Safe interval path planning (Phillips and Likhachev, "SIPP: Safe interval path planning for dynamic environments",
// 2011), with positions in the sequence of moves in place of times (move_sequence.h). At a vertex a robot may rest from
// one position to another as long as no move between them needs its place. A move of its own at a position has to keep
// clear of all robots that rest there then. Of all ways the one is taken that arrives first, by the estimated times of
// the moves; delays of others count, too. The robot waits at places that no move needs.
//
// Cost of a search: a row for each vertex and interval that is reached, with a look at the moves near each exit.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "common/traffic/move_sequence.h"
#include "common/traffic/traffic_graph.h"

namespace troupe {

class PlanInsertion {
 public:
  // Of vertices, in a search: after some it looks for any way, which is not much longer.
  static constexpr std::size_t kExactVisits = 3'000;
  static constexpr double kHaste = 4.0;  // the weight of the time to the goal from then on
  static constexpr std::size_t kMaxVisits = 20'000;
  // Where the others will shut the robot off from its goal, so that it has to pass before them.
  static constexpr std::size_t kMaxVisitsOfShut = 5'000;

  // `closed`: by lane. Both outlive it. It serves many searches.
  PlanInsertion(const TrafficGraph& graph, const std::vector<bool>& closed);

  // A way of a robot that ends at a goal, to stay. `seconds_to_goal`: by vertex. `delay_weight`: of a second that
  // another robot loses, against one of its own. Nothing: there is no such way. REQUIRES: the robot has been taken out.
  std::optional<std::vector<MoveSequence::Step>> Find(const MoveSequence& sequence, std::uint32_t row,
                                                      std::uint32_t goal, const std::vector<float>& seconds_to_goal,
                                                      double delay_weight);
  // Of vertices, by all searches.
  std::size_t visits() const { return visits_; }

 private:
  using Position = MoveSequence::Position;

  bool IsOpenAtEnd(const MoveSequence& sequence, std::uint32_t from, std::uint32_t goal) const;
  bool IsDone(std::uint32_t vertex, Position begin, Position position) const;
  bool SetDone(std::uint32_t vertex, Position begin, Position position);

  const TrafficGraph& graph_;
  const std::vector<bool>& closed_;
  // By vertex, the beginnings of rests with the least position at which each has been left.
  std::vector<std::vector<std::pair<Position, Position>>> done_;
  std::vector<std::uint32_t> reached_;  // vertices of `done_` that are not empty
  std::size_t visits_ = 0;
};

}  // namespace troupe
