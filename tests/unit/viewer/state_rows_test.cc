#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "tests/unit/viewer/byte_reader.h"
#include "viewer/gateway/page_messages.h"

namespace troupe {
namespace {

// A viewer's copy of the rows, as the page keeps it.
struct Copy {
  WorldState state;

  // Returns the number of rows in the message.
  std::size_t Apply(const std::string& bytes) {
    test::ByteReader reader(bytes);
    std::size_t count = 0;
    ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
      if constexpr (!std::is_same_v<Row, ImuState> && !std::is_same_v<Row, RadioTransmission>) {
        count += reader.ReadRows(table.Of(state)).size();
      }
    });
    EXPECT_TRUE(reader.at_end());
    return count;
  }
};

WorldState SomeState() {
  WorldState state;
  state.robots.resize(20);
  state.joints.resize(10);
  state.grippers.resize(4);
  state.objects.resize(8);
  state.stores.resize(6);
  state.lights.resize(5);
  state.cameras.resize(2);
  return state;
}

std::string Difference(const StateRows& rows, std::uint64_t since) {
  ByteWriter writer;
  rows.Write(writer, since);
  return writer.TakeBytes();
}

TEST(StateRowsTest, AViewerThatSkipsAnyUpdatesHasTheWholeState) {
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  WorldState state = SomeState();
  StateRows rows;
  Copy quick;
  Copy slow;
  std::uint64_t slow_has = 0;
  for (std::uint64_t update = 1; update <= 300; ++update) {
    // Floats, as twists are sent.
    for (int i = 0; i < 3; ++i) {
      RobotState& robot = state.robots[below(state.robots.size())];
      robot.X_WR.x += 0.1;
      robot.X_WR.heading = 1.0 / static_cast<double>(update);
      robot.twist.vx = 0.5;
      robot.stalled = below(2) == 0;
    }
    state.joints[below(state.joints.size())].position += 1e-9;
    state.grippers[below(state.grippers.size())].clamped = ObjectId(below(8));
    state.objects[0].support = ModelId(update);
    ObjectState& object = state.objects[below(state.objects.size())];
    object.mode = ObjectMode::kHeld;
    object.holder = GripperId(below(4));
    state.stores[below(state.stores.size())].joules -= 0.5;
    state.lights[below(state.lights.size())].is_switched_on = below(2) == 0;
    rows.Assign(std::make_shared<const WorldState>(state), update, update == 1);
    EXPECT_LE(quick.Apply(Difference(rows, update - 1)), update == 1 ? 55u : 9u);
    EXPECT_EQ(quick.state, state);
    if (below(10) == 0) {
      slow.Apply(Difference(rows, slow_has));
      slow_has = update;
      EXPECT_EQ(slow.state, state);
    }
  }
}

TEST(StateRowsTest, NothingIsSentOfAStateThatDoesNotChange) {
  StateRows rows;
  rows.Assign(std::make_shared<const WorldState>(SomeState()), 1, true);
  rows.Assign(std::make_shared<const WorldState>(SomeState()), 2, false);
  EXPECT_EQ(Copy().Apply(Difference(rows, 1)), 0u);
  EXPECT_EQ(Copy().Apply(Difference(rows, 0)), 55u);
}

TEST(StateRowsTest, AnotherWorldIsSentWhole) {
  StateRows rows;
  rows.Assign(std::make_shared<const WorldState>(SomeState()), 1, true);
  WorldState smaller;
  smaller.robots.resize(3);
  rows.Assign(std::make_shared<const WorldState>(smaller), 2, true);
  Copy copy;
  EXPECT_EQ(copy.Apply(Difference(rows, 1)), 3u);
  EXPECT_EQ(copy.state, smaller);
}

}  // namespace
}  // namespace troupe
