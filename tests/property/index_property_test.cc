// Index queries compared with brute force.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/occupancy_grid.h"
#include "common/spatial/ray_cast.h"
#include "common/spatial/sweep.h"
#include "tests/support/random_world.h"

namespace troupe {
namespace {

using test::RandomStream;

Rectangle RandomBox(RandomStream& random, double half_width) {
  const double x = random.Uniform(-1.5, 1.5) * half_width;
  const double y = random.Uniform(-1.5, 1.5) * half_width;
  const double size = random.Chance(0.2) ? 0.0 : random.Uniform(0.0, half_width);
  return {x, y, x + size, y + random.Uniform(0.0, 1.0) * size};
}

TEST(StaticIndexProperty, QueryFindsExactlyThePiecesWhoseBoxesOverlap) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    RandomStream random(seed + 4'000'000);
    const double half_width = random.Uniform(0.5, 30.0);
    const Scene scene(test::RandomWorld(seed, half_width, random.Index(60), 0));
    const StaticIndex& index = scene.static_index();
    for (int query = 0; query < 20; ++query) {
      const Rectangle box = RandomBox(random, half_width);
      std::vector<const ConvexPiece*> expected;
      for (const ConvexPiece& piece : index.kept_pieces()) {
        if (BoundingBox(piece.vertices).Overlaps(box)) expected.push_back(&piece);
      }
      NearPieces found;
      index.Query(box, found);
      ASSERT_EQ(std::vector(found.begin(), found.end()), expected) << "seed " << seed << " query " << query;
    }
  }
}

TEST(BodyIndexProperty, QueryMissesNoRobotWhileTheyMove) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    RandomStream random(seed + 5'000'000);
    double half_width = random.Uniform(2.0, 30.0);
    test::TestWorld test;
    // A few are tested one by one, many are in a grid.
    const std::size_t count = seed % 3 == 0 ? 257 + random.Index(100) : 1 + random.Index(80);
    for (std::size_t i = 0; i < count; ++i) {
      test.AddRobot(test::RandomStar(random, Vec2::Zero(), 0.1, 0.4), {0.0, 1.0}, RandomPose(random, half_width));
    }
    const Scene scene(test.world);
    WorldState state = PlacedState(scene.world());
    BodyIndex index(scene);
    for (int round = 0; round < 12; ++round) {
      index.Assign(state);
      for (int query = 0; query < 10; ++query) {
        if (random.Chance(0.5)) {
          const BodyId body(random.Index(state.robots.size()));
          state.robots[body.index()].X_WR = RandomPose(random, half_width);
          index.Move(body, state.robots[body.index()].X_WR);
        }
        const Rectangle box = RandomBox(random, half_width);
        std::pmr::vector<BodyId> found;
        index.Query(box, found);
        ASSERT_TRUE(std::is_sorted(found.begin(), found.end()));
        ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
        for (std::size_t i = 0; i < state.robots.size(); ++i) {
          const BodyId body(i);
          Rectangle bounds = Rectangle::Nothing();
          for (const ConvexPiece& piece : scene.body(body).pieces) {
            const ConvexPiece in_world = Transformed(piece, state.robots[i].X_WR);
            bounds.Extend(BoundingBox(in_world.vertices));
          }
          const bool is_found = std::binary_search(found.begin(), found.end(), body);
          if (bounds.Overlaps(box)) {
            ASSERT_TRUE(is_found) << "seed " << seed;
          }
          if (!bounds.Inflated(2.0 * scene.max_body_radius() + 1e-6).Overlaps(box)) {
            ASSERT_FALSE(is_found) << "seed " << seed << ": far away";
          }
        }
      }
      // They huddle, or spread out.
      half_width *= random.Uniform(0.2, 3.0);
      for (RobotState& robot : state.robots) {
        if (random.Chance(0.7)) robot.X_WR = RandomPose(random, half_width);
      }
    }
  }
}

TEST(BodyIndexProperty, PiecesInWorldFollowTheRobot) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    RandomStream random(seed + 6'000'000);
    const Scene scene(test::RandomWorld(seed, 10.0, 0, 5));
    WorldState state = PlacedState(scene.world());
    BodyIndex index(scene);
    index.Assign(state);
    for (int round = 0; round < 20; ++round) {
      const BodyId body(random.Index(state.robots.size()));
      if (random.Chance(0.7)) {
        state.robots[body.index()].X_WR = RandomPose(random, 10.0);
        state.robots[body.index()].X_WR.z = random.Uniform(0.0, 1.0);
        if (random.Chance(0.5)) {
          index.Assign(state);
        } else {
          index.Move(body, state.robots[body.index()].X_WR);
        }
      }
      ASSERT_EQ(index.X_WB(body), state.robots[body.index()].X_WR);
      const std::vector<ConvexPiece>& pieces = index.pieces_in_world(body);
      ASSERT_EQ(pieces.size(), scene.body(body).pieces.size());
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        const ConvexPiece expected = Transformed(scene.body(body).pieces[i], state.robots[body.index()].X_WR);
        ASSERT_EQ(pieces[i].vertices, expected.vertices);
        ASSERT_EQ(pieces[i].z, expected.z);
      }
    }
  }
}

// Worlds with the area of a bitmap, compared bit by bit with worlds that have a list of its rectangles.

Bitmap RandomBitmap(RandomStream& random) {
  const int width = 1 + static_cast<int>(random.Index(random.Chance(0.1) ? 300 : 70));
  const int height = 1 + static_cast<int>(random.Index(70));
  const std::size_t kind = random.Index(4);
  const int side = kind == 2 ? 1 + static_cast<int>(random.Index(9)) : 1;
  const double share = random.Chance(0.5) ? 0.5 : random.Uniform(0.05, 0.95);
  const std::uint64_t seed = random.Index(1'000'000);
  const int step = 1 + static_cast<int>(random.Index(3));
  Bitmap bitmap(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto cell = [](int i) { return static_cast<std::uint64_t>(i); };
      const bool checkerboard = (x / step + y / step) % 2 == 0;
      const bool noise = RandomUniform({seed, cell(x / side), cell(y / side)}) < share;
      // The last kind is a checkerboard beside a free or full half.
      const bool half = x < width / 2 ? checkerboard : share < 0.5;
      bitmap.set_occupied(x, y, kind == 0 ? checkerboard : kind == 3 ? half : noise);
    }
  }
  bitmap.set_occupied(0, 0, true);  // an area has a pixel
  return bitmap;
}

PixelArea RandomArea(RandomStream& random) {
  const auto cover = std::make_shared<const DenseCover>(RandomBitmap(random));
  const double width = cover->bitmap().width();
  const double height = cover->bitmap().height();
  const double pixel = random.Uniform(0.02, 0.2);
  const double stretch = random.Chance(0.5) ? 1.0 : random.Uniform(0.3, 3.0);
  if (random.Chance(0.4)) {
    const PixelLines lines{.factor = pixel};
    return PixelArea(cover, lines, lines).Moved({0.0, 0.0, 0.0, 0.0});
  }
  PixelArea area = PixelArea(cover, {}, {}).Stretched({0.5 * width, 0.5 * height}, {pixel, pixel * stretch});
  if (random.Chance(0.3)) area = area.Stretched({0.1, -0.2}, {0.9, 1.0});
  const double heading = random.Chance(0.4) ? random.Angle() : 0.0;
  return area.Moved({random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3), 0.0, heading});
}

Pose RandomPlace(RandomStream& random, double reach) {
  Pose pose = RandomPose(random, reach);
  if (random.Chance(0.4)) pose.heading = 0.0;
  pose.z = random.Uniform(0.0, 0.2);
  return pose;
}

// The same world twice: with areas, and with lists.
class Worlds {
 public:
  explicit Worlds(std::uint64_t seed)
      : random_(seed), dense_(MakeWorld()), listed_(WithLists(dense_.world())), state_(PlacedState(dense_.world())) {}

  RandomStream& random() { return random_; }
  const Scene& dense() const { return dense_; }
  const Scene& listed() const { return listed_; }
  const WorldState& state() const { return state_; }
  Vec2 Place() { return {random_.Uniform(-kReach, kReach), random_.Uniform(-kReach, kReach)}; }

 private:
  static constexpr double kReach = 4.0;  // m

  WorldDescription MakeWorld() {
    WorldDescription world = test::RandomWorld(random_.Index(1'000'000), kReach, 2, 3);
    const std::size_t count = 1 + random_.Index(2);
    for (std::size_t i = 0; i < count; ++i) {
      test::TestWorld map;
      std::vector<Block> blocks;
      if (random_.Chance(0.3)) blocks.push_back({test::Box(-1.0, -1.0, 1.0, -0.9), {0.0, 1.0}});
      map.AddModel(std::move(blocks), RandomPlace(random_, 1.0));
      ModelDescription& model = map.world.models.back();
      model.name = "map" + std::to_string(i);
      model.shape = ShapeId(world.shapes.size());
      model.ranger_return = random_.Chance(0.1) ? -1.0 : 1.0;
      model.obstacle_return = !random_.Chance(0.1);
      Shape shape = map.world.shapes.back();
      shape.area = RandomArea(random_);
      shape.rectangles_z = random_.Chance(0.05) ? ZRange{0.5, 0.5} : ZRange{0.0, random_.Uniform(0.5, 1.5)};
      world.shapes.push_back(std::move(shape));
      world.models.push_back(model);
    }
    EXPECT_TRUE(Validate(world).ok()) << Validate(world).error().message;
    return world;
  }
  static WorldDescription WithLists(WorldDescription world) {
    for (Shape& shape : world.shapes) shape = Listed(std::move(shape));
    return world;
  }

  RandomStream random_;
  Scene dense_;
  Scene listed_;
  WorldState state_;
};

void ExpectSameHit(const std::optional<RayHit>& dense, const std::optional<RayHit>& listed, std::uint64_t seed) {
  ASSERT_EQ(dense.has_value(), listed.has_value()) << "seed " << seed;
  if (!dense) return;
  ASSERT_EQ(dense->distance, listed->distance) << "seed " << seed;
  ASSERT_EQ(dense->model, listed->model) << "seed " << seed;
}

TEST(PixelPiecesProperty, HashIsThatOfTheList) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Worlds worlds(seed);
    EXPECT_EQ(Hash(worlds.dense().world()), Hash(worlds.listed().world())) << "seed " << seed;
  }
}

TEST(PixelPiecesProperty, RangesAreThoseOfTheList) {
  int hits = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Worlds worlds(seed + 1000);
    RandomStream& random = worlds.random();
    BodyIndex dense_bodies(worlds.dense());
    BodyIndex listed_bodies(worlds.listed());
    dense_bodies.Assign(worlds.state());
    listed_bodies.Assign(worlds.state());
    std::vector<Vec2> corners;
    worlds.dense().static_index().ForEachPiece([&](const ConvexPiece& piece) {
      if (corners.size() < 500) corners.insert(corners.end(), piece.vertices.begin(), piece.vertices.end());
    });
    for (int i = 0; i < 300; ++i) {
      Vec2 origin = worlds.Place();
      Vec2 target = worlds.Place();
      // To, from and along the corners of pieces.
      if (random.Chance(0.3)) target = corners[random.Index(corners.size())];
      if (random.Chance(0.1)) origin = corners[random.Index(corners.size())];
      if (random.Chance(0.1)) target = {target.x(), origin.y()};
      if (random.Chance(0.1)) target = {origin.x(), target.y()};
      if ((target - origin).norm() < 1e-12) continue;
      const Ray ray{origin, (target - origin).normalized(), random.Uniform(0.0, 1.5), random.Uniform(0.0, 12.0)};
      const std::optional<RayHit> hit = CastRay(worlds.dense(), dense_bodies, ray, std::nullopt);
      ASSERT_NO_FATAL_FAILURE(
          ExpectSameHit(hit, CastRay(worlds.listed(), listed_bodies, ray, std::nullopt), seed + 1000));
      hits += hit ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 5'000);
}

TEST(PixelPiecesProperty, QueriesFindThePiecesOfTheList) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Worlds worlds(seed + 3000);
    for (int i = 0; i < 30; ++i) {
      const Vec2 corner = worlds.Place();
      const double side = worlds.random().Chance(0.1) ? 0.0 : worlds.random().Uniform(0.0, 2.0);
      const Rectangle box{corner.x(), corner.y(), corner.x() + side, corner.y() + 0.7 * side};
      NearPieces dense;
      NearPieces listed;
      worlds.dense().static_index().Query(box, dense);
      worlds.listed().static_index().Query(box, listed);
      const std::array<Vec2, 4> corners = Corners(box);
      auto found = dense.begin();
      for (const ConvexPiece* expected : listed) {
        if (found == dense.end() || (*found)->vertices != expected->vertices) {
          // Left out, because only its bounding box overlaps the box.
          ASSERT_LT(PenetrationDepth(expected->vertices, corners), 0.0) << "seed " << seed + 3000;
          continue;
        }
        ASSERT_EQ((*found)->z, expected->z);
        ASSERT_EQ((*found)->model, expected->model);
        ASSERT_EQ((*found)->obstacle, expected->obstacle);
        ASSERT_EQ((*found)->ranger_return, expected->ranger_return);
        ++found;
      }
      ASSERT_EQ(found, dense.end()) << "seed " << seed + 3000;
    }
  }
}

TEST(PixelPiecesProperty, ContactsAreThoseOfTheList) {
  int contacts = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Worlds worlds(seed + 5000);
    RandomStream& random = worlds.random();
    BodyIndex dense_bodies(worlds.dense());
    BodyIndex listed_bodies(worlds.listed());
    dense_bodies.Assign(worlds.state());
    listed_bodies.Assign(worlds.state());
    if (worlds.state().robots.empty()) continue;
    for (int i = 0; i < 40; ++i) {
      const BodyId body(random.Index(worlds.state().robots.size()));
      const Vec2 place = worlds.Place();
      const double speed = random.Chance(0.2) ? 30.0 : 2.0;
      Motion motion{.X_WF = {place.x(), place.y(), random.Chance(0.5) ? 0.0 : random.Uniform(0.0, 1.0), random.Angle()},
                    .twist = {random.Uniform(-speed, speed), random.Uniform(-speed, speed), random.Uniform(-3.0, 3.0)},
                    .climb = random.Chance(0.2) ? random.Uniform(-1.0, 1.0) : 0.0,
                    .duration = 0.3};
      const auto dense = FirstContact(worlds.dense(), dense_bodies, MoverOf(worlds.dense(), body), motion);
      const auto listed = FirstContact(worlds.listed(), listed_bodies, MoverOf(worlds.listed(), body), motion);
      ASSERT_EQ(dense.has_value(), listed.has_value()) << "seed " << seed + 5000;
      if (!dense) continue;
      ASSERT_EQ(dense->time, listed->time) << "seed " << seed + 5000;
      ASSERT_EQ(dense->mine, listed->mine);
      ASSERT_EQ(dense->other, listed->other);
      ++contacts;
    }
  }
  EXPECT_GT(contacts, 300);
}

TEST(PixelPiecesProperty, OccupancyGridIsThatOfTheList) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Worlds worlds(seed + 7000);
    const OccupancyGrid dense = MakeOccupancyGrid(worlds.dense(), 0.07, 0.3);
    const OccupancyGrid listed = MakeOccupancyGrid(worlds.listed(), 0.07, 0.3);
    EXPECT_EQ(dense.width, listed.width);
    EXPECT_EQ(dense.origin_x, listed.origin_x);
    EXPECT_TRUE(dense.occupied == listed.occupied) << "seed " << seed + 7000;
  }
}

}  // namespace
}  // namespace troupe
