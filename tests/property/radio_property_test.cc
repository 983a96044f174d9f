// Radios against an independent computation over random worlds: every sender and receiver, through every block.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "tests/support/exact_prisms.h"
#include "tests/support/random_world.h"
#include "tests/support/sensor_worlds.h"

namespace troupe::test {
namespace {

constexpr double kRounding = 1e-7;  // m: closer than this, rounding decides
constexpr double kWallGap = 0.05;   // m, as documented

struct Obstacles {
  std::size_t walls = 0;
  std::size_t bodies = 0;
};

bool BelongsTo(const WorldDescription& world, ModelId model, RobotId robot) {
  return IsInTree(world, model, world.robot(robot).root);
}

// Nothing where rounding decides.
std::optional<Obstacles> ObstaclesBetween(const SensedScene& sensed, RobotId a, RobotId b, const Pose& X_WA,
                                          const Pose& X_WB) {
  const WorldDescription& world = sensed.scene().world();
  const BruteForcePrisms prisms(world, sensed.state(), [&](ModelId model) {
    return world.model(model).ranger_return >= 0.0 && !BelongsTo(world, model, a) && !BelongsTo(world, model, b);
  });
  const Vec2 way = X_WB.translation() - X_WA.translation();
  const double length = way.norm();
  const SpaceRay ray{X_WA.translation(), X_WA.z, way / length, (X_WB.z - X_WA.z) / length};
  // Another ray beside it has the same obstacles, but where rounding decides.
  const auto count = [&](const SpaceRay& line) -> std::optional<Obstacles> {
    std::vector<BruteForcePrisms::Stretch> walls;
    std::set<std::size_t> robots;
    for (const BruteForcePrisms::Stretch& stretch : prisms.Stretches(line, length)) {
      std::optional<RobotId> robot;
      for (std::size_t i = 0; i < world.robots.size(); ++i) {
        if (BelongsTo(world, stretch.model, RobotId(i))) robot = RobotId(i);
      }
      if (robot) {
        robots.insert(robot->index());
      } else {
        walls.push_back(stretch);
      }
    }
    std::sort(walls.begin(), walls.end(), [](const auto& x, const auto& y) { return x.enter < y.enter; });
    Obstacles obstacles{0, robots.size()};
    long double end = -1.0L;
    for (const BruteForcePrisms::Stretch& wall : walls) {
      const long double gap = end < 0.0L ? 1.0L : wall.enter - end;
      if (std::abs(gap - kWallGap) < kRounding) return std::nullopt;
      if (gap > kWallGap) ++obstacles.walls;
      end = std::max(end, wall.leave);
    }
    return obstacles;
  };
  const std::optional<Obstacles> straight = count(ray);
  for (const double aside : {-kRounding, kRounding}) {
    for (const double up : {-kRounding, kRounding}) {
      SpaceRay other = ray;
      other.origin += aside * Vec2(-ray.direction.y(), ray.direction.x());
      other.z += up;
      const std::optional<Obstacles> beside = count(other);
      if (!straight || !beside || beside->walls != straight->walls || beside->bodies != straight->bodies) {
        return std::nullopt;
      }
    }
  }
  return straight;
}

TEST(RadioProperty, EveryMessageArrivesAsStronglyAsGeometrySays) {
  std::size_t received = 0;
  std::size_t attenuated = 0;
  std::size_t lost = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    RandomStream random(seed);
    WorldDescription world = RandomWorld(seed, 8.0, 14, 6);
    std::vector<Pose> X_RS;
    std::vector<RadioParameters> radios;
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      RadioParameters radio{.range = random.Uniform(4.0, 30.0),
                            .power = random.Uniform(-10.0, 30.0),
                            .path_loss_exponent = random.Uniform(1.5, 4.0),
                            .wall_loss = random.Uniform(0.0, 12.0),
                            .body_loss = random.Uniform(0.0, 6.0),
                            .range_and_bearing = true};
      radios.push_back(radio);
      const double height = random.Chance(0.5) ? 0.6 : random.Uniform(0.05, 1.2);
      X_RS.push_back({random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.1), height, random.Angle()});
      AddSensor(world, RobotId(i), X_RS.back(), radio);
    }
    WorldState state = PlacedState(world);
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      state.transmissions.push_back({.from = RobotId(i), .message = {.radio = 0, .bytes = {1}}});
    }
    const std::vector<RobotState> robots = state.robots;
    const SensedScene sensed(world, state);
    for (std::size_t to = 0; to < robots.size(); ++to) {
      const RadioReading reading = sensed.MeasureAs<RadioReading>(RobotId(to), 0);
      const Pose X_WS = robots[to].X_WR * X_RS[to];
      for (std::size_t from = 0; from < robots.size(); ++from) {
        const auto found = std::find_if(reading.receptions.begin(), reading.receptions.end(),
                                        [&](const RadioReception& r) { return r.from == RobotId(from); });
        const bool hears = found != reading.receptions.end();
        if (from == to) {
          EXPECT_FALSE(hears);
          continue;
        }
        const Pose X_WT = robots[from].X_WR * X_RS[from];
        const auto obstacles = ObstaclesBetween(sensed, RobotId(to), RobotId(from), X_WS, X_WT);
        if (!obstacles) continue;
        const RadioParameters& radio = radios[from];
        const double across = (X_WT.translation() - X_WS.translation()).norm();
        const double distance = std::hypot(across, X_WT.z - X_WS.z);
        const double loss = radio.wall_loss * static_cast<double>(obstacles->walls) +
                            radio.body_loss * static_cast<double>(obstacles->bodies);
        const double n = 10.0 * radio.path_loss_exponent;
        const double margin = n * std::log10(radio.range / distance) - loss;
        if (std::abs(margin) < 1e-6) continue;
        ASSERT_EQ(hears, margin > 0.0) << "seed " << seed << ", from " << from << " to " << to;
        if (!hears) {
          ++lost;
          continue;
        }
        ++received;
        if (loss > 0.0) ++attenuated;
        EXPECT_NEAR(found->rssi, radio.power - n * std::log10(distance) - loss, 1e-9);
        ASSERT_TRUE(found->place);
        EXPECT_NEAR(found->place->range, distance, 1e-9);
        const Vec2 way = X_WT.translation() - X_WS.translation();
        EXPECT_NEAR(std::remainder(found->place->bearing - (std::atan2(way.y(), way.x()) - X_WS.heading), 2.0 * kPi),
                    0.0, 1e-9);
        EXPECT_NEAR(found->place->elevation, std::atan2(X_WT.z - X_WS.z, across), 1e-9);
      }
    }
  }
  EXPECT_GT(received, 300u);
  EXPECT_GT(attenuated, 100u);
  EXPECT_GT(lost, 100u);
}

}  // namespace
}  // namespace troupe::test
