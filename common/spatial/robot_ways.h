// The ways of a robot through its world, around static bodies: the grids on which they are searched, and whether there
// is one.
//
// A way is searched with a margin first, then for a robot that may turn anywhere, then for one that drives straight: so
// it keeps off walls where there is room, and still leads through a gap that is as wide as the robot.
//
// Pure functions of the world; grids are kept by it while they are in use (WalkRoutes::RobotGrid).
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "common/spatial/walk_grid.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/vec2.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

class Scene;

// The controllers that search their ways to goals (docs/controllers.md, "Ways to goals").
bool SearchesWays(const RobotDescription& robot);

// The radii (m) for which ways are searched, one after another; the last is the smallest.
std::array<double, 3> RadiiOfWays(const Scene& scene, RobotId robot);

// The grid of the robot's heights at `z` (m, W), for such a radius.
std::shared_ptr<const WalkGrid> GridOfRobot(const Scene& scene, RobotId robot, double z, double radius);

// Checks that a robot at X_WR finds ways to the points (m, W). The error names the first one to which none leads.
Status CheckWays(const Scene& scene, RobotId robot, const Pose& X_WR, std::span<const Vec2> points);

// The way of the robot from where it is in `state` through the points (m, W) to the last of them, around and through
// the zones that are on as theirs is (common/spatial/zone_ways.h); straight lines where none is found.
std::vector<Vec2> FindWays(const Scene& scene, const WorldState& state, RobotId robot, std::span<const Vec2> points);

}  // namespace troupe
