// PlannedWay: the way of a robot that takes part in the planned traffic of its lanes (TrafficRobot).
//
// The plan is made in the step, once for all robots, and is a part of the state. A robot reads the moves that it may
// make, drives along them, and reports each that it has finished by its TrafficOrder. It never begins a move that is
// not granted, so that its only decision is how fast it drives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "robot-agent/navigation/lane_route.h"
#include "troupe/ids.h"
#include "troupe/order.h"
#include "troupe/world_state.h"

namespace troupe {

class PlannedWay {
 public:
  // `graph`: one of `graphs`, which are all of the world.
  PlannedWay(RobotId own, const LaneGraph& graph, std::span<const LaneGraph> graphs);

  // The plan of a tick. The first one may have a row of the robot already: of a controller before this one, whose moves
  // are continued.
  void Read(const WorldState& state);
  bool takes_part() const { return takes_part_; }
  // Another robot is at a vertex of the own graph, or has a granted move to it.
  bool IsTaken(std::size_t vertex) const;
  // The vertex that the robot was at last. REQUIRES: it takes part.
  std::size_t at() const { return at_; }

  // The granted moves as legs: from the vertex that the robot was at last. A move back to that vertex is a leg from it
  // to itself.
  std::vector<Leg> Legs() const;
  // The robot is at the end of the first leg.
  void Finish();
  // Moves since it takes part, modulo 2^32.
  std::uint32_t finished() const { return finished_; }

  // With the numbers of all graphs. `at`, `goal`: vertices of its graph.
  TrafficOrder OrderFor(std::size_t at, std::optional<std::size_t> goal) const;

 private:
  RobotId own_;
  std::uint32_t first_vertex_ = 0;  // of its graph, among those of all
  std::uint32_t first_lane_ = 0;
  std::uint32_t lane_count_ = 0;
  bool has_read_ = false;
  bool takes_part_ = false;
  std::uint32_t finished_ = 0;
  std::uint32_t at_ = 0;
  std::vector<TrafficMove> moves_;    // granted, and not finished
  std::vector<std::uint32_t> taken_;  // vertices of other robots, ascending; only as long as it takes no part
};

}  // namespace troupe
