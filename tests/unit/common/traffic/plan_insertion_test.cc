#include "common/traffic/plan_insertion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "common/traffic/traffic_routes.h"
#include "tests/unit/common/traffic/traffic_world.h"

namespace troupe {
namespace {

using testing::ElementsAre;

// 0 to 4 in a row, 3 m apart, and 5 beside 2.
LaneGraph Siding() {
  LaneDraft draft;
  for (int i = 0; i < 5; ++i) draft.Add(3.0 * i, 0.0);
  const std::uint32_t beside = draft.Add(6.0, 3.0);
  for (std::uint32_t i = 0; i < 4; ++i) draft.Join(i, i + 1);
  draft.Join(2, beside);
  return draft.graph;
}

class PlanInsertionTest : public testing::Test {
 protected:
  explicit PlanInsertionTest(const LaneGraph& lanes = Siding())
      : routes_(std::make_shared<const TrafficGraph>(GraphOf({lanes}))),
        closed_(routes_.graph().lanes(), false),
        busy_(routes_.graph().lanes(), 0.0) {
    routes_.Begin(closed_);
  }

  // The other robot drives along vertices, and starts at the first of them; 3 s for each lane.
  std::vector<TimedMove> Drive(const std::vector<std::uint32_t>& vertices) const {
    std::vector<TimedMove> moves;
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
      for (const TrafficExit& exit : routes_.graph().exits(vertices[i])) {
        if (exit.to != vertices[i + 1]) continue;
        const auto start = 3.0 * static_cast<double>(i);
        moves.push_back({{1, exit.lane, vertices[i], exit.to}, start, start + 3.0});
      }
    }
    return moves;
  }

  // "position>vertex" of each step; nothing without a way.
  std::vector<std::string> Find(std::uint32_t from, std::uint32_t goal, const std::vector<std::uint32_t>& other) {
    const std::vector<std::uint32_t> places = {from, other.front()};
    const std::vector<TimedMove> moves = Drive(other);
    PlanInsertion insertion(routes_.graph(), closed_, places, moves, 0, 0.0, busy_);
    const auto steps = insertion.Find(goal, routes_.To(goal), 1.0);
    std::vector<std::string> texts;
    if (!steps) return texts;
    for (const PlanInsertion::Step& step : *steps) {
      texts.push_back(std::to_string(step.position) + ">" + std::to_string(step.exit.to));
    }
    return texts;
  }

  TrafficRoutes routes_;
  std::vector<bool> closed_;
  std::vector<double> busy_;
};

TEST_F(PlanInsertionTest, ALoneRobotDrivesAtOnce) {
  EXPECT_THAT(Find(0, 2, {4}), ElementsAre("0>1", "0>2"));
}

TEST_F(PlanInsertionTest, ARobotWaitsAtASidingUntilTheOtherHasPassed) {
  // The other one comes from 4 to 0, and has passed after its third move, to 1.
  EXPECT_THAT(Find(1, 4, {4, 3, 2, 1, 0}), ElementsAre("0>2", "0>5", "3>2", "3>3", "3>4"));
}

TEST_F(PlanInsertionTest, ThereIsNoWayToWhereAnotherStays) {
  EXPECT_THAT(Find(0, 4, {4}), testing::IsEmpty());
  EXPECT_THAT(Find(0, 4, {3}), testing::IsEmpty()) << "past it";
  EXPECT_THAT(Find(0, 5, {3, 2, 5}), testing::IsEmpty());
}

TEST_F(PlanInsertionTest, ARobotLeavesThePlaceThatTheOtherNeeds) {
  // From 2 to 4 ahead of the other one, which comes from 0 to 2.
  EXPECT_THAT(Find(2, 4, {0, 1, 2}), ElementsAre("0>3", "0>4"));
}

TEST_F(PlanInsertionTest, ClosedLanesAreLeftOut) {
  closed_[0] = true;
  routes_.Begin(closed_);
  EXPECT_THAT(Find(0, 2, {4}), testing::IsEmpty());
}

TEST_F(PlanInsertionTest, LanesThatGrantedMovesNeedAreTakenLater) {
  // A ring: the short way is busy for long.
  LaneDraft draft;
  draft.Add(0.0, 0.0);
  draft.Add(3.0, 0.0);
  draft.Add(3.0, 3.0);
  draft.Add(0.0, 3.0);
  for (std::uint32_t i = 0; i < 4; ++i) draft.Join(i, (i + 1) % 4);
  TrafficRoutes routes(std::make_shared<const TrafficGraph>(GraphOf({draft.graph})));
  const std::vector<bool> closed(4, false);
  routes.Begin(closed);
  const std::vector<std::uint32_t> places = {0};
  const auto lanes_to_1 = [&](double busy_seconds) {
    const std::vector<double> busy = {busy_seconds, 0.0, 0.0, 0.0};
    PlanInsertion insertion(routes.graph(), closed, places, {}, 0, 0.0, busy);
    return insertion.Find(1, routes.To(1), 1.0).value().size();
  };
  EXPECT_EQ(lanes_to_1(2.0), 1u);
  EXPECT_EQ(lanes_to_1(20.0), 3u);
}

}  // namespace
}  // namespace troupe
