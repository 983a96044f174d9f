#include <gtest/gtest.h>

#include "viewer/gateway/past_states.h"

namespace troupe {
namespace {

ViewedState StateAt(Tick tick) {
  ViewedState past;
  WorldState state;
  state.robots.resize(100);
  state.tick = tick;
  past.state = std::make_shared<const WorldState>(std::move(state));
  past.state_hash = 1000 + tick;
  return past;
}

TEST(KeptStatesTest, HasTheStatesInTheirOrder) {
  KeptStates history(std::size_t{1} << 20);
  EXPECT_FALSE(history.range());
  EXPECT_FALSE(history.At(0).ok());
  for (Tick tick = 5; tick < 10; ++tick) EXPECT_EQ(history.Add(StateAt(tick))->position, tick - 5);
  EXPECT_EQ(history.range(), (PastStates::Range{0, 4}));
  EXPECT_EQ(history.At(2).value()->state_hash, 1007u);
  EXPECT_EQ(history.At(77).value()->position, 4u) << "the nearest one";
  history.Add(StateAt(6));  // after a reset
  EXPECT_EQ(history.PositionOf(6), 5u);
  EXPECT_EQ(history.PositionOf(9), 4u);
  EXPECT_EQ(history.PositionOf(4), std::nullopt);
}

TEST(KeptStatesTest, ItsMemoryIsBounded) {
  const std::size_t bytes = SizeOf(StateAt(0));
  KeptStates history(10 * bytes);
  for (Tick tick = 0; tick < 1000; ++tick) history.Add(StateAt(tick));
  EXPECT_EQ(history.range(), (PastStates::Range{990, 999}));
  EXPECT_EQ(history.At(0).value()->position, 990u);
  EXPECT_EQ(history.PositionOf(989), std::nullopt);
  history.Clear();
  EXPECT_FALSE(history.range());
  EXPECT_EQ(history.Add(StateAt(0))->position, 1000u) << "positions are never used twice";
}

}  // namespace
}  // namespace troupe
