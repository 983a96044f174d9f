// Index queries compared with brute force.
#include <gtest/gtest.h>

#include "common/spatial/body_index.h"
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

}  // namespace
}  // namespace troupe
