// Ray casting compared with a brute-force caster that has no pieces and grids: it tests the raw outlines of all models.
#include <gtest/gtest.h>

#include <optional>

#include "common/spatial/ray_cast.h"
#include "tests/support/brute_force_rays.h"
#include "tests/support/random_world.h"

namespace troupe {
namespace {

using test::BruteForceHit;
using test::BruteForceRays;
using test::RandomStream;

WorldState Shuffled(const WorldDescription& world, RandomStream& random, double half_width) {
  WorldState state = PlacedState(world);
  for (RobotState& robot : state.robots) robot.X_WR = RandomPose(random, half_width);
  return state;
}

TEST(RayCastProperty, AgreesWithBruteForceOverRawOutlines) {
  int hits = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    RandomStream random(seed + 1'000'000);
    const double half_width = random.Uniform(1.0, 10.0);
    const Scene scene(test::RandomWorld(seed, half_width, 10 + random.Index(20), random.Index(6)));
    const WorldState state = Shuffled(scene.world(), random, half_width);
    BodyIndex robots(scene);
    robots.Assign(state);
    const BruteForceRays rays(scene.world(), state);
    for (int ray = 0; ray < 24; ++ray) {
      const Vec2 origin(random.Uniform(-1.5, 1.5) * half_width, random.Uniform(-1.5, 1.5) * half_width);
      const SinCosResult trig = SinCos(random.Angle());
      const Vec2 direction(trig.cos, trig.sin);
      const double z = random.Uniform(0.0, 1.2);
      const double max_distance = random.Uniform(0.0, 4.0 * half_width);
      std::optional<RobotId> caster;
      if (!state.robots.empty() && random.Chance(0.5)) caster = RobotId(random.Index(state.robots.size()));

      const auto brute = rays.Cast(origin, direction, z, max_distance, caster);
      const std::optional<RayHit> hit = CastRay(scene, robots, {origin, direction, z, max_distance}, caster);
      ASSERT_EQ(hit.has_value(), !brute.empty()) << "seed " << seed << " ray " << ray;
      if (!hit) continue;
      ++hits;
      const BruteForceHit nearest = BruteForceRays::Nearest(brute);
      ASSERT_NEAR(hit->distance, static_cast<double>(nearest.distance), 1e-9) << "seed " << seed << " ray " << ray;
      // The lowest model id among the hits at that distance.
      ModelId expected = nearest.model;
      for (const BruteForceHit& other : brute) {
        if (other.distance <= nearest.distance + 1e-12L) expected = std::min(expected, other.model);
      }
      ASSERT_EQ(hit->model, expected) << "seed " << seed << " ray " << ray;
    }
  }
  EXPECT_GT(hits, 10000) << "the worlds are too empty to test anything";
}

TEST(RayCastProperty, FanGivesTheSameBitsAsSingleRays) {
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    RandomStream random(seed + 2'000'000);
    const double half_width = random.Uniform(1.0, 10.0);
    const Scene scene(test::RandomWorld(seed, half_width, random.Index(12), random.Index(12)));
    const WorldState state = Shuffled(scene.world(), random, half_width);
    BodyIndex robots(scene);
    robots.Assign(state);
    const Vec2 origin(random.Uniform(-1.2, 1.2) * half_width, random.Uniform(-1.2, 1.2) * half_width);
    const double heading = random.Angle();
    const double z = random.Uniform(0.0, 2.0);
    const double max_distance = random.Uniform(0.0, 3.0 * half_width);
    const double fov = random.Uniform(0.0, 7.0);
    std::optional<RobotId> caster;
    if (!state.robots.empty()) caster = RobotId(random.Index(state.robots.size()));
    std::vector<double> bearings;
    for (int i = 0; i < 40; ++i) bearings.push_back(fov * (i / 39.0 - 0.5));
    if (random.Chance(0.3)) std::reverse(bearings.begin(), bearings.end());
    if (random.Chance(0.2)) {
      for (double& bearing : bearings) bearing = random.Uniform(-20.0, 20.0);
    }
    std::vector<Ray> rays;
    for (const double bearing : bearings) {
      const SinCosResult trig = SinCos(heading + bearing);
      rays.push_back({origin, {trig.cos, trig.sin}, z, max_distance});
    }
    std::vector<std::optional<RayHit>> hits;
    CastRays(scene, robots, rays, caster, hits);
    ASSERT_EQ(hits.size(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::optional<RayHit> single = CastRay(scene, robots, rays[i], caster);
      ASSERT_EQ(hits[i].has_value(), single.has_value()) << "seed " << seed << " ray " << i;
      if (!single) continue;
      ASSERT_EQ(hits[i]->distance, single->distance) << "seed " << seed << " ray " << i;
      ASSERT_EQ(hits[i]->model, single->model) << "seed " << seed << " ray " << i;
    }
  }
}

TEST(RayCastProperty, RaysTogetherGiveTheSameBitsAsSingleRays) {
  std::size_t hits_on_robots = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    RandomStream random(seed + 6'000'000);
    const double half_width = random.Uniform(1.0, 10.0);
    const std::size_t robots = seed % 20 == 0 ? 300 : random.Index(30);
    const Scene scene(test::RandomWorld(seed, half_width, random.Index(12), robots));
    const WorldState state = Shuffled(scene.world(), random, half_width);
    BodyIndex bodies(scene);
    bodies.Assign(state);
    std::optional<RobotId> caster;
    if (!state.robots.empty()) caster = RobotId(random.Index(state.robots.size()));
    std::vector<Ray> rays;
    for (int i = 0; i < 16; ++i) {
      const SinCosResult trig = SinCos(random.Angle());
      rays.push_back({.origin = {random.Uniform(-1.0, 1.0) * half_width, random.Uniform(-1.0, 1.0) * half_width},
                      .direction = {trig.cos, trig.sin},
                      .z = random.Chance(0.5) ? 0.3 : random.Uniform(0.0, 2.0),
                      .max_distance = random.Uniform(0.0, 3.0 * half_width)});
    }
    std::vector<std::optional<RayHit>> hits;
    CastRays(scene, bodies, rays, caster, hits);
    ASSERT_EQ(hits.size(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::optional<RayHit> single = CastRay(scene, bodies, rays[i], caster);
      ASSERT_EQ(hits[i].has_value(), single.has_value()) << "seed " << seed << " ray " << i;
      if (!single) continue;
      ASSERT_EQ(hits[i]->distance, single->distance) << "seed " << seed << " ray " << i;
      ASSERT_EQ(hits[i]->model, single->model) << "seed " << seed << " ray " << i;
      if (scene.robot_of(single->model)) ++hits_on_robots;
    }
  }
  EXPECT_GT(hits_on_robots, 400u) << "too empty to test anything";
}

TEST(RayCastProperty, NoRaySlipsBetweenTheRectanglesOfAWall) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    RandomStream random(seed + 3'000'000);
    // A closed room whose walls are rows of rectangles that share edges, turned by any angle.
    test::TestWorld test;
    const Pose X_WM = RandomPose(random, 5.0);
    const ModelId room = test.AddModel(std::vector<Block>{}, X_WM);
    Shape& shape = test.world.shapes.back();
    shape.rectangles_z = {0.0, 1.0};
    for (int i = -10; i <= 10; ++i) {
      const double at = i * 0.1;
      shape.rectangles.push_back({at, 1.1, at + 0.1, 1.2});
      shape.rectangles.push_back({at, -1.0, at + 0.1, -0.9});
      shape.rectangles.push_back({1.1, at, 1.2, at + 0.1});
      shape.rectangles.push_back({-1.0, at, -0.9, at + 0.1});
    }
    shape.rectangles.push_back({1.1, 1.1, 1.2, 1.2});
    const Scene scene(test.world);
    BodyIndex robots(scene);
    robots.Assign(PlacedState(scene.world()));
    const Vec2 origin = Transform2(X_WM) * Vec2(random.Uniform(-0.8, 0.8), random.Uniform(-0.8, 0.8));
    for (const ConvexPiece& piece : scene.static_index().kept_pieces()) {
      for (const Vec2& vertex : piece.vertices) {  // exactly at the seams
        const Vec2 direction = (vertex - origin).normalized();
        const std::optional<RayHit> hit = CastRay(scene, robots, {origin, direction, 0.5, 10.0}, std::nullopt);
        ASSERT_TRUE(hit.has_value()) << "seed " << seed;
        ASSERT_EQ(hit->model, room);
        ASSERT_LE(hit->distance, (vertex - origin).norm() + 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace troupe
