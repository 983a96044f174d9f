// PathSchedule: the order of the moves on given paths, as an action dependency graph (Hoenig and others, "Persistent
// and robust execution of MAPF schedules in warehouses", 2019).
//
// A path says at which step of its plan a robot is at each vertex. Of the plan only the order counts: a robot may begin
// a move to a vertex once the robot that was there before it, by the plan, has left it. So no delay of a robot leads to
// a collision or to another order, and the move of the least step that is not done can always begin: there is no
// deadlock. Moves of one step that go round in a circle, each to the start of the next one, begin together, once all
// their robots are there.
//
// FindConflict says why paths cannot be executed: two robots at one vertex in one step, or two that change places.
// Steps that a path leaves out are waits at the vertex before.
//
// Memory and cost: linear in the vertices of all paths, with a sort.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "troupe/ids.h"
#include "troupe/site_description.h"

namespace troupe {

// Two trips that meet.
struct PathConflict {
  std::size_t first = 0;   // their places among the trips; the one that is there first
  std::size_t second = 0;  // whose arrival is the conflict
  std::size_t place = 0;   // in the path of the second
  std::uint32_t step = 0;  // of the plan
  bool is_swap = false;    // they change places; else they are at one vertex
};

// The conflict of the least step; nothing: the paths are free of conflicts. REQUIRES: trips as Validate allows them.
std::optional<PathConflict> FindConflict(std::span<const LaneTrip> trips);

class PathSchedule {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  // A move of a path: to its vertex `move + 1`.
  struct Need {
    std::uint32_t trip = kNone;  // whose move has to be done before; kNone: none
    std::uint32_t moves = 0;     // that this trip has to have done
    std::uint32_t circle = kNone;
  };
  struct CircleMove {
    std::uint32_t trip = 0;
    std::uint32_t move = 0;
  };

  // `trips`: those of the world; the ones without a path have no moves.
  explicit PathSchedule(std::span<const LaneTrip> trips);

  // No trip has a path.
  bool empty() const { return needs_.empty(); }
  // By robot: the place of its trip among the trips; kNone without a path.
  std::uint32_t TripOf(RobotId robot) const {
    return robot.index() < trip_of_.size() ? trip_of_[robot.index()] : kNone;
  }
  std::size_t MovesOf(std::uint32_t trip) const { return first_[trip + 1] - first_[trip]; }
  const Need& NeedOf(std::uint32_t trip, std::size_t move) const { return needs_[first_[trip] + move]; }
  std::span<const CircleMove> circle(std::uint32_t number) const {
    return std::span(circle_moves_).subspan(circles_[number], circles_[number + 1] - circles_[number]);
  }

 private:
  void FindCircles(std::span<const LaneTrip> trips);

  std::vector<std::uint32_t> trip_of_;  // by robot
  std::vector<std::size_t> first_;      // by trip, in needs_, and the end
  std::vector<Need> needs_;
  std::vector<std::size_t> circles_ = {0};  // by circle, in circle_moves_, and the end
  std::vector<CircleMove> circle_moves_;
};

}  // namespace troupe
