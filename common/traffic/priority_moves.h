// PriorityMoves: the next lanes of robots that go to their goals, by Priority Inheritance with Backtracking (Okumura
// and others, "Priority inheritance with backtracking for iterative multi-agent path finding", 2019).
//
// Robots choose in the order of their ranks. Each takes the lane that brings it nearest to its goal; a robot of a later
// rank in the way has to choose a lane with the rank of the one that it is in the way of, and so on, each out of the
// way of all before it. A choice that leads nowhere is taken back. In a graph in which each lane is a part of a cycle
// with room, the robot of the first rank always comes nearer to its goal.
//
// Cost of a choice: each robot in the way is asked once, and looks at its exits.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/traffic/formation.h"
#include "common/traffic/traffic_graph.h"

namespace troupe {

class PriorityMoves {
 public:
  struct Robot {
    const std::vector<float>* seconds_to_goal = nullptr;  // by vertex; null: it has no goal
    std::size_t rank = 0;
    bool can_move = true;  // false: it stays where it is
  };

  // `closed`: by lane. `robots`: by row. All outlive it.
  PriorityMoves(const TrafficGraph& graph, const std::vector<bool>& closed, Formation& formation,
                std::vector<Robot>& robots)
      : graph_(graph), closed_(closed), formation_(formation), robots_(robots), states_(robots.size()) {}

  // Adds moves that bring a robot nearer to its goal, and those of the robots that make room: up to `most` lanes of its
  // own, or more up to a vertex at which it may wait. A robot that has moved cannot be moved by others. False: there is
  // no such lane now, and the formation is as before.
  bool Advance(std::uint32_t row, std::uint32_t goal, std::size_t most);
  // Moves a robot off a lane, and all in its way, whatever their ranks.
  bool MakeRoom(std::uint32_t row, std::uint32_t lane);
  // After Advance without a lane: the row of a robot in the way of the best one; nothing: no robot is.
  std::optional<std::uint32_t> blocker() const { return blocker_; }

 private:
  struct State {
    std::size_t failed_in = 0;  // the call of Advance in which it found no lane
    bool is_asked = false;      // now, on the way to the present choice
    std::size_t moves = 0;
  };

  bool Choose(std::uint32_t row, std::size_t rank);
  bool Clear(std::uint32_t row, const TrafficExit& exit, std::size_t rank);
  bool IsInTheWay(std::uint32_t vertex) const;
  void UndoTo(std::size_t count);

  const TrafficGraph& graph_;
  const std::vector<bool>& closed_;
  Formation& formation_;
  std::vector<Robot>& robots_;
  std::vector<State> states_;        // by row
  std::vector<std::uint32_t> ways_;  // lanes of the robots that have been asked, and wait for room
  std::size_t call_ = 0;
  std::optional<std::uint32_t> blocker_;
};

}  // namespace troupe
