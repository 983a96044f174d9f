// Routes and the right of way on lanes, without a robot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "robot-agent/controller/site_controls.h"
#include "robot-agent/navigation/lane_route.h"
#include "robot-agent/navigation/lane_traffic.h"
#include "tests/support/values.h"
#include "tests/unit/robot-agent/controller/controlled_robot.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

LaneVertex Vertex(double x, double y, double z = 0.0) {
  LaneVertex vertex;
  vertex.position = {x, y};
  vertex.z = z;
  return vertex;
}

Lane Between(std::uint32_t start, std::uint32_t end, bool both_ways = true) {
  Lane lane;
  lane.start = start;
  lane.end = end;
  lane.is_bidirectional = both_ways;
  return lane;
}

// A square of 10 m with vertices 0 to 3 around it.
LaneGraph Square() {
  return {0,
          {Vertex(0, 0), Vertex(10, 0), Vertex(10, 10), Vertex(0, 10)},
          {Between(0, 1), Between(1, 2), Between(2, 3), Between(3, 0)}};
}

std::vector<std::size_t> Vertices(const std::optional<LaneRoute>& route) {
  std::vector<std::size_t> vertices;
  if (!route) return vertices;
  for (const Leg& leg : route->legs) vertices.push_back(leg.to);
  return vertices;
}

TEST(FastestRoute, PrefersSmallNumbersAmongEquals) {
  EXPECT_THAT(Vertices(FastestRoute(Square(), 0, 2, 1.0)), ElementsAre(1, 2));
  EXPECT_THAT(Vertices(FastestRoute(Square(), 3, 1, 1.0)), ElementsAre(0, 1));
  EXPECT_EQ(FastestRoute(Square(), 0, 2, 0.5)->seconds, 40.0);
  EXPECT_TRUE(FastestRoute(Square(), 2, 2, 1.0)->legs.empty());
}

TEST(FastestRoute, GoesAroundSlowOneWayAndClosedLanes) {
  LaneGraph graph = Square();
  graph.lanes[0].speed_limit = 0.5;
  EXPECT_THAT(Vertices(FastestRoute(graph, 0, 2, 1.0)), ElementsAre(3, 2));
  graph = Square();
  graph.lanes[0] = Between(1, 0, false);
  EXPECT_THAT(Vertices(FastestRoute(graph, 0, 1, 1.0)), ElementsAre(3, 2, 1));
  EXPECT_THAT(Vertices(FastestRoute(graph, 1, 0, 1.0)), ElementsAre(0));
  EXPECT_THAT(Vertices(FastestRoute(Square(), 0, 1, 1.0, {0})), ElementsAre(3, 2, 1));
  EXPECT_FALSE(FastestRoute(Square(), 0, 1, 1.0, {0, 2}));
  graph = Square();
  graph.lanes[0].doors = {{0, 1.0}, {1, 2.0}, {2, 3.0}, {3, 4.0}};
  EXPECT_THAT(Vertices(FastestRoute(graph, 0, 2, 1.0)), ElementsAre(3, 2));
}

TEST(FastestRoute, RidesALiftBetweenItsFloorsOnly) {
  LaneGraph graph{0, {Vertex(0, 0), Vertex(5, 0), Vertex(5, 0, 4), Vertex(0, 0, 4)}, {Between(0, 1), Between(2, 3)}};
  EXPECT_FALSE(FastestRoute(graph, 0, 3, 1.0));
  graph.vertices[1].lift = graph.vertices[2].lift = 0;
  graph.vertices[2].floor = 1;
  const std::optional<LaneRoute> route = FastestRoute(graph, 0, 3, 1.0);
  EXPECT_THAT(Vertices(route), ElementsAre(1, 2, 3));
  EXPECT_FALSE(route->legs[1].lane);
  EXPECT_EQ(route->legs[2].lane, 1u);
  graph.vertices[2].lift = 1;
  EXPECT_FALSE(FastestRoute(graph, 0, 3, 1.0));
}

TEST(NearestVertex, IsOnTheLevelOrAtThePoint) {
  const LaneGraph graph{0, {Vertex(0, 0, 4), Vertex(1, 0), Vertex(0, 0)}, {}};
  const auto nearest = [&](const Vec2& point, double z, double per_height) {
    return FindNearestVertex(graph, point, z, per_height)->vertex;
  };
  EXPECT_EQ(nearest({0.9, 0.0}, 0.0, kOnOneLevel), 1u);
  EXPECT_EQ(nearest({0.9, 0.0}, 4.0, kOnOneLevel), 0u);
  EXPECT_EQ(nearest({0.0, 0.0}, 0.0, kOnAnyLevel), 2u);
  EXPECT_EQ(nearest({0.0, 0.0}, 4.0, kOnAnyLevel), 0u);
  EXPECT_FALSE(FindNearestVertex(LaneGraph{}, {0.0, 0.0}, 0.0, kOnOneLevel));
  EXPECT_EQ(graph.Find(""), std::nullopt);
}

TEST(GraphAt, IsThatOfTheNearestVertexOfTheLevel) {
  const std::vector<LaneGraph> graphs = {{0, {Vertex(0, 0), Vertex(5, 0, 4)}, {}},
                                         {3, {Vertex(0, 0), Vertex(4, 0)}, {}}};
  EXPECT_EQ(GraphAt(graphs, {0.1, 0.0, 0.0, 0.0}), &graphs[0]) << "of two the first";
  EXPECT_EQ(GraphAt(graphs, {4.0, 0.0, 0.0, 0.0}), &graphs[1]);
  EXPECT_EQ(GraphAt(graphs, {4.0, 0.0, 4.0, 0.0}), &graphs[0]);
  EXPECT_EQ(GraphAt({}, {}), nullptr);
  EXPECT_EQ(FindGraph(graphs, 3), &graphs[1]);
  EXPECT_EQ(FindGraph(graphs, 1), nullptr);
}

TEST(LevelAt, IsTheNearest) {
  const std::vector<LevelDescription> levels = {{"low", 0.0}, {"high", 4.0}};
  EXPECT_EQ(LevelAt(levels, -9.0), "low");
  EXPECT_EQ(LevelAt(levels, 2.0), "low");
  EXPECT_EQ(LevelAt(levels, 2.1), "high");
  EXPECT_EQ(LevelAt({}, 2.1), "L1");
}

SeenRobot Seen(std::size_t id, double x, double y, bool moves, double z = 0.0) {
  return {RobotId(id), {x, y}, z, 0.3, moves};
}

// 0 --- 1 ===== 2 --- 3: the lane in the middle is the group.
LaneGraph Narrow() {
  LaneGraph graph{
      0, {Vertex(0, 0), Vertex(5, 0), Vertex(10, 0), Vertex(15, 0)}, {Between(0, 1), Between(1, 2), Between(2, 3)}};
  graph.lanes[1].mutex = "narrow";
  return graph;
}

TEST(MutexGroup, IsHeldByARobotInItOrMovingAtItsEnds) {
  LaneGraph graph = Narrow();
  const MutexGroup lane(graph, "narrow");
  const auto holder = [&](const SeenRobot& robot) { return lane.Look(graph, {robot}).holder.has_value(); };
  EXPECT_TRUE(holder(Seen(0, 7, 0.4, false)));
  EXPECT_FALSE(holder(Seen(0, 7, 0.6, false)));
  EXPECT_FALSE(holder(Seen(0, 7, 0, false, 4.0)));
  EXPECT_FALSE(holder(Seen(0, 5.1, 0, false)));
  EXPECT_TRUE(holder(Seen(0, 5.1, 0, true)));
  EXPECT_TRUE(holder(Seen(0, 10.1, 0.1, true)));
  EXPECT_FALSE(holder(Seen(0, 1, 0, true)));

  graph.vertices[1].mutex = "narrow";
  const MutexGroup wider(graph, "narrow");
  EXPECT_TRUE(wider.Look(graph, {Seen(0, 5.1, 0, false)}).holder);
  EXPECT_TRUE(wider.Look(graph, {Seen(0, 3, 0, true)}).holder) << "on the way to it";
  EXPECT_THAT(wider.Look(graph, {Seen(0, 0, 0, false), Seen(1, 2, 3, false), Seen(7, 10, 0, false)}).standing,
              ElementsAre(RobotId(0), RobotId(7)));
}

// Robots wait in the order in which they come, and not for ever for one that is parked.
TEST(MutexTurn, ComesAfterThoseThatStoodThereBefore) {
  const RobotId own(5);
  const auto view = [](std::optional<RobotId> holder, std::vector<RobotId> standing) {
    return MutexGroup::View{holder, std::move(standing)};
  };
  MutexTurn alone;
  EXPECT_TRUE(alone.MayEnter(view({}, {}), own, 0.0));
  MutexTurn second;
  EXPECT_FALSE(second.MayEnter(view({}, {RobotId(7)}), own, 0.0));
  EXPECT_FALSE(second.MayEnter(view(RobotId(7), {}), own, 1.0)) << "it has had its turn";
  EXPECT_TRUE(second.MayEnter(view({}, {RobotId(7)}), own, 2.0)) << "the robot has returned";
  MutexTurn parked;
  EXPECT_FALSE(parked.MayEnter(view({}, {RobotId(7)}), own, 0.0));
  EXPECT_FALSE(parked.MayEnter(view({}, {RobotId(7)}), own, 2.9));
  EXPECT_TRUE(parked.MayEnter(view({}, {RobotId(1), RobotId(7)}), own, 3.0)) << "a later one does not count";
  MutexTurn tie;
  EXPECT_FALSE(tie.MayEnter(view({}, {RobotId(1)}), own, 0.0));
  EXPECT_FALSE(tie.MayEnter(view({}, {RobotId(1)}), own, 3.5)) << "the smaller id goes first";
  EXPECT_TRUE(tie.MayEnter(view({}, {RobotId(1)}), own, 4.0));
  tie.Forget();
  EXPECT_TRUE(tie.MayEnter(view({}, {}), own, 5.0));
}

TEST(RobotAhead, IsTheNearestInTheWayOnTheLevel) {
  const std::vector<SeenRobot> others = {Seen(1, 3, 0.1, false), Seen(2, 2, 0.3, true), Seen(3, 1, 0.7, false),
                                         Seen(4, 1, 0, false, 4.0), Seen(5, -1, 0, false)};
  const std::optional<RobotAhead> ahead = FindRobotAhead(others, {0, 0}, 0.0, {1, 0}, 4.0, 0.3, 0.2);
  ASSERT_TRUE(ahead);
  EXPECT_EQ(ahead->robot.id, RobotId(2));
  EXPECT_NEAR(ahead->room, 1.4, 1e-12);
  EXPECT_FALSE(FindRobotAhead(others, {0, 0}, 0.0, {1, 0}, 1.0, 0.3, 0.2));
  EXPECT_FALSE(FindRobotAhead(others, {0, 0}, 0.0, {0, -1}, 4.0, 0.3, 0.2));
}

// A robot waits before the disc that a leaf sweeps, also where its way goes round a corner.
TEST(WayIntoDisc, EndsAtItsEdge) {
  const std::vector<Vec2> corner = {{0, 0}, {4, 0}, {4, 4}};
  EXPECT_NEAR(*WayIntoDisc(corner, {4, 3}, 1.0), 6.0, 1e-12);
  EXPECT_NEAR(*WayIntoDisc(corner, {3, 1}, std::sqrt(2.0)), 2.0, 1e-12) << "beside the first part";
  EXPECT_EQ(WayIntoDisc(corner, {0, 0.5}, 1.0), 0.0) << "it begins there";
  EXPECT_FALSE(WayIntoDisc(corner, {0, 4}, 3.9));
  EXPECT_FALSE(WayIntoDisc(corner, {-3, 0}, 2.9)) << "behind it";
}

TEST(SiteControls, KeepNoLiftWhoseLandingDoorIsBlocked) {
  LaneGraph graph = Square();
  graph.vertices[1].lift = 0;
  RobotInfo info;
  info.id = RobotId(0);
  info.doors = {{"landing", {10.0, 0.0}, 0.0, {}}};
  info.lifts = {{"lift", {11.0, 0.0}, {"L1", "L2"}, {{0}, {}}}};
  SiteControls controls(info, graph);
  std::vector<DoorState> doors(1);
  std::vector<LiftState> lifts(1);
  Observation observation;
  observation.doors = doors;
  observation.lifts = lifts;
  lifts[0].session = RobotId(0);
  std::vector<SeenRobot> others;
  // Whether it has the lift at that time, and what it tells the lift.
  const auto await = [&](double time, bool is_blocked) {
    doors[0].blocked = is_blocked;
    observation.time = time;
    Command command;
    controls.Begin(observation, command);
    const bool has_it = controls.AwaitLift(1, others);
    EXPECT_EQ(command.orders.size(), 1u);
    EXPECT_EQ(!command.orders.empty() && std::get<LiftOrder>(command.orders[0]).ends, !has_it);
    return has_it;
  };
  EXPECT_TRUE(await(0.0, true));
  EXPECT_TRUE(await(4.9, true));
  EXPECT_TRUE(await(5.0, false));
  EXPECT_TRUE(await(5.1, true)) << "its time begins anew";
  EXPECT_FALSE(await(10.2, true));
  EXPECT_TRUE(await(10.3, false));
  lifts[0].floor = 1;
  EXPECT_TRUE(await(11.0, true));
  EXPECT_TRUE(await(20.0, true)) << "the lift is not there";
  others = {Seen(1, 9.0, 0.0, false)};
  EXPECT_TRUE(await(21.0, false)) << "another robot waits outside, too";
  others = {Seen(1, 11.2, 0.0, false)};
  EXPECT_FALSE(await(22.0, false)) << "it is left to the robot in the cabin";
}

TEST(SiteControls, CloseADoorThatIsNotOnTheWayAnyMore) {
  LaneGraph graph = Square();
  graph.lanes[0].doors = {{0, 5.0}};
  RobotInfo info;
  info.id = RobotId(0);
  info.doors = {{"door", {5.0, 0.0}, 0.0, {}}};
  SiteControls controls(info, graph);
  const std::vector<DoorState> doors(1);
  Observation observation;
  observation.doors = doors;
  const std::vector<Leg> through{{0, 1, 0}};
  const std::vector<Leg> around{{0, 3, 3}};
  const Vec2 before(3.0, 0.0);
  const auto target = [](const Command& command) {
    EXPECT_EQ(command.orders.size(), 1u);
    return command.orders.empty() ? -1.0 : std::get<DoorOrder>(command.orders.front()).opening;
  };
  Command command;
  controls.Begin(observation, command);
  controls.OpenDoor(graph.lanes[0].doors[0]);
  controls.CloseBehind(through, before, 0.3, {});
  EXPECT_EQ(target(command), 1.0);
  for (const bool requests : {false, true}) {
    command = {};
    controls.Begin(observation, command);
    controls.OpenDoor(graph.lanes[0].doors[0]);  // on the way at first
    controls.CloseBehind(through, before, 0.3, {});
    if (!requests) {
      command = {};
      controls.Begin(observation, command);
    }
    SeenRobot other;
    other.position = {5.0, 0.3};
    other.radius = 0.3;
    const std::size_t orders = command.orders.size();
    Command unused = command;
    controls.CloseBehind(around, {4.8, 0.0}, 0.3, {});
    EXPECT_EQ(command.orders.size(), orders) << "while the robot is at the door";
    controls.CloseBehind(around, before, 0.3, {other});
    EXPECT_EQ(command.orders.size(), orders) << "while another robot is";
    controls.CloseBehind(around, before, 0.3, {});
    EXPECT_EQ(target(command), 0.0);
  }
  command = {};
  controls.Begin(observation, command);
  controls.CloseBehind(around, before, 0.3, {});
  EXPECT_TRUE(command.orders.empty()) << "once";
}

TEST(LanesController, NamesFaultsOfItsParametersAndPlaces) {
  const auto message = [](const std::string& parameters) { return MessageOf(CheckController("lanes", parameters)); };
  EXPECT_EQ(message(R"({"places": ["anywhere"], "graph": 1})"), "") << "the lanes are of the world";
  EXPECT_EQ(message(R"({"graph": 0.5})"), "lanes: found the number 0.5 as 'graph', expected a whole number");
  EXPECT_EQ(message(R"({"places": [1]})"), "lanes: found the number 1 as 'places[0]', expected a text");

  WorldDescription world;
  world.models.emplace_back();
  world.robots.push_back(MakeRobot("lanes", "{}"));
  world.robots[0].root = ModelId(0);
  const auto in_world = [&](const std::string& parameters) {
    world.robots[0].controller.parameters = parameters;
    return MessageOf(CheckControllerNeeds(world, std::array{RobotId(0)}));
  };
  EXPECT_EQ(in_world("{}"), "robot 'r0': lanes: the world has no lanes, expected a building or a layout with some");
  world.lane_graphs = {Square()};
  world.lane_graphs[0].number = 2;
  world.lane_graphs[0].vertices[1].name = "here";
  world.lane_graphs[0].vertices[2].name = "there";
  EXPECT_EQ(in_world(R"({"places": ["there"]})"), "");
  EXPECT_EQ(in_world(R"({"places": ["hre"]})"),
            "robot 'r0': lanes: the lanes have no place 'hre', expected one of: here, there; did you mean 'here'?");
  EXPECT_EQ(in_world(R"({"graph": 1})"), "robot 'r0': lanes: found no lanes of graph 1, expected one of: 2");
  const Result<std::unique_ptr<Controller>> controller = CreateFor(MakeRobot("lanes", "{}"));
  EXPECT_THAT(MessageOf(controller.ok() ? Status() : controller.error()), HasSubstr("the world has no lanes"));
}

}  // namespace
}  // namespace troupe
