#include "common/signals/traffic_totals.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/signals/state_tables.h"
#include "tests/support/small_world.h"

namespace troupe {
namespace {

// Two robots on two lanes, ticks of 0.1 s.
class TrafficTotalsTest : public testing::Test {
 protected:
  TrafficTotalsTest() {
    for (const char* const name : {"a", "b"}) world_.AddRobot(name, {});
    LaneGraph graph;
    for (const double x : {0.0, 4.0, 8.0}) graph.vertices.push_back({.position = {x, 0.0}});
    graph.lanes = {{.start = 0, .end = 1}, {.start = 1, .end = 2}};
    world_.world().lane_graphs = {graph};
    state_ = PlacedState(world_.world());
    state_.traffic_robots = {{.robot = RobotId(0), .goal = 2}, {.robot = RobotId(1), .goal = 0}};
  }

  void Add(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      totals_.Add(world_.world(), state_);
      ++state_.tick;
    }
  }

  SmallWorld world_;
  WorldState state_;
  TrafficTotals totals_;
};

TEST_F(TrafficTotalsTest, AddUpArrivalsAndTheShareOfMotion) {
  Add();
  state_.robots[0].twist.vx = 0.5;
  Add(30);
  state_.traffic_robots[0].arrivals = 1;
  state_.traffic_robots[0].has_arrived = true;
  Add(10);
  const TrafficTotal total = totals_.total();
  EXPECT_EQ(total.robots, 2u);
  EXPECT_EQ(total.arrivals, 1u);
  EXPECT_DOUBLE_EQ(total.seconds, 4.0);
  EXPECT_DOUBLE_EQ(total.arrivals_per_hour, 900.0);
  EXPECT_DOUBLE_EQ(total.utilisation, 30.0 / 80.0);
  state_.traffic_robots[0].arrivals = 0;  // it has been an obstacle for a while
  Add();
  state_.traffic_robots[0].arrivals = 1;
  Add();
  EXPECT_EQ(totals_.total().arrivals, 2u);
  Add();
  state_.tick = 3;  // a rewind
  Add();
  EXPECT_EQ(totals_.total().seconds, 0.0);
  EXPECT_EQ(totals_.total().arrivals, 0u);
}

TEST_F(TrafficTotalsTest, CountWaitsAtLanesFromTheMostOn) {
  Add();
  state_.waits = {{RobotId(0), 1, std::nullopt, 0}};
  Add(5);
  state_.waits = {{RobotId(0), 6, std::nullopt, 1}, {RobotId(1), 6, std::nullopt, 1}};
  Add(10);
  const std::vector<PlaceWaits> places = totals_.FindWaits(world_.world(), 5);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0].place, "0: vertex 1 - vertex 2");
  EXPECT_DOUBLE_EQ(places[0].seconds, 2.0);
  EXPECT_DOUBLE_EQ(places[0].longest, 0.9);
  EXPECT_EQ(places[0].waits, 2u);
  EXPECT_DOUBLE_EQ(places[1].seconds, 0.5);
  EXPECT_EQ(places[1].waits, 1u);
  EXPECT_EQ(totals_.FindWaits(world_.world(), 1).size(), 1u);
  EXPECT_DOUBLE_EQ(totals_.total().waiting, 25.0 / 30.0);
}

TEST_F(TrafficTotalsTest, SignalsNameWhatARobotWaitsFor) {
  state_.tick = 20;
  state_.waits = {{RobotId(0), 5, world_.world().robots[1].root, 0}, {RobotId(1), 10, std::nullopt, 1}};
  state_.lane_closures = {{1, 30, 25}};
  const Things things(world_.world());
  const SignalView view{things, world_.world(), state_};
  const auto signal = [&](const char* table, const char* name) { return StateTables()[KindOf(table)].Find(name); };
  EXPECT_EQ(signal("robots", "blocked_by")->text(view, 0), "b");
  EXPECT_EQ(signal("robots", "blocked_by")->text(view, 1), "0: vertex 1 - vertex 2") << "a closed lane";
  EXPECT_DOUBLE_EQ(signal("robots", "wait_time")->number(view, 0), 1.5);
  EXPECT_EQ(signal("lanes", "waiting_robots")->number(view, 1), 1.0);
  EXPECT_DOUBLE_EQ(signal("lanes", "longest_wait")->number(view, 0), 1.5);
  state_.tick = 30;  // it is open again
  EXPECT_EQ(signal("robots", "blocked_by")->text(view, 1), "");
  state_.waits.clear();
  EXPECT_EQ(signal("robots", "wait_time")->number(view, 0), 0.0);
  EXPECT_EQ(signal("robots", "blocked_by")->text(view, 0), "");
}

}  // namespace
}  // namespace troupe
