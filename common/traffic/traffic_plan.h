// TrafficPlan: the traffic of all robots on the lanes of a world, planned as one.
//
// A plan is a sequence of moves of robots along lanes, one after another, such that each keeps clear of all robots at
// rest. It is executed by an action dependency graph (Hoenig and others, 2019): a robot may begin a move once all
// earlier moves that conflict with it have been finished, or are clear of it: once a robot has left the start of a
// lane, others may go there. Moves that do not conflict happen at the same time, in
// whatever order robots are ready; so no delay of a robot breaks the plan, and the earliest move can always begin:
// there is no deadlock. Moves that have not been granted can be dropped at any time: the robots at rest, and those on
// granted moves at their ends, are again free of conflicts, and a new plan begins there.
//
// Each robot with a goal gets a whole way to it, among those of the others or past robots that make room
// (traffic_ways.h). The moves that have not been granted change while robots drive; those that have, do not. The robot
// with the oldest goal may move all others so; each robot becomes that one, and arrives, if the graph has room for it.
// If it has not, the goal counts as new, so that others go on, and perhaps make room.
//
// A pure function of its arguments: the plan is a part of the state of the world, and depends on no clock, no packing
// and no earlier call. Memory: the moves of a way for each robot. Cost of a tick: that of the ways.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/traffic/traffic_routes.h"
#include "troupe/ids.h"
#include "troupe/traffic_state.h"

namespace troupe {

// What a robot reports and wants in a tick. Without one a robot stays where it is, in the plan; after kMaxAbsent ticks
// it takes no part any more.
struct TrafficRequest {
  RobotId robot;
  std::uint32_t at = 0;  // the vertex of the graph that it is at, until it takes part
  std::optional<std::uint32_t> goal = {};
  bool holds = false;          // it stays where it is, for instance while it is loaded
  std::uint32_t finished = 0;  // moves since it takes part, modulo 2^32
  double driven = 0.0;         // m, along the lane of its present move
  bool is_blocked = false;     // a body that takes no part is in the way of its present move
};

struct TrafficPlan {
  std::vector<TrafficRobot> robots;   // ascending
  std::vector<TrafficMove> moves;     // in the order of the plan, those that are granted first
  std::vector<LaneClosure> closures;  // ascending
  bool operator==(const TrafficPlan&) const = default;
};

inline constexpr std::size_t kMaxGrants = 4;        // moves of a robot that it may make without another decision
inline constexpr std::uint32_t kClosedTicks = 600;  // a lane that a body blocks, for the first time
inline constexpr std::uint32_t kMaxClosedTicks = 36'000;
inline constexpr std::uint32_t kMaxHeld = 60;  // ticks at a goal, after which others go round
inline constexpr Tick kMaxAbsent = 100;

// The plan of the next tick. `routes`: of the graph. `requests`: ascending, at most one for each robot. `obstructed`:
// lanes that bodies outside of the traffic are on, by lane; no move begins there. A robot takes part once its vertex is
// free of others, and no longer without a request. REQUIRES: the plan is empty, or of this function for the same graph.
void PlanTraffic(TrafficRoutes& routes, std::span<const TrafficRequest> requests, const std::vector<bool>& obstructed,
                 Tick tick, TrafficPlan& plan);

}  // namespace troupe
