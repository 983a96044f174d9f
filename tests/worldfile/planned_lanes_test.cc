// Robots on lanes that take part in the planned traffic: where robots that find their own ways stand for ever.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/worldfile/on_lanes.h"
#include "tests/worldfile/scenario_run.h"

namespace troupe {
namespace {

constexpr const char* kJunction = R"(
name: junction
coordinate_system: cartesian_meters
levels:
  L1:
    elevation: 0
    vertices:
      - [6, 2, 0, a, {spawn_robot_name: [1, r1], spawn_robot_type: [1, TinyRobot]}]
      - [2, 6, 0, b, {spawn_robot_name: [1, r2], spawn_robot_type: [1, TinyRobot]}]
      - [6, 6, 0, ""]
      - [10, 10, 0, c]
      - [14, 14, 0, d]
    lanes:
      - [0, 2, {bidirectional: [4, true]}]
      - [1, 2, {bidirectional: [4, true]}]
      - [2, 3, {bidirectional: [4, true]}]
      - [3, 4, {bidirectional: [4, true]}]
)";

constexpr const char* kSiding = R"(
name: siding
coordinate_system: cartesian_meters
levels:
  L1:
    elevation: 0
    vertices:
      - [0, 0, 0, a, {spawn_robot_name: [1, r1], spawn_robot_type: [1, TinyRobot]}]
      - [5, 0, 0, ""]
      - [10, 0, 0, ""]
      - [15, 0, 0, b, {spawn_robot_name: [1, r2], spawn_robot_type: [1, TinyRobot]}]
      - [10, 2, 0, ""]
    lanes:
      - [0, 1, {bidirectional: [4, true]}]
      - [1, 2, {bidirectional: [4, true]}]
      - [2, 3, {bidirectional: [4, true]}]
      - [2, 4, {bidirectional: [4, true]}]
)";

std::string Planned(const std::string& name, const std::string& places) {
  return OnLanes(name, R"({"planned": true, "places": )" + places + "}");
}

struct Visit {
  std::string robot;
  Vec2 first{0.0, 0.0};
  Vec2 second{0.0, 0.0};
};

// Each robot is at both of its places by turns, at least `rounds` times.
void ExpectRounds(const WorldDescription& world, const std::vector<Visit>& visits, int ticks, int rounds) {
  ScenarioRun run(world);
  std::vector<int> counts(visits.size(), 0);
  for (int i = 0; i < ticks; ++i) {
    run.Run(1);
    for (std::size_t k = 0; k < visits.size(); ++k) {
      const Vec2 next = counts[k] % 2 == 0 ? visits[k].first : visits[k].second;
      if ((run[visits[k].robot].X_WR.translation() - next).norm() < 0.15) ++counts[k];
      ASSERT_FALSE(run[visits[k].robot].stalled) << visits[k].robot << " at tick " << i;
    }
  }
  for (std::size_t k = 0; k < visits.size(); ++k) EXPECT_GE(counts[k], 2 * rounds) << visits[k].robot;
  EXPECT_EQ(run.state().traffic_robots.size(), visits.size());
}

TEST(PlannedLanes, RobotsPassAJunction) {
  test::TemporaryFolder folder;
  const WorldDescription world =
      LoadOnLanes(folder, kJunction, Planned("r1", R"(["d", "a"])") + ", " + Planned("r2", R"(["c", "b"])"));
  ExpectRounds(world, {{"r1", {14, 14}, {6, 2}}, {"r2", {10, 10}, {2, 6}}}, 4000, 2);
}

TEST(PlannedLanes, RobotsExchangeTheEndsOfALaneWithASiding) {
  test::TemporaryFolder folder;
  const WorldDescription world =
      LoadOnLanes(folder, kSiding, Planned("r1", R"(["b", "a"])") + ", " + Planned("r2", R"(["a", "b"])"));
  ExpectRounds(world, {{"r1", {15, 0}, {0, 0}}, {"r2", {0, 0}, {15, 0}}}, 4000, 2);
}

// A corridor of 12 m with a door in its middle, one of 4 m in a group, and one of 2 m.
constexpr const char* kCorridorOfWaits = R"(
name: corridor
coordinate_system: cartesian_meters
levels:
  L1:
    elevation: 0
    vertices:
      - [0, 0, 0, a, {spawn_robot_name: [1, r1], spawn_robot_type: [1, TinyRobot]}]
      - [12, 0, 0, b]
      - [12, 4, 0, c]
      - [10, 4, 0, d]
      - [6, -0.5, 0, ""]
      - [6, 0.5, 0, ""]
    doors:
      - [4, 5, {name: [1, gate], type: [1, hinged], motion_axis: [1, start], motion_direction: [2, 1]}]
    lanes:
      - [0, 1, {bidirectional: [4, true], speed_limit: [3, 0.4]}]
      - [1, 2, {mutex: [1, corner]}]
      - [2, 3, {}]
)";

TEST(PlannedLanes, LongLanesHaveWaitingPoints) {
  test::TemporaryFolder folder;
  const LaneGraph without =
      LoadOnLanes(folder, kCorridorOfWaits, OnLanes("r1", R"({"planned": false})")).lane_graphs[0];
  ASSERT_EQ(without.vertices.size(), 4u);
  ASSERT_EQ(without.lanes.size(), 3u);
  const LaneGraph graph = LoadOnLanes(folder, kCorridorOfWaits, OnLanes("r1", "{}")).lane_graphs[0];
  ASSERT_GT(graph.vertices.size(), 8u);
  EXPECT_EQ(graph.vertices.size() - 4, graph.lanes.size() - 3);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(graph.vertices[i], without.vertices[i]);
  double before_door = 12.0;
  double behind_door = 12.0;
  for (std::size_t i = 4; i < graph.vertices.size(); ++i) {
    const LaneVertex& point = graph.vertices[i];
    EXPECT_EQ(point.name, "");
    EXPECT_EQ(point.position.y(), 0.0);
    double& nearest = point.position.x() < 6.0 ? before_door : behind_door;
    nearest = std::min(nearest, std::fabs(point.position.x() - 6.0));
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GT((point.position - graph.vertices[k].position).norm(), 0.9) << i << ", " << k;
    }
  }
  // The leaf, 1 m long, opens to one side.
  EXPECT_GT(std::min(before_door, behind_door), 0.5);
  EXPECT_GT(std::max(before_door, behind_door), 1.2);
  // The parts follow each other from a to b, and one of them has the door.
  std::size_t at = 0;
  double length = 0.0;
  std::size_t doors = 0;
  while (at != 1) {
    const auto lane =
        std::find_if(graph.lanes.begin(), graph.lanes.end(), [&](const Lane& l) { return l.start == at; });
    ASSERT_NE(lane, graph.lanes.end());
    EXPECT_TRUE(lane->is_bidirectional);
    EXPECT_EQ(lane->speed_limit, 0.4);
    for (const LaneDoor& door : lane->doors) {
      EXPECT_DOUBLE_EQ(length + door.at, 6.0);
      ++doors;
    }
    length += graph.Way(lane->start, lane->end).norm();
    at = lane->end;
  }
  EXPECT_DOUBLE_EQ(length, 12.0);
  EXPECT_EQ(doors, 1u);
}

}  // namespace
}  // namespace troupe
