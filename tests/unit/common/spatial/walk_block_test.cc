#include "common/spatial/walk_block.h"

#include <gtest/gtest.h>

#include <vector>

#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

struct Step {
  std::array<std::size_t, 2> cells;
  double entered;
  bool operator==(const Step&) const = default;
};

// All columns that the walk passes.
std::vector<Step> StepsOf(GridWalk walk) {
  std::vector<Step> steps;
  while (walk.Next([](std::size_t) { return true; })) steps.push_back({walk.cells(), walk.entered()});
  return steps;
}

struct WalkedRay {
  Vec2 origin;
  Vec2 direction;
  double max_distance;
};

class WalkBlockTest : public ::testing::Test {
 protected:
  void ExpectSameSteps(const std::vector<WalkedRay>& rays) {
    WalkBlock block;
    for (const WalkedRay& ray : rays) {
      block.Add(ray.origin, ray.direction, ray.direction.array().inverse(), ray.max_distance);
    }
    for (const auto& [needs, start] : WalkBlock::Starters()) {
      std::vector<GridWalk> walks(rays.size());
      start(block, grid_, walks);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const WalkedRay& ray = rays[i];
        const GridWalk walk(grid_, ray.origin, ray.direction, ray.direction.array().inverse(), ray.max_distance);
        ASSERT_EQ(StepsOf(walks[i]), StepsOf(walk))
            << "from " << ray.origin.transpose() << " along " << ray.direction.transpose();
        steps_ += StepsOf(walk).size();
      }
    }
  }

  Grid grid_{{-3.0, -2.0, 7.0, 5.0}, 0.25, 1e6};
  std::size_t steps_ = 0;
};

TEST_F(WalkBlockTest, AnyInstructionsStartTheSameWalks) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    std::vector<WalkedRay> rays;
    for (std::uint64_t i = 0; i < 1 + seed % WalkBlock::kLanes; ++i) {
      const auto draw = [&](std::uint64_t number) { return RandomUniform({seed, i, number}); };
      // Every fourth block has rays that start beyond the grid.
      const double margin = seed % 4 == 0 ? 2.0 : 0.0;
      const SinCosResult at = SinCos(kPi * (2.0 * draw(0) - 1.0));
      rays.push_back({{-3.0 - margin + (10.0 + 2.0 * margin) * draw(1), -2.0 - margin + (7.0 + 2.0 * margin) * draw(2)},
                      {at.cos, at.sin},
                      12.0 * draw(3)});
    }
    ExpectSameSteps(rays);
  }
  EXPECT_GT(steps_, 10'000u);
}

TEST_F(WalkBlockTest, RaysAlongLinesOfCellsAndThroughTheirCornersAreNoException) {
  const double diagonal = std::sqrt(0.5);
  std::vector<WalkedRay> rays;
  for (const Vec2& origin : {Vec2(0.0, 0.0), Vec2(-3.0, -2.0), Vec2(7.0, 5.0), Vec2(0.1, 0.25)}) {
    for (const double x : {-1.0, 0.0, 1.0}) {
      for (const double y : {-1.0, 0.0, 1.0}) {
        if (x == 0.0 && y == 0.0) continue;
        const double length = x != 0.0 && y != 0.0 ? diagonal : 1.0;
        rays.push_back({origin, {length * x, length * y}, rays.size() % 3 == 0 ? 0.0 : 20.0});
        if (rays.size() < WalkBlock::kLanes) continue;
        ExpectSameSteps(rays);
        rays.clear();
      }
    }
  }
  EXPECT_GT(steps_, 100u);
}

}  // namespace
}  // namespace troupe
