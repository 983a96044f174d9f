#include "common/traffic/traffic_graph.h"

#include <gmock/gmock.h>

#include "tests/unit/common/traffic/traffic_world.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;

std::vector<std::uint32_t> ListOf(std::span<const std::uint32_t> numbers) {
  return {numbers.begin(), numbers.end()};
}

std::vector<std::uint32_t> EndsOf(const TrafficGraph& graph, std::uint32_t vertex) {
  std::vector<std::uint32_t> ends;
  for (const TrafficExit& exit : graph.exits(vertex)) ends.push_back(exit.to);
  return ends;
}

TEST(TrafficGraphTest, LanesLeadInTheirDirections) {
  LaneDraft draft;
  for (int i = 0; i < 3; ++i) draft.Add(2.0 * i, 0.0);
  draft.Join(0, 1, false);
  draft.Join(1, 2);
  const TrafficGraph graph = GraphOf({draft.graph});
  EXPECT_THAT(EndsOf(graph, 0), ElementsAre(1));
  EXPECT_THAT(EndsOf(graph, 1), ElementsAre(2));
  EXPECT_THAT(EndsOf(graph, 2), ElementsAre(1));
}

TEST(TrafficGraphTest, PlacesConflictWithinTheClearance) {
  LaneDraft draft;
  draft.Add(0.0, 0.0);
  draft.Add(4.0, 0.0);
  draft.Add(2.0, 0.5);  // beside the lane
  draft.Add(2.0, 0.7);  // farther away
  draft.Add(2.3, 0.5);  // near the third one
  draft.Join(0, 1);
  draft.Join(2, 3);
  const TrafficGraph graph = GraphOf({draft.graph});
  EXPECT_THAT(ListOf(graph.VerticesNearLane(0)), ElementsAre(0, 1, 2, 4));
  EXPECT_THAT(ListOf(graph.VerticesNearVertex(2)), ElementsAre(2, 3, 4));
  EXPECT_THAT(ListOf(graph.VerticesNearVertex(0)), ElementsAre(0));
  EXPECT_THAT(ListOf(graph.LanesNearLane(0)), ElementsAre(0, 1));
}

TEST(TrafficGraphTest, TheRestOfALaneIsClearOfItsStart) {
  LaneDraft draft;
  for (int i = 0; i < 3; ++i) draft.Add(4.0 * i, 0.0);
  draft.Add(12.0, 0.0, "a");
  draft.Add(0.3, 0.0);
  for (std::uint32_t i = 0; i < 3; ++i) draft.Join(i, i + 1);
  draft.Join(0, 4);
  const TrafficGraph graph = GraphOf({draft.graph});
  EXPECT_NEAR(graph.leave_distance(1), kClearance, 0.002);
  EXPECT_THAT(ListOf(graph.LanesNearLane(1)), ElementsAre(0, 1, 2));
  EXPECT_THAT(ListOf(graph.LanesNearRest(1, 2)), ElementsAre(1, 2));
  EXPECT_THAT(ListOf(graph.LanesNearRest(1, 1)), ElementsAre(0, 1));
  EXPECT_THAT(ListOf(graph.GroupsOfRest(2, 3)), ElementsAre(0));
  EXPECT_THAT(ListOf(graph.GroupsOfRest(2, 2)), ElementsAre());
  EXPECT_TRUE(std::isinf(graph.leave_distance(3))) << "it is shorter than that";
}

TEST(TrafficGraphTest, LanesThatCrossConflictAlsoOfDifferentGraphs) {
  LaneDraft one;
  one.Add(0.0, 0.0);
  one.Add(10.0, 0.0);
  one.Join(0, 1);
  LaneDraft other;
  other.Add(5.0, -5.0);
  other.Add(5.0, 5.0);
  other.Join(0, 1);
  const TrafficGraph graph = GraphOf({one.graph, other.graph});
  EXPECT_EQ(graph.VertexOf(1, 0), 2u);
  EXPECT_EQ(graph.NumberOf(1, 3), 1u);
  EXPECT_FALSE(graph.IsOf(0, 2));
  EXPECT_EQ(graph.LaneNumberOf(1, 1), 0u);
  EXPECT_THAT(ListOf(graph.LanesNearLane(0)), ElementsAre(0, 1));
  EXPECT_THAT(ListOf(graph.LanesNearLane(1)), ElementsAre(0, 1));
}

TEST(TrafficGraphTest, LevelsDoNotConflict) {
  LaneDraft draft;
  draft.Add(0.0, 0.0);
  draft.Add(0.1, 0.0);
  draft.graph.vertices[1].z = 3.0;
  const TrafficGraph graph = GraphOf({draft.graph});
  EXPECT_THAT(ListOf(graph.VerticesNearVertex(0)), ElementsAre(0));
}

TEST(TrafficGraphTest, ALiftIsAGroupWithARideBetweenItsFloors) {
  LaneDraft draft;
  for (std::uint32_t i = 0; i < 3; ++i) {
    draft.Add(0.0, 0.0);
    draft.graph.vertices[i].lift = 0;
    draft.graph.vertices[i].floor = i;
    draft.graph.vertices[i].z = 3.0 * i;
  }
  const TrafficGraph graph = GraphOf({draft.graph});
  EXPECT_EQ(graph.lanes(), 3u);
  EXPECT_EQ(graph.LaneNumberOf(0, 0), TrafficGraph::kRide);
  EXPECT_THAT(EndsOf(graph, 1), ElementsAre(0, 2));
  EXPECT_EQ(graph.exits(0)[1].seconds, 26.0);
  EXPECT_THAT(ListOf(graph.GroupsOfVertex(2)), ElementsAre(0));
  EXPECT_THAT(ListOf(graph.GroupsOfLane(0)), ElementsAre(0));
  EXPECT_FALSE(graph.IsOpen(0));
}

TEST(TrafficGraphTest, ALaneIsInTheGroupsOfItsEnds) {
  LaneDraft draft;
  draft.Add(0.0, 0.0, "a");
  draft.Add(2.0, 0.0);
  draft.Add(4.0, 0.0, "b");
  draft.Join(0, 1);
  draft.Join(1, 2);
  draft.graph.lanes[1].mutex = "a";
  const TrafficGraph graph = GraphOf({draft.graph});
  EXPECT_THAT(ListOf(graph.GroupsOfLane(0)), ElementsAre(0));
  EXPECT_THAT(ListOf(graph.GroupsOfLane(1)), ElementsAre(0, 1));
  EXPECT_TRUE(graph.IsOpen(1));
}

}  // namespace
}  // namespace troupe
