#include "common/spatial/ray_block.h"

#include <gtest/gtest.h>

#include <limits>

#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

double Between(double low, double high, std::uint64_t seed, std::uint64_t number) {
  return low + (high - low) * RandomUniform({seed, number});
}

struct Disc {
  Vec2 center;
  double radius;
};

// How far the disc is from touching the ray, m; negative if it does.
double Gap(const RayBlock::Part& ray, const Disc& disc) {
  const Vec2 from_start = disc.center - ray.origin;
  const double along = std::min(std::max(ray.direction.dot(from_start), 0.0), ray.length);
  return (from_start - along * ray.direction).norm() - disc.radius;
}

class RayBlockTest : public ::testing::TestWithParam<std::size_t> {
 protected:
  // `rays`: of a fan of `width` rad that start near the origin.
  void Make(std::uint64_t seed, std::size_t rays, double width) {
    for (std::size_t i = 0; i < rays; ++i) {
      const SinCosResult at = SinCos(Between(-kPi, kPi, seed, 0) + width * Between(0.0, 1.0, seed, 10 + i));
      rays_.push_back({.origin = {Between(-0.2, 0.2, seed, 100 + i), Between(-0.2, 0.2, seed, 200 + i)},
                       .direction = {at.cos, at.sin},
                       .length = Between(0.0, 8.0, seed, 300 + i)});
    }
    for (std::uint64_t i = 0; i < 53; ++i) {
      const Vec2 center(Between(-9.0, 9.0, seed, 1000 + i), Between(-9.0, 9.0, seed, 2000 + i));
      Add({center, Between(0.05, 0.4, seed, 3000 + i)});
    }
  }
  void Add(const Disc& disc) {
    discs_.push_back(disc);
    list_.Add(disc.center, disc.radius);
  }
  // The rays that may reach each disc.
  std::vector<std::uint32_t> Touched(RayBlock::Finder* finder) {
    std::vector<RayBlock::Touched> touched;
    RayBlock(rays_, 0.4).FindTouched(list_, touched, finder);
    std::vector<std::uint32_t> rays(discs_.size(), 0);
    for (std::size_t i = 0; i < touched.size(); ++i) {
      EXPECT_TRUE(i == 0 || touched[i - 1].disc < touched[i].disc);
      EXPECT_NE(touched[i].rays, 0u);
      rays.at(touched[i].disc) = touched[i].rays;
    }
    return rays;
  }

  std::vector<RayBlock::Part> rays_;
  std::vector<Disc> discs_;
  DiscList list_;
};

TEST_P(RayBlockTest, FindsAllThatTouchAndHardlyOthers) {
  // The discs that a ray may reach are those that overlap a box around it, at the ends of the ray.
  constexpr double kCorner = 0.42 * 0.4;  // m, of the largest disc
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    rays_.clear();
    discs_.clear();
    list_.Clear();
    Make(seed, GetParam(), seed % 2 == 0 ? 0.3 : 2.0 * kPi);
    for (const auto& [needs, finder] : RayBlock::Finders()) {
      const std::vector<std::uint32_t> touched = Touched(finder);
      for (std::size_t d = 0; d < discs_.size(); ++d) {
        EXPECT_EQ(touched[d] >> rays_.size(), 0u);
        for (std::size_t r = 0; r < rays_.size(); ++r) {
          const double gap = Gap(rays_[r], discs_[d]);
          const bool is_found = (touched[d] >> r & 1) != 0;
          EXPECT_TRUE(is_found || gap > 0.0) << "seed " << seed << " disc " << d << " ray " << r;
          EXPECT_TRUE(!is_found || gap <= kCorner) << "seed " << seed << " disc " << d << " ray " << r;
        }
      }
    }
  }
}

TEST_P(RayBlockTest, ABoundOfTheWayIsNotBeyondTheDisc) {
  Make(7, GetParam(), 2.0 * kPi);
  const RayBlock block(rays_, 0.4);
  for (std::uint32_t d = 0; d < discs_.size(); ++d) {
    for (std::uint32_t r = 0; r < rays_.size(); ++r) {
      const double way = rays_[r].direction.dot(discs_[d].center - rays_[r].origin) - discs_[d].radius;
      EXPECT_LE(block.WayTo(list_, d, r), way);
      EXPECT_NEAR(block.WayTo(list_, d, r), way, 1e-3);
    }
  }
}

TEST_P(RayBlockTest, NumbersOfEarlierDiscsDoNotCount) {
  Make(3, GetParam(), 1.0);
  list_.Clear();
  discs_.clear();
  for (const auto& [needs, finder] : RayBlock::Finders()) EXPECT_TRUE(Touched(finder).empty());
  Add({rays_[0].origin, 0.1});
  for (const auto& [needs, finder] : RayBlock::Finders()) EXPECT_TRUE(Touched(finder).at(0) & 1);
}

TEST_P(RayBlockTest, ADiscWithoutAPlaceIsNear) {
  Make(5, GetParam(), 1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Add({{nan, nan}, 0.1});
  const std::uint32_t all = (1u << rays_.size()) - 1;
  for (const auto& [needs, finder] : RayBlock::Finders()) EXPECT_EQ(Touched(finder).back(), all);
}

INSTANTIATE_TEST_SUITE_P(Rays, RayBlockTest, ::testing::Values(1, 12, 16));

}  // namespace
}  // namespace troupe
