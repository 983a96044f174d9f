// Seeded random worlds for property tests.
// A world is a function of its seed and of nothing else (troupe/random.h has no state): the seed in the message of a
// failure is enough to repeat it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/model/states.h"
#include "tests/support/test_world.h"
#include "troupe/random.h"

namespace troupe::test {

// A stream of random numbers, a function of its seed.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : seed_(seed) {}

  double Uniform(double low, double high) { return low + (high - low) * RandomUniform({seed_, count_++}); }
  // In [0, count).
  std::size_t Index(std::size_t count) { return RandomBits({seed_, count_++}) % count; }
  bool Chance(double probability) { return Uniform(0.0, 1.0) < probability; }
  double Angle() { return Uniform(-kPi, kPi); }

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

inline Polygon NormalizedOr(const Polygon& polygon, const Polygon& otherwise) {
  const Result<Polygon> normalized = Normalized(polygon);
  return normalized.ok() ? normalized.value() : otherwise;
}

// A simple polygon, usually concave: vertices at random distances all around `center`.
inline Polygon RandomStar(RandomStream& random, const Vec2& center, double min_radius, double max_radius) {
  const std::size_t count = 3 + random.Index(8);
  Polygon polygon;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * (static_cast<double>(i) + random.Uniform(0.1, 0.9)) / static_cast<double>(count);
    const SinCosResult trig = SinCos(angle);
    polygon.push_back(center + random.Uniform(min_radius, max_radius) * Vec2(trig.cos, trig.sin));
  }
  // With few vertices the centre may lie outside and edges may cross.
  return NormalizedOr(polygon, Square(max_radius));
}

// A convex polygon: vertices on an ellipse.
inline Polygon RandomConvex(RandomStream& random, double min_radius, double max_radius) {
  const std::size_t count = 3 + random.Index(5);
  const double a = random.Uniform(min_radius, max_radius);
  const double b = random.Uniform(min_radius, max_radius);
  Polygon polygon;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * (static_cast<double>(i) + random.Uniform(0.05, 0.95)) / static_cast<double>(count);
    const SinCosResult trig = SinCos(angle);
    polygon.push_back({a * trig.cos, b * trig.sin});
  }
  return NormalizedOr(polygon, Square(min_radius));
}

inline ZRange RandomHeights(RandomStream& random) {
  const double bottom = random.Chance(0.5) ? 0.0 : random.Uniform(0.0, 1.5);
  return {bottom, bottom + random.Uniform(0.05, 1.0)};
}

inline Pose RandomPose(RandomStream& random, double half_width) {
  // Sometimes an axis-aligned heading, for parallel edges.
  const double heading =
      random.Chance(0.3) ? 0.5 * kPi * static_cast<double>(random.Index(4)) - 0.5 * kPi : random.Angle();
  return {random.Uniform(-half_width, half_width), random.Uniform(-half_width, half_width), 0.0, heading};
}

inline void RandomizeReturns(RandomStream& random, ModelDescription& model) {
  model.obstacle_return = !random.Chance(0.15);
  model.ranger_return = random.Chance(0.15) ? -1.0 : random.Uniform(0.0, 2.0);
}

// Polygons, rotated walls of rectangles and robots with children, in a square of `half_width` about the origin.
// Robots do not overlap anything in the plane.
inline WorldDescription RandomWorld(std::uint64_t seed, double half_width, std::size_t models, std::size_t robots) {
  RandomStream random(seed);
  TestWorld test;
  for (std::size_t i = 0; i < models; ++i) {
    ModelId id;
    if (random.Chance(0.3)) {
      const double cell = random.Uniform(0.02, 0.3);
      id = test.AddModel(std::vector<Block>{}, RandomPose(random, half_width));
      Shape& shape = test.world.shapes.back();
      for (int k = 0; k < 4; ++k) shape.rectangles.push_back({k * cell, 0.0, (k + 1) * cell, cell * (1.0 + k)});
      shape.rectangles_z = RandomHeights(random);
    } else {
      std::vector<Block> blocks;
      const std::size_t count = 1 + random.Index(2);
      for (std::size_t k = 0; k < count; ++k) {
        blocks.push_back({RandomStar(random, {0.4 * static_cast<double>(k), 0.0}, 0.1, 0.8), RandomHeights(random)});
      }
      id = test.AddModel(std::move(blocks), RandomPose(random, half_width));
    }
    test.model(id).X_PM.z = random.Uniform(0.0, 0.2);
    RandomizeReturns(random, test.model(id));
  }

  struct Disc {
    Vec2 center;
    double radius;
  };
  std::vector<Disc> taken;
  const std::vector<Pose> X_WM = ModelPoses(test.world, PlacedState(test.world));
  for (std::size_t i = 0; i < X_WM.size(); ++i) taken.push_back({X_WM[i].translation(), 1.75});
  for (std::size_t i = 0; i < robots; ++i) {
    constexpr double kRadius = 0.75;
    Pose X_WR = RandomPose(random, half_width);
    const auto collides = [&] {
      return std::any_of(taken.begin(), taken.end(), [&](const Disc& disc) {
        return (disc.center - X_WR.translation()).norm() < disc.radius + kRadius;
      });
    };
    for (int attempt = 0; attempt < 200 && collides(); ++attempt) X_WR = RandomPose(random, half_width);
    if (collides()) continue;
    taken.push_back({X_WR.translation(), kRadius});
    // In statements of their own: the compiler may evaluate the arguments of a call in any order.
    const Polygon outline = RandomStar(random, Vec2::Zero(), 0.1, 0.3);
    const ZRange heights = RandomHeights(random);
    const ModelId root = test.world.robot(test.AddRobot(outline, heights, X_WR)).root;
    RandomizeReturns(random, test.model(root));
    const std::size_t children = random.Index(3);
    for (std::size_t k = 0; k < children; ++k) {
      const Polygon child_outline = RandomStar(random, Vec2::Zero(), 0.05, 0.2);
      const ZRange child_heights = RandomHeights(random);
      const ModelId child = test.AddModel(child_outline, child_heights, RandomPose(random, 0.2), root);
      RandomizeReturns(random, test.model(child));
    }
  }
  return test.world;
}

}  // namespace troupe::test
