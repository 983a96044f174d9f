// GivingWay: what a robot on lanes does when another one is in its way, or waits for it: it takes another route, or
// goes to a free vertex beside the way for a while; and what it does before a box, a person or a door.
//
// Robots do not talk to each other: each sees the others in the frame, and decides by rules that break symmetry. The
// robot with the larger id gives way after a shorter time; random parts of the times come from Observation::Random, so
// that a run repeats. Two robots face to face are resolved because after different times one of them takes a detour or
// steps aside.
//
// What does not give way itself closes the lane for the robot, for a time that doubles with each block of the same lane
// (ClosedLanes), so that it neither tries in vain for ever nor misses for long that the lane is free again.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "robot-agent/navigation/lane_obstacles.h"
#include "robot-agent/navigation/lane_route.h"
#include "robot-agent/navigation/lane_traffic.h"
#include "troupe/controller.h"

namespace troupe {

// A robot among others, in one tick.
struct LanePlace {
  const Observation& now;
  std::size_t vertex = 0;  // that it was at last
  std::optional<std::size_t> target = {};
  const std::vector<SeenRobot>& others;
  double radius = 0.0;      // m
  double half_width = 0.0;  // m
};

// The way that a robot takes instead of its own.
struct WayAround {
  std::vector<Leg> legs;
  bool is_on_first = false;                  // it is on the first leg, back to the vertex from which it came
  std::optional<double> seconds_aside = {};  // at the end of the legs, which is no destination
};

// What a robot does after it has been blocked for a while.
struct BlockEnd {
  std::optional<WayAround> way = {};  // nothing: it goes on waiting
  std::optional<double> closed = {};  // s, that the lane counts as closed; nothing: it does not, or did already
};

class GivingWay {
 public:
  // `graphs`: all of the world, of which `graph` is its own; they outlive this. `speed`: m/s.
  GivingWay(RobotId own, const LaneGraph& graph, std::span<const LaneGraph> graphs, double speed)
      : own_(own), graph_(&graph), graphs_(graphs), speed_(speed) {}

  // Another robot blocks `leg`; `is_away`: this one has left the start of the leg. Called in each tick in which that is
  // so. After a while there is an end, with a way if one exists.
  std::optional<BlockEnd> OnBlocked(const LanePlace& place, RobotId other, const Leg& leg, bool is_away);
  // The same of an obstacle that makes no room. `is_back_free`: nothing is on the way back to the start of the leg. If
  // no other route leads to its target, the robot stays, and asks again once the lane does not count as closed any
  // more, or for another target. Without a target it goes back. REQUIRES: the leg has a lane
  std::optional<BlockEnd> OnObstacle(const LanePlace& place, const Leg& leg, bool is_away, bool is_back_free);
  static constexpr double kObstacleSeconds = 8.0;  // until a lane with an obstacle counts as closed
  // In each other tick, so that waits for other things are no part of that while.
  void OnFree(double time) {
    blocked_since_.reset();
    // A robot that moves to and fro before a person has not passed it.
    if (obstacle_wait_ && time - obstacle_wait_->seen_at > kFreeSeconds) obstacle_wait_.reset();
  }
  static constexpr double kFreeSeconds = 2.0;
  void OnPassed(std::size_t lane) { closed_.Forget(lane); }
  // Lanes that it does not begin, whatever is on them; ascending.
  void Bar(std::vector<std::size_t> lanes) { barred_ = std::move(lanes); }

  // The fastest route without closed lanes; with them if there is no other, and never along barred ones.
  std::optional<LaneRoute> FindRoute(std::size_t from, std::size_t to, double time) const;

  // Another robot stands near this one, `towards` it (zero: on any side), and so perhaps waits for it.
  static bool IsAskedForRoom(const LanePlace& place, const Vec2& towards);
  // The same of a robot without a destination: only one on a lane through its place, of any graph, that is not parked
  // at a charger, waits for it. Robots that are parked beside each other stay.
  bool IsInTheWay(const LanePlace& place) const;
  static constexpr double kPoliteSeconds = 8.0;  // until a robot that waits makes room

  // To a random free neighbour of its vertex, except `not_to`. Nothing if there is none.
  std::optional<WayAround> StepAside(const LanePlace& place, std::optional<std::size_t> not_to = {}) const;

 private:
  static bool StandsNear(const LanePlace& place, const SeenRobot& other);
  std::optional<WayAround> FindDetour(const LanePlace& place, const Leg& leg, double worth);
  WayAround BackFirst(WayAround way, const Leg& leg) const;
  // With those that are barred; ascending.
  std::vector<std::size_t> ClosedAt(double time) const;

  // Before an obstacle.
  struct ObstacleWait {
    double until = 0.0;    // s, simulated
    double seen_at = 0.0;  // likewise: the last time
    bool is_closed = false;
    std::optional<std::size_t> target = {};  // for which it has found no way
  };

  RobotId own_;
  const LaneGraph* graph_;
  std::span<const LaneGraph> graphs_;
  double speed_;
  std::optional<double> blocked_since_;  // s, simulated
  double give_way_seconds_ = 0.0;
  std::optional<ObstacleWait> obstacle_wait_;
  ClosedLanes closed_;
  std::vector<std::size_t> barred_;
};

}  // namespace troupe
