// ExecutePaths: the traffic of robots on given paths, in place of a plan of its own (traffic_plan.h).
//
// Robots report as in the planned traffic, and are granted the moves of their paths, up to kMaxGrants ahead, in the
// order of path_schedule.h: a robot that has driven far enough along its lane has left the vertex before. The plan has
// only the moves that are granted and not done. A robot without a request stays where it was, and those after it wait;
// one that takes no part yet has made no move.
//
// A pure function of its arguments. Cost: linear in the robots and their granted moves.
#pragma once

#include <span>

#include "common/traffic/path_schedule.h"
#include "common/traffic/traffic_graph.h"
#include "common/traffic/traffic_plan.h"

namespace troupe {

// The plan of the next tick. `requests`: ascending, at most one for each robot; those of robots without a path have no
// effect. A robot takes part once it is at the vertex of its path at which it says to be. REQUIRES: `schedule` is that
// of `trips`; the plan is empty, or of this function for the same graph and trips.
void ExecutePaths(const TrafficGraph& graph, const PathSchedule& schedule, std::span<const LaneTrip> trips,
                  std::span<const TrafficRequest> requests, Tick tick, TrafficPlan& plan);

}  // namespace troupe
