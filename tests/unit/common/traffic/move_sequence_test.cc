#include "common/traffic/move_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/common/traffic/traffic_world.h"

namespace troupe {
namespace {

using testing::ElementsAre;

// Moves that are possible one after another, of robots that go anywhere.
std::vector<RowMove> RandomMoves(Formation formation, const TrafficGraph& graph, Draws& draws, std::size_t tries) {
  for (std::size_t i = 0; i < tries; ++i) {
    const auto row = static_cast<std::uint32_t>(draws.Below(formation.places().size()));
    const auto exits = graph.exits(formation.place(row));
    if (exits.empty()) continue;
    const TrafficExit& exit = exits[draws.Below(exits.size())];
    if (formation.CanMove(row, exit.lane, exit.to)) formation.Move(row, exit.lane, exit.to);
  }
  return formation.moves();
}

std::vector<std::uint32_t> RandomPlaces(const TrafficGraph& graph, Draws& draws, std::size_t count) {
  std::vector<std::uint32_t> places;
  while (places.size() < count) {
    const auto vertex = static_cast<std::uint32_t>(draws.Below(graph.vertices()));
    const auto near = graph.VerticesNearVertex(vertex);
    const auto is_near = [&](std::uint32_t other) { return std::binary_search(near.begin(), near.end(), other); };
    if (std::none_of(places.begin(), places.end(), is_near)) places.push_back(vertex);
  }
  return places;
}

// Labels may differ, but nothing else.
void ExpectEqual(const TrafficGraph& graph, const MoveSequence& one, const MoveSequence& other) {
  const std::vector<RowMove> moves = one.moves();
  const std::vector<RowMove> other_moves = other.moves();
  ASSERT_EQ(moves.size(), other_moves.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    EXPECT_EQ(moves[i].row, other_moves[i].row);
    EXPECT_EQ(moves[i].lane, other_moves[i].lane);
    EXPECT_EQ(moves[i].to, other_moves[i].to);
  }
  for (std::uint32_t vertex = 0; vertex < graph.vertices(); ++vertex) {
    EXPECT_EQ(one.IsFreeAtEnd(vertex), other.IsFreeAtEnd(vertex));
    EXPECT_EQ(one.LastFinishNear(vertex), other.LastFinishNear(vertex));
    for (const TrafficExit& exit : graph.exits(vertex)) {
      // All moves near a lane, one after another.
      MoveSequence::Position here = 0;
      MoveSequence::Position there = 0;
      while (here != MoveSequence::kEnd) {
        here = one.NextNear(exit.lane, here);
        there = other.NextNear(exit.lane, there);
        ASSERT_EQ(here == MoveSequence::kEnd, there == MoveSequence::kEnd);
        const MoveSequence::Times times = one.TimesNear(exit.lane, here);
        const MoveSequence::Times other_times = other.TimesNear(exit.lane, there);
        EXPECT_EQ(times.latest_finish, other_times.latest_finish);
        EXPECT_EQ(times.earliest_start, other_times.earliest_start);
        if (here != MoveSequence::kEnd) ++here, ++there;
      }
      std::vector<MoveSequence::Range> free;
      std::vector<MoveSequence::Range> other_free;
      one.FindFree(exit.lane, exit.to, {0, MoveSequence::kEnd}, free);
      other.FindFree(exit.lane, exit.to, {0, MoveSequence::kEnd}, other_free);
      EXPECT_EQ(free.size(), other_free.size());
    }
  }
}

TEST(MoveSequenceTest, AChangedSequenceIsAsOneThatIsMadeAnew) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Draws draws(seed);
    const TrafficGraph graph = GraphOf({RandomGrid(draws, 6, 5, 0.3)});
    const std::vector<std::uint32_t> places = RandomPlaces(graph, draws, 8);
    std::vector<RowMove> moves = RandomMoves(Formation(graph, places), graph, draws, 120);
    MoveSequence sequence(graph, places, {}, moves);
    for (std::size_t i = 0; i < 10; ++i) {
      const auto row = static_cast<std::uint32_t>(draws.Below(places.size()));
      const std::vector<MoveSequence::Step> steps = sequence.TakeOut(row);
      const std::vector<RowMove> others = sequence.moves();
      EXPECT_EQ(others.size() + steps.size(), moves.size());
      sequence.PutBack(row, steps);
      ExpectEqual(graph, sequence, MoveSequence(graph, places, {}, moves));
      // Without its moves, the robot stays where it is: only the times of the others count here.
      sequence.TakeOut(row);
      sequence.PutBack(row, {});
      ExpectEqual(graph, sequence, MoveSequence(graph, places, {}, others));
      moves = others;
      if (moves.empty()) break;
    }
  }
}

TEST(MoveSequenceTest, TimesFollowTheGrantedMovesAndTheOrder) {
  const TrafficGraph graph = GraphOf({Chain(5, 3.0)});
  // One robot drives to 1 by a granted move, and on to 2 and 3; another one follows from 0.
  const std::vector<std::uint32_t> places = {1, 0};
  const std::vector<RowMove> granted = {{0, 0, 0, 1}};
  const std::vector<RowMove> moves = {{0, 1, 1, 2}, {0, 2, 2, 3}, {1, 0, 0, 1}};
  MoveSequence sequence(graph, places, granted, moves);
  EXPECT_EQ(sequence.ready(0), 3.0);
  EXPECT_EQ(sequence.ready(1), 0.0);
  EXPECT_EQ(sequence.busy(1), 3.0) << "near the granted move";
  EXPECT_EQ(sequence.busy(2), 0.0);
  EXPECT_EQ(sequence.LastFinishNear(3), 9.0);
  EXPECT_EQ(sequence.LastFinishNear(1), 9.0) << "behind the first move, which ends where its lane does";
  EXPECT_THAT(sequence.TakeOut(0), testing::SizeIs(2));
  EXPECT_EQ(sequence.LastFinishNear(1), 6.0);
}

TEST(MoveSequenceTest, AnyNumberOfMovesFindsAPlaceBetweenTwo) {
  LaneDraft draft;
  constexpr std::uint32_t kRobots = 80;
  for (std::uint32_t i = 0; i < kRobots; ++i) {
    const std::uint32_t start = draft.Add(10.0 * i, 0.0);
    draft.Join(start, draft.Add(10.0 * i, 5.0));
  }
  const TrafficGraph graph = GraphOf({draft.graph});
  std::vector<std::uint32_t> places;
  for (std::uint32_t i = 0; i < kRobots; ++i) places.push_back(2 * i);
  const std::vector<RowMove> moves = {{0, 0, 0, 1}, {1, 1, 2, 3}};
  MoveSequence sequence(graph, places, {}, moves);
  for (std::uint32_t row = 2; row < kRobots; ++row) {
    const MoveSequence::Position first = sequence.RestAt(1, 0).end;  // the label of the first move
    sequence.TakeOut(row);
    const std::vector<MoveSequence::Step> steps = {{first + 1, row, 2 * row + 1}};
    sequence.PutBack(row, steps);
  }
  std::vector<std::uint32_t> order;
  for (const RowMove& move : sequence.moves()) order.push_back(move.row);
  std::vector<std::uint32_t> expected = {0};
  for (std::uint32_t row = kRobots - 1; row >= 2; --row) expected.push_back(row);
  expected.push_back(1);
  EXPECT_EQ(order, expected);
  ExpectEqual(graph, sequence, MoveSequence(graph, places, {}, sequence.moves()));
}

}  // namespace
}  // namespace troupe
