// Every kind of sensor against an independent computation over random worlds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/sensing/contact.h"
#include "tests/support/distance_to_edge.h"
#include "tests/support/exact_prisms.h"
#include "tests/support/random_world.h"
#include "tests/support/sensor_worlds.h"

namespace troupe::test {
namespace {

constexpr double kHalfWidth = 8.0;
constexpr std::size_t kModels = 14;
constexpr std::size_t kRobots = 6;

WorldDescription Scenery(std::uint64_t seed) {
  WorldDescription world = RandomWorld(seed, kHalfWidth, kModels, kRobots);
  RandomStream random(seed + 1'000'000);
  for (ModelDescription& model : world.models) {
    model.fiducial_return = random.Chance(0.5) ? static_cast<std::int32_t>(1 + random.Index(9)) : 0;
    model.fiducial_key = random.Chance(0.3) ? 7 : 0;
    const double shades[] = {0.0, 0.5, 1.0};
    model.color = {shades[random.Index(3)], shades[random.Index(2)], 0.0, 1.0};
  }
  return world;
}

Pose SensorPose(RandomStream& random) {
  return {random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.1), random.Uniform(0.05, 1.2), random.Angle()};
}

bool IsOfRobot(const WorldDescription& world, ModelId model, RobotId robot) {
  return IsInTree(world, model, world.robot(robot).root);
}

Pose PoseIn(const SensedScene& sensed, ModelId model) {
  return ModelPoses(sensed.scene().world(), sensed.state())[model.index()];
}

struct Mounted {
  SensedScene sensed;
  RobotId robot;
  std::size_t sensor;
  Pose X_WS;
};

// A sensor on a random robot of a random world; nothing if the world has no robot.
std::optional<Mounted> Mount(std::uint64_t seed, SensorParameters parameters, RandomStream& random) {
  WorldDescription world = Scenery(seed);
  if (world.robots.empty()) return std::nullopt;
  const RobotId robot(random.Index(world.robots.size()));
  const std::size_t sensor = AddSensor(world, robot, SensorPose(random), std::move(parameters));
  const ModelId model = world.robots[robot.index()].sensors[sensor].model;
  SensedScene sensed(std::move(world));
  const Pose X_WS = PoseIn(sensed, model);
  return Mounted{std::move(sensed), robot, sensor, X_WS};
}

TEST(SensorsProperty, EveryPixelOfACameraIsTheNearestOfAllBlocks) {
  std::size_t compared = 0;
  std::size_t bodies = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    RandomStream random(seed);
    CameraParameters camera{.width = 1 + static_cast<std::uint32_t>(random.Index(24)),
                            .height = 1 + static_cast<std::uint32_t>(random.Index(24)),
                            .fov = random.Uniform(0.2, 2.4)};
    const double low = random.Chance(0.3) ? random.Uniform(-1.3, 1.0) : random.Uniform(-0.5, 0.1);
    camera.elevation = {low, low + random.Uniform(0.05, 0.3)};
    camera.range = {random.Uniform(0.0, 0.5), random.Uniform(2.0, 12.0)};
    const auto mounted = Mount(seed, camera, random);
    if (!mounted) continue;
    const auto& [sensed, robot, sensor, X_WS] = *mounted;
    const WorldDescription& world = sensed.scene().world();
    const BruteForcePrisms prisms(world, sensed.state(),
                                  [&, own = robot](ModelId model) { return !IsOfRobot(world, model, own); });
    const CameraReading reading = sensed.MeasureAs<CameraReading>(robot, sensor);
    const Vec2 ahead(std::cos(X_WS.heading), std::sin(X_WS.heading));
    const Vec2 left(-ahead.y(), ahead.x());
    const double high_slope = std::tan(camera.elevation.max);
    const double low_slope = std::tan(camera.elevation.min);
    for (std::uint32_t y = 0; y < camera.height; ++y) {
      for (std::uint32_t x = 0; x < camera.width; ++x) {
        const double aside = std::tan(0.5 * camera.fov) * (1.0 - 2.0 * (x + 0.5) / camera.width);
        const double up = high_slope + (low_slope - high_slope) * (y + 0.5) / camera.height;
        // The same through the reading's focal lengths and principal point.
        EXPECT_NEAR(aside, (reading.center_x - (x + 0.5)) / reading.focal_length_x, 1e-9);
        EXPECT_NEAR(up, (reading.center_y - (y + 0.5)) / reading.focal_length_y, 1e-9);
        const SpaceRay ray{X_WS.translation(), X_WS.z, ahead + aside * left, up};
        const std::optional<PrismHit> hit = prisms.Cast(ray, camera.range.max);
        const std::size_t place = std::size_t{y} * camera.width + x;
        std::int32_t model = CameraReading::kNothing;
        double depth = std::numeric_limits<double>::infinity();
        if (up < 0.0 && X_WS.z > 0.0 && -X_WS.z / up <= camera.range.max) {
          model = CameraReading::kGround;
          depth = -X_WS.z / up;
        }
        if (hit && hit->distance <= depth) {
          model = static_cast<std::int32_t>(hit->model.index());
          depth = static_cast<double>(hit->distance);
        }
        const bool near_limit = std::abs(depth - camera.range.max) < 1e-6 || std::abs(depth - camera.range.min) < 1e-6;
        if (near_limit || prisms.IsOnEdge(ray, camera.range.max)) continue;
        ++compared;
        bodies += model >= 0 ? 1 : 0;
        ASSERT_EQ(reading.models[place], model) << "seed " << seed << ", pixel " << x << ' ' << y;
        if (depth < camera.range.min) depth = -std::numeric_limits<double>::infinity();
        ASSERT_FLOAT_EQ(reading.depths[place], static_cast<float>(depth)) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(compared, 4000u);
  EXPECT_GT(bodies, 500u);
}

TEST(SensorsProperty, EveryRayOfAScannerOfSeveralPlanesIsTheNearestOfAllBlocks) {
  std::size_t hits = 0;
  for (std::uint64_t seed = 100; seed < 200; ++seed) {
    RandomStream random(seed);
    RaySensorDescription scanner{.range = {0.0, random.Uniform(2.0, 12.0)},
                                 .fov = random.Uniform(0.5, 6.2),
                                 .samples = 2 + static_cast<std::uint32_t>(random.Index(40))};
    double elevation = random.Chance(0.3) ? random.Uniform(-1.2, 0.0) : random.Uniform(-0.3, 0.0);
    const std::size_t planes = 1 + random.Index(8);
    for (std::size_t i = 0; i < planes; ++i) {
      scanner.elevations.push_back(elevation);
      elevation += random.Uniform(0.01, 0.2);
    }
    const auto mounted = Mount(seed, RangerParameters{{scanner}}, random);
    if (!mounted) continue;
    const auto& [sensed, robot, sensor, X_WS] = *mounted;
    const WorldDescription& world = sensed.scene().world();
    const BruteForcePrisms prisms(world, sensed.state(), [&, own = robot](ModelId model) {
      return !IsOfRobot(world, model, own) && world.model(model).ranger_return >= 0.0;
    });
    const RangeScan scan = sensed.MeasureAs<RangerReading>(robot, sensor).scan(0);
    ASSERT_EQ(scan.ranges.size(), planes * scanner.samples);
    for (std::size_t plane = 0; plane < planes; ++plane) {
      const double slope_angle = scanner.elevations[plane];
      for (std::size_t i = 0; i < scanner.samples; ++i) {
        const double bearing = X_WS.heading + scan.fan.Bearing(i);
        const SpaceRay ray{X_WS.translation(), X_WS.z,
                           std::cos(slope_angle) * Vec2(std::cos(bearing), std::sin(bearing)), std::sin(slope_angle)};
        const std::optional<PrismHit> hit = prisms.Cast(ray, scanner.range.max);
        double range = scanner.range.max;
        double intensity = 0.0;
        if (ray.climb < 0.0 && -X_WS.z / ray.climb < range) {
          range = -X_WS.z / ray.climb;
          intensity = 1.0;
        }
        if (hit && hit->distance <= range) {
          range = static_cast<double>(hit->distance);
          intensity = world.model(hit->model).ranger_return;
          ++hits;
        }
        if (std::abs(range - scanner.range.max) < 1e-6 || prisms.IsOnEdge(ray, scanner.range.max)) continue;
        const std::size_t place = plane * scanner.samples + i;
        ASSERT_NEAR(scan.ranges[place], range, 1e-9) << "seed " << seed << ", plane " << plane << ", ray " << i;
        ASSERT_EQ(scan.intensities[place], intensity);
      }
    }
  }
  EXPECT_GT(hits, 150u);
}

TEST(SensorsProperty, APlaneWithoutElevationReadsAsAFlatScanner) {
  for (std::uint64_t seed = 200; seed < 260; ++seed) {
    RandomStream random(seed);
    RaySensorDescription flat{.range = {0.0, 9.0}, .fov = 6.0, .samples = 90};
    RaySensorDescription planes = flat;
    planes.elevations = {-0.2, 0.0, 0.2};
    const auto mounted = Mount(seed, RangerParameters{{flat, planes, flat}}, random);
    if (!mounted) continue;
    const RangerReading reading = mounted->sensed.MeasureAs<RangerReading>(mounted->robot, mounted->sensor);
    EXPECT_EQ(reading.scan(0), reading.scan(2));
    for (std::size_t i = 0; i < flat.samples; ++i) {
      EXPECT_NEAR(reading.scan(1).ranges[flat.samples + i], reading.scan(0).ranges[i], 1e-9);
    }
  }
}

TEST(SensorsProperty, AFiducialFinderFindsAllModelsInSight) {
  std::size_t found = 0;
  std::size_t hidden = 0;
  for (std::uint64_t seed = 300; seed < 500; ++seed) {
    RandomStream random(seed);
    FiducialParameters finder{.range = {random.Chance(0.5) ? 0.0 : 1.0, random.Uniform(2.0, 12.0)},
                              .id_range = random.Uniform(1.0, 8.0),
                              .fov = random.Uniform(0.5, 2.0 * kPi),
                              .key = random.Chance(0.3) ? 7 : 0,
                              .ignores_height = random.Chance(0.4)};
    const auto mounted = Mount(seed, finder, random);
    if (!mounted) continue;
    const auto& [sensed, robot, sensor, X_WS] = *mounted;
    const WorldDescription& world = sensed.scene().world();
    const BruteForcePrisms prisms(world, sensed.state(),
                                  [&, own = robot](ModelId model) { return !IsOfRobot(world, model, own); });
    std::map<ModelId, Fiducial> seen;
    for (const Fiducial& fiducial : sensed.MeasureAs<FiducialReading>(robot, sensor).fiducials) {
      seen.emplace(fiducial.model, fiducial);
    }
    for (std::size_t i = 0; i < world.models.size(); ++i) {
      const ModelDescription& model = world.models[i];
      const Pose X_WF = PoseIn(sensed, ModelId(i));
      const Vec2 way = X_WF.translation() - X_WS.translation();
      const double range = way.norm();
      const double bearing = std::remainder(std::atan2(way.y(), way.x()) - X_WS.heading, 2.0 * kPi);
      const SpaceRay ray{X_WS.translation(), X_WS.z, way / range, 0.0};
      if (prisms.IsOnEdge(ray, finder.range.max)) {
        seen.erase(ModelId(i));
        continue;
      }
      const std::optional<PrismHit> hit = prisms.Cast(ray, finder.range.max);
      const bool hits_it = hit && IsInTree(world, hit->model, ModelId(i));
      const bool in_sight = hits_it || (finder.ignores_height && (!hit || hit->distance > range));
      const bool in_view = model.fiducial_return != 0 && model.fiducial_key == finder.key &&
                           !IsOfRobot(world, ModelId(i), robot) && range >= finder.range.min &&
                           range <= finder.range.max && std::abs(bearing) <= 0.5 * finder.fov;
      ASSERT_EQ(seen.contains(ModelId(i)), in_view && in_sight) << "seed " << seed << ", model " << i;
      hidden += in_view && !in_sight ? 1 : 0;
      if (!seen.contains(ModelId(i))) continue;
      ++found;
      const Fiducial& fiducial = seen.at(ModelId(i));
      EXPECT_NEAR(fiducial.range, range, 1e-9);
      EXPECT_NEAR(std::remainder(fiducial.bearing - bearing, 2.0 * kPi), 0.0, 1e-9);
      EXPECT_EQ(fiducial.id, range <= finder.id_range ? model.fiducial_return : 0);
      EXPECT_NEAR(std::remainder(fiducial.X_SF.heading + X_WS.heading - X_WF.heading, 2.0 * kPi), 0.0, 1e-9);
      EXPECT_NEAR(fiducial.X_SF.z, X_WF.z - X_WS.z, 1e-9);
    }
  }
  EXPECT_GT(found, 100u);
  EXPECT_GT(hidden, 100u);
}

TEST(SensorsProperty, ABlobfinderSeesTheColorOfEachColumn) {
  std::size_t colored = 0;
  for (std::uint64_t seed = 600; seed < 900; ++seed) {
    RandomStream random(seed);
    BlobfinderParameters finder{.width = 1 + static_cast<std::uint32_t>(random.Index(60)),
                                .height = 40,
                                .range = random.Uniform(2.0, 12.0),
                                .fov = random.Uniform(0.2, 2.5)};
    if (random.Chance(0.5)) finder.colors = {{0.0, 0.0, 0.0, 1.0}, {1.0, 0.5, 0.0, 1.0}, {0.5, 0.0, 0.0, 1.0}};
    const auto mounted = Mount(seed, finder, random);
    if (!mounted) continue;
    const auto& [sensed, robot, sensor, X_WS] = *mounted;
    const WorldDescription& world = sensed.scene().world();
    const BruteForcePrisms prisms(world, sensed.state(),
                                  [&, own = robot](ModelId model) { return !IsOfRobot(world, model, own); });
    const BlobfinderReading reading = sensed.MeasureAs<BlobfinderReading>(robot, sensor);
    std::vector<const Blob*> blob_of(finder.width, nullptr);
    std::uint32_t last = 0;
    for (const Blob& blob : reading.blobs) {
      ASSERT_LT(blob.left, blob.right);
      ASSERT_LE(last, blob.left);
      ASSERT_LE(blob.top, blob.bottom);
      for (std::uint32_t x = blob.left; x < blob.right; ++x) blob_of.at(x) = &blob;
      last = blob.right;
    }
    for (std::uint32_t x = 0; x < finder.width; ++x) {
      const double bearing = X_WS.heading + finder.fov * (0.5 - (x + 0.5) / finder.width);
      const SpaceRay ray{X_WS.translation(), X_WS.z, {std::cos(bearing), std::sin(bearing)}, 0.0};
      if (prisms.IsOnEdge(ray, finder.range)) continue;
      const std::optional<PrismHit> hit = prisms.Cast(ray, finder.range);
      const Color* color = hit ? &world.model(hit->model).color : nullptr;
      if (color != nullptr && !finder.colors.empty() &&
          std::find(finder.colors.begin(), finder.colors.end(), *color) == finder.colors.end()) {
        color = nullptr;
      }
      ASSERT_EQ(blob_of[x] != nullptr, color != nullptr) << "seed " << seed << ", column " << x;
      if (color == nullptr) continue;
      ++colored;
      EXPECT_EQ(blob_of[x]->color, *color);
      EXPECT_LE(blob_of[x]->range, static_cast<double>(hit->distance) + 1e-9);
    }
  }
  EXPECT_GT(colored, 250u);
}

// The distance of two outlines by points along their edges: never less than the true one, and at most a step more.
double SampledDistance(const Polygon& a, const Polygon& b, double step) {
  double least = std::numeric_limits<double>::infinity();
  const auto samples = [step](const Polygon& polygon) {
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 along = polygon[(i + 1) % polygon.size()] - polygon[i];
      const int count = 1 + static_cast<int>(along.norm() / step);
      for (int k = 0; k < count; ++k) points.emplace_back(polygon[i] + along * (static_cast<double>(k) / count));
    }
    return points;
  };
  const std::vector<Vec2> of_b = samples(b);
  for (const Vec2& p : samples(a)) {
    for (const Vec2& q : of_b) least = std::min(least, (p - q).norm());
  }
  return least;
}

TEST(SensorsProperty, NearestPointsAreAsNearAsSampledOnes) {
  RandomStream random(77);
  std::size_t apart = 0;
  for (int i = 0; i < 300; ++i) {
    Polygon a = RandomConvex(random, 0.1, 0.6);
    Polygon b = RandomConvex(random, 0.1, 0.6);
    if (random.Chance(0.3)) a.resize(2);
    const double far = random.Chance(0.2) ? 30.0 : 1.0;
    const Vec2 shift(far * random.Uniform(-1.5, 1.5), far * random.Uniform(-1.5, 1.5));
    for (Vec2& vertex : b) vertex += shift;
    const NearestPoints nearest = FindNearestPoints(a, b);
    EXPECT_NEAR((nearest.a - nearest.b).norm(), nearest.distance, 1e-12);
    if (nearest.distance == 0.0) continue;
    ++apart;
    // Of all pairs of a vertex and an edge: none that counts is passed over.
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < a.size(); ++k) {
      for (std::size_t m = 0; m < b.size(); ++m) {
        least = std::min(least, DistanceToEdge(a[k], b[m], b[(m + 1) % b.size()]));
        least = std::min(least, DistanceToEdge(b[m], a[k], a[(k + 1) % a.size()]));
      }
    }
    EXPECT_NEAR(nearest.distance, least, 1e-12);
    const double sampled = SampledDistance(a, b, 0.01);
    EXPECT_LE(nearest.distance, sampled + 1e-9);
    EXPECT_GE(nearest.distance, sampled - 0.011);
    const NearestPoints swapped = FindNearestPoints(b, a);
    EXPECT_EQ(swapped.distance, nearest.distance);
  }
  EXPECT_GT(apart, 100u);
}

}  // namespace
}  // namespace troupe::test
