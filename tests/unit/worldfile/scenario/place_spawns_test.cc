#include "worldfile/scenario/place_spawns.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "tests/support/random_world.h"

namespace troupe {
namespace {

Rectangle RandomBox(test::RandomStream& random) {
  const double x = random.Uniform(-20.0, 20.0);
  const double y = random.Uniform(-20.0, 20.0);
  return {x, y, x + random.Uniform(0.0, 3.0), y + random.Uniform(0.0, 3.0)};
}

TEST(CellMap, MissesNoBoxThatOverlaps) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    test::RandomStream random(seed);
    CellMap map(random.Uniform(0.5, 5.0));
    std::vector<Rectangle> boxes;
    for (std::uint32_t i = 0; i < 60; ++i) {
      boxes.push_back(RandomBox(random));
      map.Insert(boxes.back(), i);
    }
    for (int query = 0; query < 40; ++query) {
      const Rectangle box = RandomBox(random);
      std::set<std::uint32_t> asked;
      EXPECT_FALSE(map.AnyNear(box, [&](std::uint32_t number) {
        asked.insert(number);
        return false;
      }));
      for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        if (boxes[i].Overlaps(box)) {
          EXPECT_TRUE(asked.contains(i)) << "seed " << seed;
        }
      }
      EXPECT_EQ(map.AnyNear(box, [](std::uint32_t) { return true; }), !asked.empty());
    }
  }
}

TEST(CellMap, TestsOnlyBoxesThatAreNear) {
  CellMap map(1.0);
  for (std::uint32_t i = 0; i < 100; ++i) map.Insert({3.0 * i, 0.0, 3.0 * i + 1.0, 1.0}, i);
  int asked = 0;
  map.AnyNear({30.0, 0.0, 31.0, 1.0}, [&](std::uint32_t) {
    ++asked;
    return false;
  });
  EXPECT_LE(asked, 4);
}

TEST(CellMap, ASizeOfZeroCountsAsSmall) {
  CellMap map(0.0);
  map.Insert({1.0, 1.0, 1.0, 1.0}, 7);
  EXPECT_TRUE(map.AnyNear({0.9995, 1.0, 1.0005, 1.0}, [](std::uint32_t number) { return number == 7; }));
}

}  // namespace
}  // namespace troupe
