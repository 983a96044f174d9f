#include "common/traffic/priority_moves.h"

#include <gmock/gmock.h>

#include "common/traffic/traffic_routes.h"
#include "tests/unit/common/traffic/traffic_world.h"

namespace troupe {
namespace {

// Robots at their places on a graph, the first one with the first rank; goals of none are at a vertex beyond all.
class Board {
 public:
  static constexpr std::uint32_t kNone = Formation::kNone;

  Board(const LaneGraph& lanes, std::vector<std::uint32_t> places, const std::vector<std::uint32_t>& goals)
      : routes_(std::make_shared<const TrafficGraph>(GraphOf({lanes}))),
        closed(routes_.graph().lanes(), false),
        formation(routes_.graph(), std::move(places)),
        goals_(goals) {
    routes_.Begin(closed);
    for (std::size_t row = 0; row < goals.size(); ++row) {
      robots.push_back({.seconds_to_goal = goals[row] == kNone ? nullptr : &routes_.To(goals[row]), .rank = row});
    }
  }

  bool Advance(std::uint32_t row, std::size_t most = 1) {
    PriorityMoves moves(routes_.graph(), closed, formation, robots);
    return moves.Advance(row, goals_[row], most);
  }

 private:
  TrafficRoutes routes_;

 public:
  std::vector<bool> closed;
  Formation formation;
  std::vector<PriorityMoves::Robot> robots;

 private:
  std::vector<std::uint32_t> goals_;
};

TEST(PriorityMovesTest, ARobotComesNearerToItsGoal) {
  Board board(Chain(4, 2.0), {0}, {3});
  EXPECT_TRUE(board.Advance(0));
  EXPECT_EQ(board.formation.place(0), 1u);
  EXPECT_TRUE(board.Advance(0, 5));
  EXPECT_EQ(board.formation.place(0), 3u);
  EXPECT_FALSE(board.Advance(0)) << "it is there";
}

TEST(PriorityMovesTest, OthersMakeRoomInARow) {
  Board board(Chain(5, 2.0), {0, 1, 2}, {4, Board::kNone, 0});
  EXPECT_TRUE(board.Advance(0));
  EXPECT_THAT(board.formation.places(), testing::ElementsAre(1, 2, 3));
  EXPECT_EQ(board.formation.moves().front().row, 2u) << "the one with room moves first";
}

TEST(PriorityMovesTest, RobotsOfEarlierRanksAndThoseThatStayMakeNoRoom) {
  Board earlier(Chain(3, 2.0), {1, 0}, {0, 2});
  EXPECT_FALSE(earlier.Advance(1));
  Board staying(Chain(3, 2.0), {0, 1}, {2, Board::kNone});
  staying.robots[1].can_move = false;
  EXPECT_FALSE(staying.Advance(0));
  EXPECT_TRUE(staying.formation.moves().empty());
}

TEST(PriorityMovesTest, AChoiceThatLeadsNowhereIsTakenBack) {
  // The robot in the way has a dead end on one side, with another robot in it, and a free vertex on the other.
  LaneDraft draft;
  for (const Vec2& place : {Vec2(0, 0), Vec2(2, 0), Vec2(2, 2), Vec2(2, -2), Vec2(4, 0)})
    draft.Add(place.x(), place.y());
  for (std::uint32_t end : {0u, 2u, 3u, 4u}) draft.Join(1, end);
  Board board(draft.graph, {0, 1, 2}, {4, 2, Board::kNone});
  EXPECT_TRUE(board.Advance(0));
  EXPECT_EQ(board.formation.place(0), 1u);
  EXPECT_NE(board.formation.place(1), 2u) << "its goal is taken by a robot that has no other place";
  EXPECT_EQ(board.formation.place(2), 2u);
}

TEST(PriorityMovesTest, NoRobotStopsInAGroupThatOthersNeed) {
  LaneDraft draft;
  draft.Add(0, 0);
  draft.Add(2, 0, "cabin");
  draft.Add(4, 0);
  draft.Add(6, 0);
  for (std::uint32_t i = 0; i < 3; ++i) draft.Join(i, i + 1);
  Board free(draft.graph, {0}, {3});
  EXPECT_TRUE(free.Advance(0));
  EXPECT_EQ(free.formation.place(0), 2u) << "through the group in one";
  Board taken(draft.graph, {0, 2}, {3, Board::kNone});
  taken.robots[1].can_move = false;
  EXPECT_FALSE(taken.Advance(0));
  EXPECT_EQ(taken.formation.place(0), 0u);
}

TEST(PriorityMovesTest, ClosedLanesAreLeftOut) {
  Board board(Chain(3, 2.0), {0}, {2});
  board.closed[0] = true;
  EXPECT_FALSE(board.Advance(0));
}

}  // namespace
}  // namespace troupe
