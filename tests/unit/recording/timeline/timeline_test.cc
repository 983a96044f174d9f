#include "recording/timeline/timeline.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

namespace troupe {
namespace {

SharedState StateAt(std::uint64_t position) {
  TimelineState past{.position = position};
  WorldState state;
  state.robots.resize(100);
  past.state = std::make_shared<const WorldState>(std::move(state));
  past.state_hash = 1000 + position;
  return std::make_shared<const TimelineState>(std::move(past));
}

TEST(KeptStatesTest, DropsTheStatesFarthestFromTheNewestOne) {
  KeptStates kept(3 * SizeOf(*StateAt(0)));
  EXPECT_TRUE(kept.empty());
  for (const std::uint64_t position : {10u, 11u, 12u}) kept.Add(StateAt(position));
  EXPECT_EQ(kept.Nearest(77)->position, 12u);
  EXPECT_EQ(kept.Nearest(2)->position, 10u);
  kept.Add(StateAt(13));
  EXPECT_EQ(kept.Find(10), nullptr);
  kept.Add(StateAt(9));
  EXPECT_EQ(kept.Find(13), nullptr);
  EXPECT_EQ(kept.Find(12)->state_hash, 1012u);
  EXPECT_EQ(kept.first(), 9u);
  kept.Clear();
  EXPECT_TRUE(kept.empty());
}

TEST(TimeSpansTest, FindTheStatesOfTicksAndEditions) {
  const TimeSpans spans({{0, 4, 0, 0}, {5, 9, 2, 1}, {12, 13, 9, 1}});
  EXPECT_EQ(spans.First(3), 3u);
  EXPECT_EQ(spans.Last(3), 6u);
  EXPECT_EQ(spans.Last(7), std::nullopt) << "in the gap";
  EXPECT_EQ(spans.greatest(), 10u);
  EXPECT_EQ(spans.TickAt(13), 10u);
  EXPECT_EQ(spans.PositionOf({1, 8}), 11u) << "in the gap";
  EXPECT_EQ(spans.PositionOf({1, 12}), 15u) << "behind the last";
  EXPECT_EQ(spans.PositionOf({2, 0}), 14u) << "an edit makes one state";
  EXPECT_EQ(spans.BeginOf(1), 5u);
  EXPECT_EQ(spans.BeginOf(2), 14u);
}

}  // namespace
}  // namespace troupe
