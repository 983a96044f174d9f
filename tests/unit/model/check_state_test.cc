#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/model/states.h"

namespace troupe {
namespace {

// The counts of each kind; CheckState reads nothing else of the description.
WorldDescription SomeWorld() {
  WorldDescription world;
  world.models.resize(4);
  world.robots.resize(1);
  world.robots[0].root = ModelId(0);
  world.joints.resize(2);
  world.grippers.resize(1);
  world.objects.resize(2);
  return world;
}

WorldState SomeState() {
  WorldState state;
  state.robots.resize(1);
  state.joints.resize(2);
  state.grippers.resize(1);
  state.objects.resize(2);
  return state;
}

TEST(CheckStateTest, AStateOfTheWorldPasses) {
  WorldState state = SomeState();
  state.grippers[0] = {ModelId(3), ModelId(3), ObjectId(1)};
  state.objects[1].mode = ObjectMode::kHeld;
  state.objects[1].holder = GripperId(0);
  state.objects[0].support = ModelId(3);
  EXPECT_TRUE(CheckState(SomeWorld(), state).ok());
}

TEST(CheckStateTest, StatesThatDoNotBelongToTheWorldAreRefused) {
  struct Case {
    const char* part;
    std::function<void(WorldState&)> spoil;
  };
  const Case cases[] = {
      {"robots", [](WorldState& s) { s.robots.clear(); }},
      {"joints", [](WorldState& s) { s.joints.pop_back(); }},
      {"grippers", [](WorldState& s) { s.grippers.resize(2); }},
      {"objects", [](WorldState& s) { s.objects.resize(3); }},
      {"pose of a robot", [](WorldState& s) { s.robots[0].X_WR.x = std::nan(""); }},
      {"position of a joint", [](WorldState& s) { s.joints[1].position = std::nan(""); }},
      {"velocity of a joint", [](WorldState& s) { s.joints[1].velocity = HUGE_VAL; }},
      {"pose of an object", [](WorldState& s) { s.objects[1].X_WO.heading = std::nan(""); }},
      {"fall speed", [](WorldState& s) { s.objects[0].fall_speed = std::nan(""); }},
      {"left contact", [](WorldState& s) { s.grippers[0].left_contact = ModelId(4); }},
      {"right contact", [](WorldState& s) { s.grippers[0].right_contact = ModelId(4); }},
      {"clamped", [](WorldState& s) { s.grippers[0].clamped = ObjectId(2); }},
      {"support", [](WorldState& s) { s.objects[0].support = ModelId(4); }},
      {"held without a holder", [](WorldState& s) { s.objects[0].mode = ObjectMode::kHeld; }},
      {"resting with a holder", [](WorldState& s) { s.objects[0].holder = GripperId(0); }},
      {"held by an unknown gripper",
       [](WorldState& s) {
         s.objects[0].mode = ObjectMode::kHeld;
         s.objects[0].holder = GripperId(1);
       }},
  };
  for (const Case& bad : cases) {
    WorldState state = SomeState();
    bad.spoil(state);
    EXPECT_FALSE(CheckState(SomeWorld(), state).ok()) << bad.part;
  }
}

// A row of each kind, of a world that has them.
TEST(CheckStateTest, EveryNumberIsFinite) {
  WorldDescription world = SomeWorld();
  WorldState state = SomeState();
  const DeviceCounts devices{.stores = 1, .imus = 1, .lights = 1, .cameras = 1};
  state.stores.resize(1);
  state.imus.resize(1);
  state.lights.resize(1);
  state.cameras.resize(1);
  ASSERT_TRUE(CheckState(world, devices, state).ok());
  int numbers = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    ForEachLeaf<Row>([&]<typename Leaf>(const Leaf& leaf) {
      if constexpr (std::is_same_v<typename Leaf::Part, double>) {
        WorldState bad = state;
        leaf.Of(table.Of(bad).back()) = std::nan("");
        EXPECT_FALSE(CheckState(world, devices, bad).ok()) << table.name << ": " << leaf.name;
        ++numbers;
      }
    });
  });
  EXPECT_EQ(numbers, 7 + 2 + 5 + 2 + 3 + 2);
}

}  // namespace
}  // namespace troupe
