// The lanes of all graphs of a world as one row of numbers, and what an operator has ruled about them in a run: closed
// lanes, limits of speed, and zones that are on (troupe/site_state.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "troupe/world_state.h"

namespace troupe {

// A lane by its number through all graphs.
struct NumberedLane {
  const LaneGraph* graph = nullptr;
  std::size_t lane = 0;  // in LaneGraph::lanes
  const Lane& operator*() const { return graph->lanes[lane]; }
  const LaneVertex& start() const { return graph->vertices[graph->lanes[lane].start]; }
  const LaneVertex& end() const { return graph->vertices[graph->lanes[lane].end]; }
};
// REQUIRES: the world has that many lanes.
NumberedLane LaneOf(const WorldDescription& world, std::size_t number);

// "dock - hall": of the lane of the site that it is a part of.
std::string NameOfLane(const WorldDescription& world, std::size_t number);
// The first part of the first lane of the site between vertices of these names, in any direction.
std::optional<std::uint32_t> FindLane(const WorldDescription& world, const std::string& from, const std::string& to);

// The lanes on the same line as the lane of the site that this one is a part of, its own parts included: of all graphs
// and in both directions; ascending.
std::vector<std::uint32_t> LanesOnLine(const WorldDescription& world, std::size_t number);

// The lanes that no robot begins, ascending: those that are closed, and those on or through a zone of the kind keepout,
// or of `others`, that is on. One of the robots at `poses` that is in such a zone may leave it: then its lanes do not
// count.
std::vector<std::uint32_t> ClosedLanesFor(const WorldDescription& world, const WorldState& state,
                                          std::span<const Pose> poses, std::optional<ZoneKind> others = {});

// The release zone that is on before a robot at X_WR: it is not in it, and a straight way to `end` (m, W) leads through
// it. Of several the first.
std::optional<std::size_t> FindUnreleased(const WorldDescription& world, const WorldState& state, const Pose& X_WR,
                                          const Vec2& end);

// A lane is closed, or a keepout or release zone that is on is on it.
bool IsLaneClosed(const WorldDescription& world, const WorldState& state, std::uint32_t lane);

// The limit of the speed at a point, m/s: of a lane, if the point is on one, and of the speed zones that are on.
// Infinity: none.
double SpeedLimitAt(const WorldDescription& world, const WorldState& state, std::optional<std::uint32_t> lane,
                    const Vec2& point, double z);

}  // namespace troupe
