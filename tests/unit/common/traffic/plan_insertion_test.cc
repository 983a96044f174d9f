#include "common/traffic/plan_insertion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <string>
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
      : routes_(std::make_shared<const TrafficGraph>(GraphOf({lanes}))), closed_(routes_.graph().lanes(), false) {
    routes_.Begin(closed_);
  }

  // The other robot drives along vertices, and starts at the first of them; 3 s for each lane.
  std::vector<RowMove> Drive(const std::vector<std::uint32_t>& vertices) const {
    std::vector<RowMove> moves;
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
      for (const TrafficExit& exit : routes_.graph().exits(vertices[i])) {
        if (exit.to == vertices[i + 1]) moves.push_back({1, exit.lane, vertices[i], exit.to});
      }
    }
    return moves;
  }

  // "position>vertex" of each step, with the number of moves of the other one before it; nothing without a way.
  std::vector<std::string> Find(std::uint32_t from, std::uint32_t goal, const std::vector<std::uint32_t>& other) {
    const std::vector<std::uint32_t> places = {from, other.front()};
    const std::vector<RowMove> moves = Drive(other);
    MoveSequence sequence(routes_.graph(), places, {}, moves);
    sequence.TakeOut(0);
    PlanInsertion insertion(routes_.graph(), closed_);
    const auto steps = insertion.Find(sequence, 0, goal, routes_.To(goal), 1.0);
    std::vector<std::string> texts;
    if (!steps) return texts;
    sequence.PutBack(0, *steps);
    std::size_t position = 0;
    for (const RowMove& move : sequence.moves()) {
      if (move.row == 1) {
        ++position;
      } else {
        texts.push_back(std::to_string(position) + ">" + std::to_string(move.to));
      }
    }
    return texts;
  }

  TrafficRoutes routes_;
  std::vector<bool> closed_;
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
  // Two rows of vertices, joined at their ends, and one apart.
  LaneDraft draft;
  for (int i = 0; i < 4; ++i) draft.Add(3.0 * i, 0.0);
  for (int i = 0; i < 4; ++i) draft.Add(3.0 * i, 3.0);
  for (const std::uint32_t i : {0U, 1U, 2U, 4U, 5U, 6U}) draft.Join(i, i + 1);
  for (const std::uint32_t i : {0U, 3U}) draft.Join(i, i + 4);
  const std::uint32_t apart = draft.Add(0.0, 20.0);
  TrafficRoutes routes(std::make_shared<const TrafficGraph>(GraphOf({draft.graph})));
  const std::vector<bool> closed(routes.graph().lanes(), false);
  routes.Begin(closed);
  const std::vector<std::uint32_t> places = {0, apart};
  const auto first_vertex = [&](std::span<const RowMove> granted) {
    MoveSequence sequence(routes.graph(), places, granted, {});
    sequence.TakeOut(0);
    PlanInsertion insertion(routes.graph(), closed);
    return insertion.Find(sequence, 0, 3, routes.To(3), 1.0).value().front().to;
  };
  EXPECT_EQ(first_vertex({}), 1u);
  const std::vector<RowMove> granted(8, {1, 1, 1, 2});  // along lane 1, for long
  EXPECT_EQ(first_vertex(granted), 4u);
}

}  // namespace
}  // namespace troupe
