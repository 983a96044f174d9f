// Fleets on random graphs that have room: whatever the graph, its robots, their delays, losses and the bodies on lanes,
// robots arrive again and again.
//
// A graph has room for robots that share its n vertices if it stays connected without any one of them, and one vertex
// is free, or two where lanes lead one way: then each robot can be brought to each vertex (Kornhauser and others, 1984;
// Botea and Surynek, 2015, for directed graphs).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/common/traffic/traffic_world.h"

namespace troupe {
namespace {

using Neighbours = std::vector<std::vector<std::uint32_t>>;  // by vertex, those to which lanes lead

Neighbours NeighboursOf(const LaneGraph& graph) {
  Neighbours neighbours(graph.vertices.size());
  for (const Lane& lane : graph.lanes) {
    neighbours[lane.start].push_back(lane.end);
    if (lane.is_bidirectional) neighbours[lane.end].push_back(lane.start);
  }
  return neighbours;
}

Neighbours Reversed(const Neighbours& neighbours) {
  Neighbours reversed(neighbours.size());
  for (std::uint32_t vertex = 0; vertex < neighbours.size(); ++vertex) {
    for (const std::uint32_t other : neighbours[vertex]) reversed[other].push_back(vertex);
  }
  return reversed;
}

bool ReachesAll(const Neighbours& neighbours, const std::vector<bool>& is_left_out) {
  const auto first = std::find(is_left_out.begin(), is_left_out.end(), false);
  std::vector<bool> reached = is_left_out;
  std::vector<std::uint32_t> open = {static_cast<std::uint32_t>(first - is_left_out.begin())};
  reached[open.front()] = true;
  while (!open.empty()) {
    const std::uint32_t vertex = open.back();
    open.pop_back();
    for (const std::uint32_t next : neighbours[vertex]) {
      if (!reached[next]) open.push_back(next);
      reached[next] = true;
    }
  }
  return std::find(reached.begin(), reached.end(), false) == reached.end();
}

// Whether each vertex reaches each other one by its lanes, and all of them still do so by lanes in any direction
// without any one. `without`: vertices that do not count.
bool HasRoom(const LaneGraph& graph, const std::vector<std::uint32_t>& without = {}) {
  const Neighbours forward = NeighboursOf(graph);
  const Neighbours backward = Reversed(forward);
  std::vector<bool> is_left_out(forward.size(), false);
  for (const std::uint32_t vertex : without) is_left_out[vertex] = true;
  if (!ReachesAll(forward, is_left_out) || !ReachesAll(backward, is_left_out)) return false;
  Neighbours either = forward;
  for (std::uint32_t vertex = 0; vertex < either.size(); ++vertex) {
    either[vertex].insert(either[vertex].end(), backward[vertex].begin(), backward[vertex].end());
  }
  for (std::uint32_t vertex = 0; vertex < either.size(); ++vertex) {
    if (is_left_out[vertex]) continue;
    std::vector<bool> more = is_left_out;
    more[vertex] = true;
    if (!ReachesAll(either, more)) return false;
  }
  return true;
}

// A grid that has lost as many of its lanes, and of their directions, as leave it room.
LaneGraph RandomGraph(Draws& draws, bool has_one_way_lanes) {
  const std::size_t width = 2 + draws.Below(4);
  const std::size_t height = 2 + draws.Below(4);
  LaneGraph graph = RandomGrid(draws, width, height, 0.0);
  for (std::size_t attempts = draws.Below(3 * graph.lanes.size()); attempts > 0; --attempts) {
    LaneGraph reduced = graph;
    const std::size_t at = draws.Below(reduced.lanes.size());
    if (has_one_way_lanes && draws.Chance(0.6)) {
      Lane& lane = reduced.lanes[at];
      lane.is_bidirectional = false;
      if (draws.Chance(0.5)) std::swap(lane.start, lane.end);
    } else {
      reduced.lanes.erase(reduced.lanes.begin() + static_cast<std::ptrdiff_t>(at));
    }
    if (HasRoom(reduced)) graph = std::move(reduced);
  }
  return graph;
}

// Lanes without which the graph has room.
std::vector<std::uint32_t> LanesToSpare(const LaneGraph& graph, const std::vector<std::uint32_t>& without) {
  std::vector<std::uint32_t> lanes;
  for (std::uint32_t lane = 0; lane < graph.lanes.size(); ++lane) {
    LaneGraph reduced = graph;
    reduced.lanes.erase(reduced.lanes.begin() + lane);
    if (HasRoom(reduced, without)) lanes.push_back(lane);
  }
  return lanes;
}

// `ticks`: on each graph.
void ExpectArrivals(std::uint64_t graphs, Tick ticks) {
  for (std::uint64_t seed = 0; seed < graphs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draws draws(seed);
    const bool has_one_way_lanes = draws.Chance(0.5);
    const LaneGraph lanes = RandomGraph(draws, has_one_way_lanes);
    const bool loses = draws.Chance(0.3);      // a robot ends
    const bool obstructs = draws.Chance(0.3);  // bodies that take no part appear on lanes, and vanish
    const std::size_t spare = has_one_way_lanes ? 2 : 1;
    const std::size_t most = lanes.vertices.size() - spare;
    TrafficRun run({lanes}, seed);
    const std::size_t robots = draws.Chance(0.3) ? most : 1 + draws.Below(most);
    for (std::uint32_t i = 0; i < robots; ++i) run.Place(i);
    // Of a robot, to its next arrival: on a full graph the others move one after another, each for a way.
    const Tick patience = 300 + 20 * robots * lanes.vertices.size();
    std::vector<std::uint32_t> lost;
    while (run.tick < ticks) {
      run.RunTick([&](std::size_t) {
        std::uint32_t goal = 0;
        do goal = static_cast<std::uint32_t>(draws.Below(lanes.vertices.size()));
        while (std::find(lost.begin(), lost.end(), goal) != lost.end());
        return std::optional(goal);
      });
      ASSERT_FALSE(::testing::Test::HasFatalFailure());
      for (const TrafficRun::Robot& robot : run.robots) {
        ASSERT_TRUE(robot.is_lost || run.tick - robot.since < patience)
            << "robot " << &robot - run.robots.data() << " of " << robots << " on " << lanes.vertices.size()
            << " vertices, tick " << run.tick;
      }
      if (loses && lost.empty() && run.tick > ticks / 2) {
        for (TrafficRun::Robot& robot : run.robots) {
          if (robot.moves || !HasRoom(lanes, {robot.at})) continue;
          robot.is_lost = true;
          lost = {robot.at};
          for (std::uint32_t lane = 0; lane < lanes.lanes.size(); ++lane) {
            if (lanes.lanes[lane].start == robot.at || lanes.lanes[lane].end == robot.at) run.obstructed[lane] = true;
          }
          for (TrafficRun::Robot& other : run.robots) {
            if (other.goal == robot.at) other.goal.reset();
          }
          break;
        }
      }
      if (obstructs && run.tick % 1000 == 0) {
        run.impassable.clear();
        const std::vector<std::uint32_t> free = LanesToSpare(lanes, lost);
        if (!free.empty() && draws.Chance(0.5)) run.impassable.push_back(free[draws.Below(free.size())]);
      }
    }
  }
}

TEST(TrafficPropertyTest, RobotsArriveOnGraphsWithRoom) {
  ExpectArrivals(40, 1500);
}

TEST(TrafficPropertyTest, DISABLED_RobotsArriveForALongTime) {
  ExpectArrivals(100, 100'000);
}

}  // namespace
}  // namespace troupe
