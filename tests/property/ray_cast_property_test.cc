// Ray casting compared with a brute-force caster that has no pieces and grids: it tests the raw outlines of all models.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/ray_cast.h"
#include "common/spatial/sweep.h"
#include "tests/support/exact_prisms.h"
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

// The exact sweep compared with brute force: many small time steps.

struct Case {
  Polygon a;
  Polygon b;
  Pose X_WR;
  Twist twist;
  double duration;

  double DepthAfter(double seconds) const {
    const Transform2 transform(X_WR * Integrate(twist, seconds));
    Polygon moved;
    for (const Vec2& vertex : a) moved.push_back(transform * vertex);
    return PenetrationDepth(moved, b);
  }
  double MaxSpeed() const {
    double radius = 0.0;
    for (const Vec2& vertex : a) radius = std::max(radius, vertex.norm());
    return std::hypot(twist.vx, twist.vy) + std::abs(twist.wz) * radius;
  }
};

Twist RandomTwist(RandomStream& random, double speed, double rate) {
  Twist twist{random.Uniform(-speed, speed), random.Uniform(-speed, speed), random.Uniform(-rate, rate)};
  if (random.Chance(0.3)) twist.wz = 0.0;
  if (random.Chance(0.1)) twist.wz *= 1e-6;
  if (random.Chance(0.1)) twist.wz *= 1e-12;
  if (random.Chance(0.3)) twist.vy = 0.0;
  if (random.Chance(0.2)) twist.vx = 0.0;
  return twist;
}

Case RandomCase(std::uint64_t seed) {
  RandomStream random(seed);
  Case result;
  result.a = random.Chance(0.3) ? test::Square(random.Uniform(0.2, 1.0)) : test::RandomConvex(random, 0.05, 0.6);
  const Polygon b = random.Chance(0.3) ? test::Box(-0.0005, -1.0, 0.0005, 1.0) : test::RandomConvex(random, 0.05, 0.8);
  const Transform2 X_WB(RandomPose(random, 1.5));
  for (const Vec2& vertex : b) result.b.push_back(X_WB * vertex);
  result.X_WR = RandomPose(random, 1.5);
  const double scale = random.Chance(0.3) ? 10.0 : 1.0;
  result.twist = RandomTwist(random, 2.0 * scale, 4.0 * scale);
  result.duration = random.Uniform(0.1, 1.0);
  return result;
}

std::optional<double> Sweep(const Case& c) {
  return TimeOfContact(c.a, c.X_WR, c.twist, c.duration, c.b);
}

TEST(SweepProperty, AgreesWithFineTimeSteps) {
  constexpr int kSteps = 1500;
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    const Case c = RandomCase(seed);
    if (c.DepthAfter(0.0) > kTouchTolerance || c.twist.IsZero()) continue;
    const std::optional<double> time = Sweep(c);
    const double free_until = time.value_or(c.duration);
    for (int step = 0; step <= kSteps; ++step) {
      ASSERT_LE(c.DepthAfter(free_until * step / kSteps), 1.01 * kTouchTolerance)
          << "seed " << seed << ": overlap before the contact, step " << step << " of " << kSteps;
    }
    if (!time) continue;
    ++contacts;
    // The contact is no further than a millimetre.
    const double millimetre = 1e-3 / c.MaxSpeed();
    double deepest = -1.0;
    for (int step = 1; step <= 100; ++step) deepest = std::max(deepest, c.DepthAfter(*time + millimetre * step / 100));
    ASSERT_GT(deepest, kTouchTolerance) << "seed " << seed << ": no contact at " << *time;
  }
  EXPECT_GT(contacts, 300);
}

// Obstacles that the filter leaves out would not be in contact: the result is the same to the last bit without it.
TEST(SweepProperty, FiltersOutOnlyObstaclesWithoutContact) {
  int contacts = 0;
  int passed_by = 0;
  for (std::uint64_t seed = 1; seed <= 40000; ++seed) {
    Case c = RandomCase(seed);
    if (seed % 2 == 0) c.duration = 0.05;  // near misses
    const ConvexPiece mine{.vertices = c.a, .z = {0.0, 1.0}, .model = ModelId(0)};
    const ConvexPiece other{.vertices = c.b, .z = {0.0, 1.0}, .model = ModelId(1)};
    double square = 0.0;
    for (const Vec2& vertex : c.a) square = std::max(square, vertex.squaredNorm());
    const Mover mover{std::span(&mine, 1), std::sqrt(square), mine.z, {}};
    const std::optional<Contact> contact =
        FirstContactWith(std::span(&other, 1), mover, Motion{c.X_WR, c.twist, 0.0, c.duration});
    const std::optional<double> time = Sweep(c);
    ASSERT_EQ(contact.has_value(), time.has_value()) << "seed " << seed;
    if (time) {
      ASSERT_EQ(contact->time, *time) << "seed " << seed;
    }
    ++(time ? contacts : passed_by);
  }
  EXPECT_GT(contacts, 5000);
  EXPECT_GT(passed_by, 5000);
}

TEST(SweepProperty, FindsTheSameContactInAnyOrderOfObstacles) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    const Case c = RandomCase(seed);
    std::vector<ConvexPiece> mine;
    std::vector<ConvexPiece> standing;
    double square = 0.0;
    for (std::uint64_t i = 0; i < 6; ++i) {
      const Case other = RandomCase(RandomBits({seed, i}));
      const double z = 0.2 * static_cast<double>(i);
      standing.push_back({.vertices = other.b, .z = {z, z + 0.5}, .model = ModelId(100 + i)});
      if (i < 3) mine.push_back({.vertices = other.a, .z = {z, z + 0.3}, .model = ModelId(i)});
    }
    for (const ConvexPiece& piece : mine) {
      for (const Vec2& vertex : piece.vertices) square = std::max(square, vertex.squaredNorm());
    }
    const Motion motion{c.X_WR, c.twist, 0.0, c.duration};
    const auto meet = [&] {
      return FirstContactWith(standing, Mover{mine, std::sqrt(square), {0.0, 0.7}, {}}, motion);
    };
    const std::optional<Contact> contact = meet();
    std::reverse(mine.begin(), mine.end());
    std::rotate(standing.begin(), standing.begin() + 4, standing.end());
    const std::optional<Contact> again = meet();
    ASSERT_EQ(contact.has_value(), again.has_value()) << "seed " << seed;
    if (!contact) continue;
    ++contacts;
    ASSERT_EQ(contact->time, again->time) << "seed " << seed;
    ASSERT_EQ(contact->mine, again->mine) << "seed " << seed;
    ASSERT_EQ(contact->other, again->other) << "seed " << seed;
  }
  EXPECT_GT(contacts, 1000);
}

TEST(SweepProperty, NeverDeepensAnInitialOverlap) {
  int overlapping = 0;
  for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
    const Case c = RandomCase(seed);
    const double initial = c.DepthAfter(0.0);
    if (initial <= kTouchTolerance) continue;
    ++overlapping;
    const std::optional<double> time = Sweep(c);
    ASSERT_LE(c.DepthAfter(time.value_or(c.duration)), initial + 1e-12) << "seed " << seed;
  }
  EXPECT_GT(overlapping, 1000);
}

TEST(SweepProperty, LetsAnOverlappingPairSeparate) {
  for (std::uint64_t seed = 1; seed <= 5000; ++seed) {
    RandomStream random(seed + 50'000'000);
    // Straight away from a half plane that it sticks in.
    Case c = RandomCase(seed);
    c.b = test::Box(-100.0, -100.0, 0.0, 100.0);
    c.X_WR = {random.Uniform(-0.01, 0.1), 0.0, 0.0, random.Angle()};
    const SinCosResult trig = SinCos(c.X_WR.heading);
    c.twist = {.vx = trig.cos, .vy = -trig.sin, .wz = 0.0};
    ASSERT_EQ(Sweep(c), std::nullopt) << "seed " << seed;
  }
}

TEST(SweepProperty, NeverTunnelsThroughAThinWallAtAnySpeed) {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    RandomStream random(seed + 60'000'000);
    Case c = RandomCase(seed);
    const double distance = random.Uniform(1.0, 50.0);
    c.b = test::Box(distance, -1000.0, distance + 1e-3, 1000.0);
    c.X_WR = {0.0, 0.0, 0.0, random.Uniform(-1.0, 1.0)};
    c.twist = {.vx = std::pow(10.0, random.Uniform(0.0, 5.0)), .vy = 0.0, .wz = 0.0};
    c.duration = 200.0 / c.twist.vx;
    const std::optional<double> time = Sweep(c);
    ASSERT_TRUE(time.has_value()) << "seed " << seed;
    ASSERT_NEAR(c.DepthAfter(*time), 0.0, 1e-9) << "seed " << seed;
  }
}

TEST(SweepProperty, GlidesAlongAWallThatItTouches) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    RandomStream random(seed + 70'000'000);
    // A square flush against a wall of several pieces, everything turned by some angle.
    const Pose X_WF = RandomPose(random, 20.0);
    const Transform2 to_world(X_WF);
    const double size = random.Uniform(0.1, 1.0);
    const Pose X_WR = X_WF * Pose{0.0, 0.5 * size, 0.0, 0.0};
    const double speed = random.Uniform(0.01, 100.0);
    for (int piece = -3; piece <= 3; ++piece) {
      Polygon wall;
      for (const Vec2& vertex : test::Box(piece * 0.7, -0.1, (piece + 1) * 0.7, 0.0)) wall.push_back(to_world * vertex);
      const Polygon body = test::Square(size);
      for (double direction : {-1.0, 1.0}) {
        ASSERT_EQ(TimeOfContact(body, X_WR, {.vx = direction * speed}, 0.1, wall), std::nullopt) << "seed " << seed;
      }
      ASSERT_EQ(TimeOfContact(body, X_WR, {.vy = speed}, 0.1, wall), std::nullopt) << "seed " << seed;
    }
    Polygon wall;
    for (const Vec2& vertex : test::Box(-0.3, -0.1, 0.4, 0.0)) wall.push_back(to_world * vertex);
    const std::optional<double> into = TimeOfContact(test::Square(size), X_WR, {.vy = -speed}, 0.1, wall);
    ASSERT_TRUE(into.has_value());
    ASSERT_LE(*into * speed, 1e-9);
  }
}

}  // namespace
}  // namespace troupe
