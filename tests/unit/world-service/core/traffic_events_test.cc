// The events of robots on their ways, from two states alone.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/model/states.h"
#include "tests/support/small_world.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// Three robots, a wall, and a lane from "dock" to "bay".
class TrafficEventsTest : public testing::Test {
 protected:
  TrafficEventsTest() {
    for (const char* const name : {"r0", "r1", "r2"}) world_.AddRobot(name, {});
    world_.AddBox("wall", 5.0, 0.0, 1.0, 1.0, {0.0, 1.0});
    LaneGraph graph;
    graph.vertices = {{.name = "dock"}, {.name = "bay", .position = {4.0, 0.0}}};
    graph.lanes = {{.start = 0, .end = 1}};
    world_.world().lane_graphs = {graph};
    before_ = PlacedState(world_.world());
    before_.tick = 499;
    now_ = before_;
    now_.tick = 500;
  }

  ModelId RootOf(std::size_t robot) const { return world_.world().robots[robot].root; }
  // `seconds`: the duration of the wait at the state before.
  static RobotWait WaitOf(std::size_t robot, double seconds, std::optional<ModelId> thing,
                          std::optional<std::uint32_t> lane = {}) {
    return {RobotId(robot), 499 - static_cast<Tick>(10.0 * seconds), thing, lane};
  }
  std::vector<Event> Events() const {
    std::vector<Event> events;
    AddTrafficEvents(world_.world(), before_, now_, events);
    return events;
  }

  mutable SmallWorld world_;
  WorldState before_;
  WorldState now_;
};

TEST_F(TrafficEventsTest, AWaitOfTenSecondsIsToldOnceAndItsEnd) {
  const ModelId wall(3);
  before_.waits = now_.waits = {WaitOf(0, 9.9, wall, 0)};
  std::vector<Event> events = Events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0], (Event{.tick = 500,
                              .type = EventType::kWaitBegan,
                              .robot = RobotId(0),
                              .other = wall,
                              .detail = "lane 0: dock - bay"}));
  before_.waits = now_.waits = {WaitOf(0, 10.0, wall, 0)};
  EXPECT_TRUE(Events().empty());
  now_.waits.clear();
  events = Events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].type, EventType::kWaitEnded);
  EXPECT_EQ(events[0].detail, "after 10.1 s");
  before_.waits = {WaitOf(0, 9.0, wall, 0)};
  EXPECT_TRUE(Events().empty()) << "a short wait";
}

TEST_F(TrafficEventsTest, ARingOfRobotsIsADeadlockThatIsBrokenWhenOneGoesOn) {
  before_.waits = now_.waits = {WaitOf(0, 5.0, RootOf(1)), WaitOf(1, 4.0, RootOf(2)), WaitOf(2, 3.0, RootOf(0))};
  EXPECT_TRUE(Events().empty());
  now_.waits.erase(now_.waits.begin() + 1);
  const std::vector<Event> events = Events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].type, EventType::kDeadlockBroken);
  EXPECT_EQ(events[0].robot, RobotId(1));
  EXPECT_EQ(events[0].detail, "r0, r1, r2");
  before_.waits[1].since = 490;
  EXPECT_TRUE(Events().empty()) << "it has hardly begun";
}

TEST_F(TrafficEventsTest, AChainAndAnotherBlockerAreNoBrokenDeadlock) {
  before_.waits = {WaitOf(0, 5.0, RootOf(1)), WaitOf(1, 5.0, RootOf(2))};
  EXPECT_TRUE(Events().empty()) << "r2 does not wait";
  before_.waits = now_.waits = {WaitOf(0, 5.0, RootOf(1)), WaitOf(1, 5.0, RootOf(0))};
  now_.waits[0].thing = RootOf(2);
  EXPECT_TRUE(Events().empty()) << "none goes on";
}

TEST_F(TrafficEventsTest, AClosedLaneHasTheRobotThatMetTheObstacle) {
  before_.waits = now_.waits = {WaitOf(2, 8.0, ModelId(3), 0)};
  now_.lane_closures = {{0, 1100, 600}};
  std::vector<Event> events = Events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0], (Event{.tick = 500,
                              .type = EventType::kReplanned,
                              .robot = RobotId(2),
                              .other = ModelId(3),
                              .detail = "lane 0: dock - bay is closed for 60.0 s"}));
  before_.lane_closures = now_.lane_closures;
  EXPECT_TRUE(Events().empty());
  now_.lane_closures = {{0, 1700, 1200}};  // closed again, for longer
  EXPECT_EQ(Events().size(), 1u);
}

TEST_F(TrafficEventsTest, ARobotWithoutAWayHasItsGoal) {
  before_.waits = now_.waits = {WaitOf(0, 9.9, std::nullopt)};
  now_.traffic_robots = {{.robot = RobotId(0), .at = 0, .goal = 1, .waiting = 100}};
  const std::vector<Event> events = Events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].type, EventType::kNoWay);
  EXPECT_EQ(events[0].detail, "bay");
}

}  // namespace
}  // namespace troupe
