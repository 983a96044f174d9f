// TrafficWays: the moves that bring all robots of a traffic to their goals, as one sequence from where they are.
//
// A robot with a new goal gets a way among the moves of the others, which stay as they are (plan_insertion.h). Without
// such a way, others have to make room: a search (traffic_search.h) then adds moves after all those that are planned,
// when the others have been at their goals. Of the robots that wait for that, the one goes first that needs the fewest
// moves of all, and that has waited longest: so robots change places where that is easy, and none is left out. The more
// of its vertices are taken, the fewer robots make others move at a time.
//
// In each tick one robot has its way planned anew, among those of the others as they are by then: delays would else add
// up. All of it keeps the sequence possible; the first move can always be made.
//
// A pure function of its arguments. Cost of a tick: a look at each move; insertions for robots with new goals, and
// some others, up to kMaxInsertionVisits; every kSearchTicks, kMaxCandidates searches.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/traffic/formation.h"
#include "common/traffic/move_sequence.h"
#include "common/traffic/plan_insertion.h"
#include "common/traffic/traffic_graph.h"
#include "common/traffic/traffic_routes.h"
#include "troupe/traffic_state.h"

namespace troupe {

class TrafficWays {
 public:
  static constexpr std::uint32_t kTurnTicks = 10;             // between two tries of a robot that waits for a way
  static constexpr std::size_t kMaxInsertionVisits = 15'000;  // of vertices, after which others wait
  static constexpr std::uint32_t kSearchTicks = 5;            // between two searches for ways past others
  static constexpr std::size_t kMaxCandidates = 8;            // of a search
  static constexpr std::size_t kMinOnWay = 3;                 // robots for which others may be moved at a time
  static constexpr std::size_t kFreePerRobot = 4;             // free vertices for one more of them
  static constexpr double kTicksPerMove = 100.0;              // that a robot has waited count as much as a move
  static constexpr std::size_t kMaxVisits = 100'000;          // of vertices, in the searches of a tick
  // For the oldest goal, once in a while, so that its way is found if there is one.
  static constexpr std::uint32_t kThoroughTicks = 100;
  static constexpr std::size_t kMaxThoroughVisits = 2'000'000;

  // `closed`: by lane. `robots`: by row. `is_fixed`: by row, those that stay where they are. `granted`, `moves`: in the
  // order of the plan; no granted one depends on one that is not. All outlive it, but for the moves.
  TrafficWays(TrafficRoutes& routes, const std::vector<bool>& closed, std::vector<TrafficRobot>& robots,
              const std::vector<bool>& is_fixed, std::span<const RowMove> granted, std::vector<RowMove> moves);

  // Drops the moves that are not possible any more, and those after them of the same robots.
  void KeepPossible();
  // Moves all robots near a vertex off a lane.
  void MakeRoom(std::uint32_t vertex, std::uint32_t lane);
  // Ways of the robots that have none. A goal that is the oldest, and has no way, counts as new.
  void Plan(Tick tick);

  const std::vector<RowMove>& moves() const { return moves_; }
  // By row: that of a robot in the way of one without a way.
  std::vector<std::optional<std::uint32_t>> FindBlockers() const;

 private:
  bool IsOnWay(std::uint32_t row) const;
  void FindThoseWithoutWay();
  std::vector<std::uint32_t> EndPlaces() const;
  void InsertWays(std::span<const std::uint32_t> order, Tick tick);
  void SearchPastOthers(std::span<const std::uint32_t> order, Tick tick);
  std::optional<std::vector<RowMove>> Push(std::uint32_t row, std::size_t& visits,
                                           std::span<const std::uint32_t> ends) const;

  TrafficRoutes& routes_;
  const TrafficGraph& graph_;
  const std::vector<bool>& closed_;
  std::vector<TrafficRobot>& robots_;
  const std::vector<bool>& is_fixed_;
  std::span<const RowMove> granted_;
  std::vector<RowMove> moves_;         // that have not been granted
  std::vector<std::uint32_t> places_;  // by row, after the granted moves
  std::vector<bool> has_no_way_;       // by row
};

// A robot at its goal stays there until it gets another one, or none.
inline bool IsAtGoal(const TrafficRobot& robot) {
  return robot.held > 0 || robot.goal == robot.at;
}

}  // namespace troupe
