// Robots that push against moving doors and lifts: nothing overlaps, and every step is repeatable, by any threads.
#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "tests/support/random_world.h"
#include "tests/support/small_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::RandomStream;

constexpr int kWorlds = 12;
constexpr int kTicks = 150;

ObjectId AddMounted(WorldDescription& world, ModelId model) {
  world.objects.push_back(model);
  return ObjectId(world.objects.size() - 1);
}

// Doors of all kinds, a lift between two floors, robots and crates, at random places without overlap.
class DoorWorld {
 public:
  explicit DoorWorld(RandomStream& random) : random_(random) {
    AddLift();
    for (int i = 0; i < 6; ++i) AddDoor(i);
    for (int i = 0; i < 14; ++i) AddRobot(i);
    for (int i = 0; i < 6; ++i) AddCrate(i);
    world_.world().interval_ns = 200'000'000;
  }

  const WorldDescription& world() { return world_.world(); }

 private:
  void AddDoor(int number) {
    const std::string name = "door" + std::to_string(number);
    const Pose X_WD{random_.Uniform(-5.0, 5.0), random_.Uniform(-5.0, 5.0), 0.0, random_.Angle()};
    world_.AddBox(name, 0.0, 0.0, 0.1, 0.1, {9.0, 9.1}).X_PM = X_WD;
    DoorDescription door{.model = ModelId(world_.world().models.size() - 1), .leaves = {}};
    for (int leaf = 0; leaf < 1 + number % 2; ++leaf) {
      world_.AddBox(name + "." + std::to_string(leaf), 0.0, 0.0, 1.0, 0.05, {0.0, 2.0});
      DoorLeaf made{AddMounted(world_.world(), ModelId(world_.world().models.size() - 1)),
                    X_WD * Pose{1.02 * leaf, 0.0, 0.0, 0.0}};
      (number % 3 == 0 ? made.shift : made.turn) = random_.Uniform(-2.0, 2.0);
      door.leaves.push_back(made);
    }
    door.seconds = random_.Uniform(0.3, 2.0);
    if (random_.Chance(0.3)) door.detection_radius = 1.5;
    door.opening = random_.Chance(0.5) ? 1.0 : random_.Uniform(0.0, 1.0);
    world_.world().doors.push_back(door);
  }

  // A plate that carries what is on it.
  void AddLift() {
    world_.AddBox("lift", 0.0, 0.0, 0.1, 0.1, {9.0, 9.1});
    const ModelId model(world_.world().models.size() - 1);
    world_.AddBox("cabin", 0.0, 0.0, 2.0, 2.0, {-0.1, 0.0}).X_PM = {3.0, 3.0, 0.2, 0.0};
    LiftDescription lift{.model = model,
                         .cabin = AddMounted(world_.world(), ModelId(model.index() + 1)),
                         .cabin_doors = {},
                         .floors = {{"low", 0.2, {}}, {"high", 1.0, {}}},
                         .speed = random_.Uniform(0.5, 2.0)};
    world_.world().lifts.push_back(lift);
  }

  void AddRobot(int number) {
    const double z = number < 3 ? 0.2 : 0.0;
    const double spread = number < 3 ? 0.6 : 5.0;
    const double center = number < 3 ? 3.0 : 0.0;
    const RobotId robot = world_.AddRobot(
        "r" + std::to_string(number),
        {center + random_.Uniform(-spread, spread), center + random_.Uniform(-spread, spread), z, random_.Angle()});
    world_.robot(robot).drive = test::UnboundedDrive();
  }

  void AddCrate(int number) {
    ModelDescription& crate = world_.AddBox("crate" + std::to_string(number), random_.Uniform(-5.0, 5.0),
                                            random_.Uniform(-5.0, 5.0), 0.3, 0.3, {0.0, 0.3});
    crate.gripper_return = true;
    world_.world().objects.emplace_back(world_.world().models.size() - 1);
  }

  SmallWorld world_;
  RandomStream& random_;
};

std::vector<Proposal> RandomProposals(const Scene& scene, RandomStream& random) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    proposals.push_back(
        {RobotId(i), {random.Uniform(-1.0, 2.0), random.Uniform(-1.0, 1.0), random.Uniform(-3.0, 3.0)}});
    if (random.Chance(0.1)) {
      proposals.back().orders.push_back(
          DoorOrder{random.Index(scene.world().doors.size()), random.Chance(0.5) ? 1.0 : 0.0});
    }
    if (random.Chance(0.05)) proposals.back().orders.push_back(LiftOrder{0, random.Index(2), random.Chance(0.3)});
  }
  return proposals;
}

// The pairs of bodies, of which at least one is a robot or a crate, that overlap noticeably.
std::set<std::pair<std::size_t, std::size_t>> OverlapsOf(const Scene& scene, const WorldState& state) {
  BodyIndex bodies(scene);
  bodies.Assign(state);
  const std::size_t robots = state.robots.size();
  const auto is_mounted = [&](std::size_t body) {
    return body >= robots && state.objects[body - robots].mode == ObjectMode::kMounted;
  };
  std::set<std::pair<std::size_t, std::size_t>> overlaps;
  for (std::size_t a = 0; a < scene.body_count(); ++a) {
    for (std::size_t b = a + 1; b < scene.body_count(); ++b) {
      if (is_mounted(a) && is_mounted(b)) continue;
      for (const ConvexPiece& p : bodies.pieces_in_world(BodyId(a))) {
        for (const ConvexPiece& q : bodies.pieces_in_world(BodyId(b))) {
          if (OverlapBy(p, q, 100.0 * kTouchTolerance)) overlaps.emplace(a, b);
        }
      }
    }
  }
  return overlaps;
}

TEST(DoorsProperty, NothingEntersAnotherAndThreadsChangeNothing) {
  std::size_t blocked = 0;
  std::size_t moved = 0;
  std::size_t raised = 0;
  for (int number = 0; number < kWorlds; ++number) {
    RandomStream random(900 + static_cast<std::uint64_t>(number));
    DoorWorld made(random);
    ASSERT_TRUE(Validate(made.world()).ok()) << Validate(made.world()).error().message;
    const Scene scene(made.world());
    WorldState state = InitialState(scene);
    Stepper threads(scene, std::make_shared<ThreadPool>(2), 1);
    BodyIndex bodies(scene);
    // Of the places at random some overlap from the start: those may part, and no others may begin to.
    auto overlaps = OverlapsOf(scene, state);
    for (int tick = 0; tick < kTicks; ++tick) {
      const std::vector<Proposal> proposals = RandomProposals(scene, random);
      const StepResult result = Step(scene, state, proposals, bodies);
      const StepResult again = threads.Step(state, proposals);
      ASSERT_EQ(result.state, again.state) << "world " << number << ", tick " << tick;
      ASSERT_EQ(result.events, again.events);
      ASSERT_TRUE(scene.CheckState(result.state).ok());
      const auto now = OverlapsOf(scene, result.state);
      for (const auto& pair : now) {
        ASSERT_TRUE(overlaps.contains(pair))
            << "world " << number << ", tick " << tick << ": bodies " << pair.first << " and " << pair.second;
      }
      overlaps = now;
      for (std::size_t i = 0; i < state.doors.size(); ++i) {
        blocked += result.state.doors[i].blocked ? 1 : 0;
        moved += result.state.doors[i].opening != state.doors[i].opening ? 1 : 0;
      }
      for (const RobotState& robot : result.state.robots) raised += robot.X_WR.z > 0.5 ? 1 : 0;
      state = result.state;
    }
  }
  EXPECT_GT(blocked, 50u) << "the worlds are too empty for a test";
  EXPECT_GT(moved, 1000u);
  EXPECT_GT(raised, 100u);
}

}  // namespace
}  // namespace troupe
