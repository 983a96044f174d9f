// Ray casting in real worlds, from the poses of robots and from random ones, compared with brute force.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/spatial/ray_cast.h"
#include "tests/support/exact_prisms.h"
#include "tests/support/random_world.h"
#include "tests/support/small_world.h"
#include "tests/support/stage_worlds.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

using test::BruteForceHit;
using test::BruteForceRays;
using test::RandomStream;

constexpr int kRays = 12000;

struct Ray {
  Vec2 origin;
  Vec2 direction;
  double z;
  double max_distance;
  std::optional<RobotId> caster;
};

class WorldRays {
 public:
  WorldRays(const WorldDescription& world, std::uint64_t seed)
      : scene_(world), state_(PlacedState(scene_.world())), bodies_(scene_), random_(seed) {
    Extend(scene_.static_index().kept_pieces());
    bodies_.Assign(state_);
    for (std::size_t i = 0; i < scene_.body_count(); ++i) Extend(bodies_.pieces_in_world(BodyId(i)));
  }

  // Casts from the robots' poses at the heights of their sensors, and from random places and heights.
  void Compare() {
    bodies_.Assign(state_);
    const BruteForceRays brute_force(scene_.world(), state_);
    const std::vector<Ray> sensors = SensorRays();
    for (int i = 0; i < kRays && !testing::Test::HasFailure(); ++i) {
      const bool of_sensor = !sensors.empty() && i % 2 == 0;
      const Ray ray = of_sensor ? Turned(sensors[random_.Index(sensors.size())]) : AnyRay();
      const auto hit = CastRay(scene_, bodies_, {ray.origin, ray.direction, ray.z, ray.max_distance}, ray.caster);
      Check(ray, hit, brute_force.Cast(ray.origin, ray.direction, ray.z, ray.max_distance, ray.caster));
    }
  }

  // Places the robots anywhere, inside bodies too.
  void Shuffle() {
    for (RobotState& robot : state_.robots) {
      const Vec2 place = AnyPlace();
      robot.X_WR = {place.x(), place.y(), robot.X_WR.z, random_.Angle()};
    }
  }

  int hits() const { return hits_; }

 private:
  void Extend(const std::vector<ConvexPiece>& pieces) {
    for (const ConvexPiece& piece : pieces) {
      bounds_.Extend(piece.vertices.front());
      heights_.max = std::max(heights_.max, piece.z.max);
    }
  }

  Vec2 AnyPlace() {
    const double x = random_.Uniform(bounds_.min_x - 1.0, bounds_.max_x + 1.0);
    return {x, random_.Uniform(bounds_.min_y - 1.0, bounds_.max_y + 1.0)};
  }

  Ray AnyRay() {
    Ray ray{AnyPlace(), Vec2::Zero(), random_.Uniform(heights_.min, heights_.max), random_.Uniform(0.0, 40.0), {}};
    if (!state_.robots.empty() && random_.Chance(0.3)) ray.caster = RobotId(random_.Index(state_.robots.size()));
    return Turned(ray);
  }

  Ray Turned(Ray ray) {
    const SinCosResult trig = SinCos(random_.Angle());
    ray.direction = {trig.cos, trig.sin};
    return ray;
  }

  std::vector<Ray> SensorRays() const {
    std::vector<Ray> rays;
    const WorldDescription& world = scene_.world();
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      for (const SensorDescription& ranger : world.robots[i].sensors) {
        for (const RaySensorDescription& sensor : RaySensors(ranger)) {
          const Pose X_WS = bodies_.X_WM(ranger.model) * sensor.X_MS;
          rays.push_back({X_WS.translation(), Vec2::Zero(), X_WS.z, sensor.range.max, RobotId(i)});
        }
      }
    }
    return rays;
  }

  void Check(const Ray& ray, const std::optional<RayHit>& hit, const std::vector<BruteForceHit>& expected) {
    const std::string where = "from (" + std::to_string(ray.origin.x()) + ", " + std::to_string(ray.origin.y()) + ", " +
                              std::to_string(ray.z) + ") towards (" + std::to_string(ray.direction.x()) + ", " +
                              std::to_string(ray.direction.y()) + ")";
    ASSERT_EQ(hit.has_value(), !expected.empty()) << where;
    if (!hit) return;
    ++hits_;
    const BruteForceHit nearest = BruteForceRays::Nearest(expected);
    ASSERT_NEAR(hit->distance, static_cast<double>(nearest.distance), 1e-9) << where;
  }

  Scene scene_;
  WorldState state_;
  BodyIndex bodies_;
  RandomStream random_;
  Rectangle bounds_ = Rectangle::Nothing();
  ZRange heights_{0.0, 0.5};
  int hits_ = 0;
};

void CompareIn(const std::string& path) {
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path << "; for Stage's worlds set TROUPE_STAGE_WORLDS";
  const Result<LoadedWorld> loaded = LoadWorld(path);
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  WorldRays rays(loaded.value().world, 1);
  rays.Compare();
  rays.Shuffle();
  rays.Compare();
  EXPECT_GT(rays.hits(), kRays / 100) << "too few rays have a hit";
}

class StageWorldRays : public testing::TestWithParam<const char*> {};

TEST_P(StageWorldRays, AgreeWithBruteForce) {
  CompareIn(test::StageWorldsFolder() + "/" + GetParam());
}

INSTANTIATE_TEST_SUITE_P(Worlds, StageWorldRays,
                         testing::Values("simple.world", "benchmark/cave.world", "uoa_robotics_lab.world"));

class OwnWorldRays : public testing::TestWithParam<const char*> {};

TEST_P(OwnWorldRays, AgreeWithBruteForce) {
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  CompareIn(std::string(source != nullptr ? source : ".") + "/worlds/" + GetParam());
}

INSTANTIATE_TEST_SUITE_P(Worlds, OwnWorldRays,
                         testing::Values("office.world", "scenarios/demo.json", "scenarios/swarm.json",
                                         "scenarios/under_table.json", "scenarios/lab.json", "scenarios/marina.json",
                                         "scenarios/relay.json", "scenarios/stacking.json"));

}  // namespace
}  // namespace troupe
