#include "viewer/gateway/state_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "tests/unit/viewer/byte_reader.h"

namespace troupe {
namespace {

// A viewer's copy of the rows, as the page keeps it.
struct Copy {
  std::vector<RobotState> robots;
  std::vector<JointState> joints;
  std::vector<std::optional<ObjectId>> clamped;
  std::vector<ObjectState> objects;
  std::vector<StoreState> stores;
  std::vector<LightState> lights;

  template <typename Row, typename Read>
  static std::size_t ReadRows(test::ByteReader& reader, std::vector<Row>& rows, Read read) {
    const std::uint32_t count = reader.ReadCount();
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t row = reader.ReadCount();
      if (row >= rows.size()) rows.resize(row + 1);
      read(rows[row]);
    }
    return count;
  }

  // Returns the number of rows in the message.
  std::size_t Apply(const std::string& bytes) {
    test::ByteReader reader(bytes);
    std::size_t count = ReadRows(reader, robots, [&](RobotState& row) {
      row.X_WR = reader.ReadPose();
      row.twist = {reader.ReadFloat(), reader.ReadFloat(), reader.ReadFloat()};
      row.stalled = reader.ReadByte() != 0;
    });
    count += ReadRows(reader, joints, [&](JointState& row) {
      row.position = reader.ReadDouble();
      row.blocked = reader.ReadByte() != 0;
    });
    count += ReadRows(reader, clamped, [&](std::optional<ObjectId>& row) {
      const std::int32_t index = reader.ReadIndex();
      row = index < 0 ? std::nullopt : std::optional(ObjectId(static_cast<std::size_t>(index)));
    });
    count += ReadRows(reader, objects, [&](ObjectState& row) {
      row.X_WO = reader.ReadPose();
      row.mode = static_cast<ObjectMode>(reader.ReadByte());
      const std::int32_t index = reader.ReadIndex();
      row.holder = index < 0 ? std::nullopt : std::optional(GripperId(static_cast<std::size_t>(index)));
    });
    count += ReadRows(reader, stores, [&](StoreState& row) {
      row.joules = reader.ReadDouble();
      row.charge_watts = reader.ReadDouble();
    });
    count += ReadRows(reader, lights, [&](LightState& row) { row.is_switched_on = reader.ReadByte() != 0; });
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
  return state;
}

void ExpectEqual(const Copy& copy, const WorldState& state) {
  EXPECT_EQ(copy.robots, state.robots);
  ASSERT_EQ(copy.joints.size(), state.joints.size());
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    EXPECT_EQ(copy.joints[i].position, state.joints[i].position);
    EXPECT_EQ(copy.joints[i].blocked, state.joints[i].blocked);
  }
  ASSERT_EQ(copy.clamped.size(), state.grippers.size());
  for (std::size_t i = 0; i < state.grippers.size(); ++i) EXPECT_EQ(copy.clamped[i], state.grippers[i].clamped);
  EXPECT_EQ(copy.objects, state.objects);
  EXPECT_EQ(copy.stores, state.stores);
  EXPECT_EQ(copy.lights, state.lights);
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
    ObjectState& object = state.objects[below(state.objects.size())];
    object.mode = ObjectMode::kHeld;
    object.holder = GripperId(below(4));
    state.stores[below(state.stores.size())].joules -= 0.5;
    state.lights[below(state.lights.size())].is_switched_on = below(2) == 0;
    rows.Assign(state, update, update == 1);
    EXPECT_LE(quick.Apply(Difference(rows, update - 1)), update == 1 ? 53u : 8u);
    ExpectEqual(quick, state);
    if (below(10) == 0) {
      slow.Apply(Difference(rows, slow_has));
      slow_has = update;
      ExpectEqual(slow, state);
    }
  }
}

TEST(StateRowsTest, NothingIsSentOfAStateThatDoesNotChange) {
  StateRows rows;
  rows.Assign(SomeState(), 1, true);
  rows.Assign(SomeState(), 2, false);
  EXPECT_EQ(Copy().Apply(Difference(rows, 1)), 0u);
  EXPECT_EQ(Copy().Apply(Difference(rows, 0)), 53u);
}

TEST(StateRowsTest, AnotherWorldIsSentWhole) {
  StateRows rows;
  rows.Assign(SomeState(), 1, true);
  WorldState smaller;
  smaller.robots.resize(3);
  rows.Assign(smaller, 2, true);
  Copy copy;
  EXPECT_EQ(copy.Apply(Difference(rows, 1)), 3u);
  ExpectEqual(copy, smaller);
}

}  // namespace
}  // namespace troupe
