#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "common/model/states.h"
#include "tests/support/test_world.h"

namespace troupe {
namespace {

WorldState HashedState() {
  test::TestWorld test;
  test.AddRobot(test::Square(0.4), {0.0, 1.0}, {1.0, 2.0, 0.5, 0.3});
  test.AddRobot(test::Square(0.4), {0.0, 1.0}, {-1.0, 0.0, 0.0, 0.0});
  return PlacedState(test.world);
}

TEST(StateHash, ChangesWithEveryPartOfTheState) {
  const std::function<void(WorldState&)> changes[] = {
      [](WorldState&) {},
      [](WorldState& s) { s.tick = 1; },
      [](WorldState& s) { s.robots[0].X_WR.x = std::nextafter(s.robots[0].X_WR.x, 9.0); },
      [](WorldState& s) { s.robots[0].X_WR.y += 1e-9; },
      [](WorldState& s) { s.robots[0].X_WR.z += 1e-9; },
      [](WorldState& s) { s.robots[0].X_WR.heading += 1e-9; },
      [](WorldState& s) { s.robots[1].twist.vx = 1.0; },
      [](WorldState& s) { s.robots[1].twist.vy = 1.0; },
      [](WorldState& s) { s.robots[1].twist.wz = 1.0; },
      [](WorldState& s) { s.robots[0].twist.vx = 1.0; },
      [](WorldState& s) { s.robots[1].stalled = true; },
      [](WorldState& s) { std::swap(s.robots[0], s.robots[1]); },
      [](WorldState& s) { s.robots.pop_back(); },
  };
  std::set<std::uint64_t> hashes;
  for (const auto& change : changes) {
    WorldState state = HashedState();
    change(state);
    EXPECT_TRUE(hashes.insert(StateHash(state)).second) << "change " << hashes.size();
  }
}

// Another value.
void Change(double& number) {
  number += 1.0;
}
void Change(bool& flag) {
  flag = !flag;
}
void Change(std::uint64_t& number) {
  ++number;
}
void Change(ObjectMode& mode) {
  mode = ObjectMode::kFalling;
}
void Change(std::vector<std::uint8_t>& bytes) {
  bytes.push_back(0);
}
template <typename Tag>
void Change(Id<Tag>& id) {
  id = Id<Tag>(7);
}
template <typename Tag>
void Change(std::optional<Id<Tag>>& id) {
  id = Id<Tag>(0);
}

TEST(StateHash, ChangesWithEveryFieldOfEveryRow) {
  WorldState state;
  state.tick = 1;
  ForEachTable([&](const auto& table) { table.Of(state).resize(2); });
  std::set<std::uint64_t> hashes = {StateHash(state)};
  std::size_t fields = 1;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    ForEachLeaf<Row>([&](const auto& leaf) {
      for (std::size_t row = 0; row < 2; ++row) {
        WorldState changed = state;
        Change(leaf.Of(table.Of(changed)[row]));
        EXPECT_TRUE(hashes.insert(StateHash(changed)).second) << table.name << " " << row << ": " << leaf.name;
      }
      fields += 2;
    });
  });
  EXPECT_EQ(hashes.size(), fields);
}

// The hashes of recordings: they never change.
TEST(StateHash, OfAStateIsAlwaysTheSame) {
  WorldState state{.tick = 2,
                   .robots = {{{1.0, 2.0, 3.0, 0.25}, {4.0, 5.0, 6.0}, true}, {}},
                   .joints = {{0.5, -0.125, true}},
                   .grippers = {{ModelId(3), std::nullopt, ObjectId(0)}},
                   .objects = {{{1.5, 2.5, 3.5, -0.5}, ObjectMode::kHeld, 0.75, GripperId(0), std::nullopt},
                               {{}, ObjectMode::kResting, 0.0, std::nullopt, ModelId(9)}}};
  EXPECT_EQ(StateHash(state), 0xed2b4e8603fc4992);
  state.stores = {{12.5, 7.5}};
  state.imus = {{8.0, 9.0, 10.0}};
  state.lights = {{false}, {true}};
  state.cameras = {{0.5, -0.25}};
  state.transmissions = {{RobotId(1), 1, 9, 3, {2, RobotId(0), {1, 2, 3}}}, {.from = RobotId(0)}};
  EXPECT_EQ(StateHash(state), 0xd372da59c89fd345);
  state.tick = 0;  // the support of the second object is not hashed
  EXPECT_EQ(StateHash(state), 0xb461254dea607bf9);
  state.objects[1].mode = ObjectMode::kPlaced;
  state.objects[1].support.reset();
  EXPECT_EQ(StateHash(state), 0xb461254dea607bf9);
}

TEST(StateHash, IsAFunctionOfTheState) {
  EXPECT_EQ(StateHash(HashedState()), StateHash(HashedState()));
}

}  // namespace
}  // namespace troupe
