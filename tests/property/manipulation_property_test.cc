// Invariants of grips and gravity on random scenes with robots that grip, lift, carry and drop any object.
#include <gtest/gtest.h>

#include <cmath>

#include "common/spatial/body_index.h"
#include "common/spatial/convex_piece.h"
#include "tests/support/gripper_world.h"
#include "tests/support/random_grippers.h"
#include "tests/support/random_world.h"

namespace troupe {
namespace {

using test::Box;
using test::GripperDemand;
using test::GripperRobot;
using test::GripperRun;
using test::GripperWorld;
using test::RandomStream;
using test::Square;

// An object that lands is placed exactly on its support, from at most this distance.
constexpr double kTolerance = 2e-6;  // m

// The depth to which two prisms overlap: the shortest motion that separates them.
double Depth(const ConvexPiece& a, const ConvexPiece& b) {
  const double height = std::min(a.z.max, b.z.max) - std::max(a.z.min, b.z.min);
  if (height <= 0.0 || !BoundingBox(a.vertices).Overlaps(BoundingBox(b.vertices))) return 0.0;
  return std::min(height, PenetrationDepth(a.vertices, b.vertices));
}

double Deepest(const std::vector<ConvexPiece>& left, const std::vector<ConvexPiece>& right) {
  double deepest = 0.0;
  for (const ConvexPiece& a : left) {
    for (const ConvexPiece& b : right) {
      if (a.obstacle && b.obstacle) deepest = std::max(deepest, Depth(a, b));
    }
  }
  return deepest;
}

double DeepestOverlap(const Scene& scene, const WorldState& state) {
  BodyIndex bodies(scene);
  bodies.Assign(state);
  double deepest = 0.0;
  for (std::size_t i = 0; i < scene.body_count(); ++i) {
    const std::vector<ConvexPiece>& own = bodies.pieces_in_world(BodyId(i));
    deepest = std::max(deepest, Deepest(own, scene.static_index().kept_pieces()));
    for (std::size_t j = i + 1; j < scene.body_count(); ++j) {
      deepest = std::max(deepest, Deepest(own, bodies.pieces_in_world(BodyId(j))));
    }
  }
  return deepest;
}

Pose InGripper(const GripperRun& run, ObjectId object) {
  return Inverse(run.X_WM(run.scene.world().gripper(*run.object(object).holder).model)) * run.object(object).X_WO;
}

void ExpectNear(const Pose& a, const Pose& b) {
  EXPECT_NEAR(a.x, b.x, 1e-9);
  EXPECT_NEAR(a.y, b.y, 1e-9);
  EXPECT_NEAR(a.z, b.z, 1e-9);
  EXPECT_NEAR(std::remainder(a.heading - b.heading, 2.0 * kPi), 0.0, 1e-9);
}

// True if the object has a support or is on the ground.
bool IsCarried(const GripperRun& run, ObjectId id) {
  BodyIndex bodies(run.scene);
  bodies.Assign(run.state);
  const BodyId own = run.scene.body_of(id);
  std::vector<ConvexPiece> lowered = bodies.pieces_in_world(own);
  for (ConvexPiece& piece : lowered) {
    if (piece.z.min <= kTolerance) return true;
    piece.z.min -= 2.0 * kTolerance;
  }
  if (Deepest(lowered, run.scene.static_index().kept_pieces()) > 0.0) return true;
  for (std::size_t i = 0; i < run.scene.body_count(); ++i) {
    if (BodyId(i) != own && Deepest(lowered, bodies.pieces_in_world(BodyId(i))) > 0.0) return true;
  }
  return false;
}

TEST(ManipulationProperty, NoBodiesOverlapAndEveryObjectIsHeldOrRestsOrFalls) {
  std::size_t gripped = 0;
  std::size_t released = 0;
  std::size_t landed = 0;
  for (std::uint64_t seed = 1; seed <= 400 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    RandomStream random(seed + 31'000'000);
    const GripperWorld world = test::RandomGrippers(random);
    GripperRun run(world.world);
    if (DeepestOverlap(run.scene, run.state) > 0.0) continue;
    const bool has_gravity = world.world.gravity > 0.0;
    std::vector<GripperDemand> demands(run.state.robots.size());
    for (GripperDemand& demand : demands) demand.fingers = 0.1;
    for (int tick = 0; tick < 120 && !HasFailure(); ++tick) {
      SCOPED_TRACE(tick);
      for (GripperDemand& demand : demands) {
        if (tick > 15 && random.Chance(0.12)) demand = test::RandomDemand(random);
      }
      std::vector<std::optional<Pose>> X_GO;
      for (std::size_t i = 0; i < run.state.objects.size(); ++i) {
        X_GO.push_back(run.object(ObjectId(i)).holder ? std::optional(InGripper(run, ObjectId(i))) : std::nullopt);
      }
      const std::vector<ObjectState> before = run.state.objects;
      run.Step(demands);
      EXPECT_LE(DeepestOverlap(run.scene, run.state), kTolerance);
      for (std::size_t i = 0; i < run.state.objects.size(); ++i) {
        const ObjectId id(i);
        const ObjectState& object = run.object(id);
        EXPECT_EQ(object.mode == ObjectMode::kHeld, object.holder.has_value());
        if (object.holder) {
          EXPECT_EQ(run.state.grippers[object.holder->index()].clamped, id);
          if (before[i].holder == object.holder) ExpectNear(InGripper(run, id), *X_GO[i]);
        }
        EXPECT_TRUE(object.mode != ObjectMode::kResting || IsCarried(run, id)) << "object " << i;
        EXPECT_TRUE(object.mode != ObjectMode::kFalling || has_gravity);
        if (object.mode == ObjectMode::kPlaced && has_gravity) {
          EXPECT_EQ(object.X_WO, before[i].X_WO) << "nothing has touched it";
        }
      }
    }
    gripped += run.EventsOf(EventType::kGripped).size();
    released += run.EventsOf(EventType::kReleased).size();
    landed += run.EventsOf(EventType::kLanded).size() + run.EventsOf(EventType::kUnstable).size();
  }
  EXPECT_GT(gripped, 300u) << "too little happens";
  EXPECT_GT(released, 60u);
  EXPECT_GT(landed, 60u);
}

TEST(ManipulationProperty, AnIdleWorldStaysAsItIs) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    RandomStream random(seed + 32'000'000);
    const GripperWorld world = test::RandomGrippers(random);
    GripperRun run(world.world);
    run.Step(std::vector<GripperDemand>(run.state.robots.size()));
    WorldState first = run.state;
    run.Step(std::vector<GripperDemand>(run.state.robots.size()), 20);
    first.tick = run.state.tick;
    ASSERT_EQ(run.state, first) << "seed " << seed;
  }
}

}  // namespace
}  // namespace troupe
