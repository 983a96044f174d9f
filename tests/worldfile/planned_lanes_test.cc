// Robots on lanes that take part in the planned traffic: where robots that find their own ways stand for ever.
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

}  // namespace
}  // namespace troupe
