#include "common/model/state_hash.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

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

TEST(StateHash, IsAFunctionOfTheState) {
  EXPECT_EQ(StateHash(HashedState()), StateHash(HashedState()));
}

}  // namespace
}  // namespace troupe
