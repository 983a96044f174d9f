// Doors and lifts: what files make of them, and how they move.
#include <cmath>
#include <cstdlib>
#include <optional>

#include "common/model/states.h"
#include "common/spatial/check_order.h"
#include "common/spatial/convex_piece.h"
#include "tests/support/values.h"
#include "tests/worldfile/scenario_run.h"
#include "tests/worldfile/world_folder.h"
#include "troupe/expectation.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::HasSubstr;

// A cart that reaches any speed at once, and a box that can be gripped.
const std::string kDefines = R"(
  define cart position (
    size [0.4 0.4 0.5] drive "omni" velocity_bounds [-2 2 -2 2 0 0 -90 90]
    acceleration_bounds [-100 100 -100 100 0 0 -1000 1000]
  )
  define crate model ( size [0.3 0.3 0.3] gripper_return 1 )
)";

WorldDescription LoadDoors(const std::string& text) {
  test::TemporaryFolder folder;
  return ValueOf(LoadWorld(folder.Write("w.world", kDefines + text))).world;
}

std::string ErrorOfDoors(const std::string& text) {
  test::TemporaryFolder folder;
  const Result<LoadedWorld> loaded = LoadWorld(folder.Write("w.world", kDefines + text));
  return loaded.ok() ? "" : loaded.error().message;
}

Simulation Simulate(const std::string& text) {
  return ValueOf(Simulation::Create(LoadDoors(text)));
}

// With a person of 0.25 m radius that stands at a point, which a cart "r" sees from afar.
Simulation SimulateWithPerson(const std::string& text, double x, double y, double z = 0.0) {
  test::TemporaryFolder folder;
  folder.Write("w.world", kDefines + text);
  const auto number = [](double value) { return std::to_string(value); };
  const std::string place = number(x) + ", " + number(y);
  return ValueOf(Simulation::Load(
      folder.Write("s.json", R"({"world": "w.world", "people": [{"count": 1, "name_prefix": "p", "goals": [[)" + place +
                                 R"(]], "region": [)" + number(x - 0.01) + ", " + number(y - 0.01) + ", " +
                                 number(x + 0.01) + ", " + number(y + 0.01) + R"(], "z": )" + number(z) + "}]}")));
}

Command Motion(double vx) {
  return {.twist = {vx, 0.0, 0.0}};
}
Command Open(double opening, double vx = 0.0) {
  Command command = Motion(vx);
  command.orders = {DoorOrder{0, opening}};
  return command;
}
Command Call(std::size_t floor, double vx = 0.0) {
  Command command = Motion(vx);
  command.orders = {LiftOrder{.lift = 0, .floor = floor}};
  return command;
}

void Do(Simulation& simulation, const std::string& robot, const Command& command, Tick ticks) {
  ASSERT_TRUE(simulation.Drive(*simulation.FindRobot(robot), command).ok());
  simulation.Step(ticks);
}

const DoorState& Door(const Simulation& simulation) {
  return simulation.state().doors[0];
}

// No leaf, cabin, robot or object is in another, but for leaves and cabins among themselves.
void ExpectNoOverlap(const Simulation& simulation) {
  const Scene scene(simulation.world());
  BodyIndex bodies(scene);
  bodies.Assign(simulation.state());
  const auto is_mounted = [&](std::size_t body) {
    const std::optional<ObjectId> object = scene.object_of(BodyId(body));
    return object && simulation.state().objects[object->index()].mode == ObjectMode::kMounted;
  };
  for (std::size_t a = 0; a < scene.body_count(); ++a) {
    for (std::size_t b = a + 1; b < scene.body_count(); ++b) {
      if (is_mounted(a) && is_mounted(b)) continue;
      for (const ConvexPiece& p : bodies.pieces_in_world(BodyId(a))) {
        for (const ConvexPiece& q : bodies.pieces_in_world(BodyId(b))) {
          if (!p.obstacle || !q.obstacle) continue;
          ASSERT_FALSE(OverlapBy(p, q, 10.0 * kTouchTolerance))
              << simulation.world().model(p.model).name << " and " << simulation.world().model(q.model).name
              << " at tick " << simulation.tick();
        }
      }
    }
  }
}

// Leaves.

struct LeafCorners {
  Vec2 right;  // the ends of the leaf
  Vec2 left;
};

std::vector<LeafCorners> CornersOf(const std::string& properties, double opening) {
  const WorldDescription world = LoadDoors("door ( name \"d\" size [2 0.05 2] " + properties + " )");
  std::vector<LeafCorners> corners;
  for (const DoorLeaf& leaf : world.doors[0].leaves) {
    const ModelDescription& model = world.model(world.objects[leaf.object.index()]);
    const Rectangle box = BoundingBox(world.shape(model.shape).blocks[0].outline);
    const Transform2 move(leaf.X_WH_at(opening));
    corners.push_back({move * Vec2(box.max_x, 0.0), move * Vec2(box.min_x, 0.0)});
  }
  return corners;
}

TEST(Doors, LeavesCloseTheDoorwayAndOpenByTheirKind) {
  struct Case {
    std::string properties;
    std::vector<LeafCorners> closed;
    std::vector<LeafCorners> open;
  };
  const Case cases[] = {
      {"kind \"hinged\"", {{{1, 0}, {-1, 0}}}, {{{1, 0}, {1, 2}}}},
      {"kind \"hinged\" swing -90", {{{1, 0}, {-1, 0}}}, {{{1, 0}, {1, -2}}}},
      {"kind \"hinged\" side \"left\"", {{{1, 0}, {-1, 0}}}, {{{-1, 2}, {-1, 0}}}},
      {"kind \"double_hinged\" ratio 3",
       {{{1, 0}, {-0.5, 0}}, {{-0.5, 0}, {-1, 0}}},
       {{{1, 0}, {1, 1.5}}, {{-1, 0.5}, {-1, 0}}}},
      {"kind \"sliding\"", {{{1, 0}, {-1, 0}}}, {{{3, 0}, {1, 0}}}},
      {"kind \"sliding\" side \"left\"", {{{1, 0}, {-1, 0}}}, {{{-1, 0}, {-3, 0}}}},
      {"kind \"double_sliding\" ratio 3",
       {{{1, 0}, {-0.5, 0}}, {{-0.5, 0}, {-1, 0}}},
       {{{2.5, 0}, {1, 0}}, {{-1, 0}, {-1.5, 0}}}},
  };
  constexpr double kGap = 0.006;  // m, at each end of a leaf
  for (const Case& each : cases) {
    for (const double opening : {0.0, 1.0}) {
      const std::vector<LeafCorners> found = CornersOf(each.properties, opening);
      const std::vector<LeafCorners>& expected = opening == 1.0 ? each.open : each.closed;
      ASSERT_EQ(found.size(), expected.size()) << each.properties;
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_LE((found[i].right - expected[i].right).norm(), kGap) << each.properties;
        EXPECT_LE((found[i].left - expected[i].left).norm(), kGap) << each.properties;
      }
    }
  }
}

TEST(Doors, FaultsOfFilesAreNamed) {
  EXPECT_THAT(ErrorOfDoors("door ( size [0 0.1 2] )"), HasSubstr("found a 'door' without extent"));
  EXPECT_THAT(ErrorOfDoors("cart ( door ( ) )"), HasSubstr("found a 'door' on a robot"));
  EXPECT_THAT(ErrorOfDoors("lift ( floors [\"a\"] heights [0] )"), HasSubstr("found a 'lift' without blocks"));
  const std::string cabin = "block ( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 1] )";
  EXPECT_THAT(ErrorOfDoors("lift ( " + cabin + " )"), HasSubstr("found a 'lift' without 'floors'"));
  EXPECT_THAT(ErrorOfDoors("lift ( floors [\"a\" \"b\"] heights [1 2] " + cabin + " )"),
              HasSubstr("found a 'lift' at none of its 'heights'"));
  EXPECT_THAT(ErrorOfDoors("lift ( floors [\"a\" \"b\"] heights [0 2] floor_doors [\"a\" \"d\"] " + cabin + " )"),
              HasSubstr("found no door 'd'"));
}

// A doorway across x at the origin, whose leaf slides to y = 1.2.
const std::string kGate = R"(
  door ( name "gate" pose [0 0 0 90] size [1.2 0.1 2] kind "sliding" seconds 2 )
)";

TEST(Doors, OpensAndClosesInItsTime) {
  Simulation run = Simulate(kGate + "cart ( name \"r\" pose [-3 0 0 0] )");
  run.Step(5);
  EXPECT_EQ(Door(run).opening, 0.0);
  EXPECT_EQ(run.state().objects[0].mode, ObjectMode::kMounted);
  Do(run, "r", Open(1.0), 10);
  EXPECT_NEAR(Door(run).opening, 0.5, 1e-12);
  EXPECT_NEAR(run.state().objects[0].X_WO.y, 0.6, 1e-9);
  run.Step(10);
  EXPECT_EQ(Door(run).opening, 1.0);
  Do(run, "r", Open(0.25), 30);
  EXPECT_EQ(Door(run).opening, 0.25);
  Do(run, "r", Open(0.0), 30);
  EXPECT_EQ(Door(run).opening, 0.0);
}

TEST(Doors, ARobotStopsAtAClosedDoorAndPassesAnOpenOne) {
  Simulation run = Simulate(kGate + "cart ( name \"r\" pose [-1 0 0 0] )");
  Do(run, "r", Motion(1.0), 20);
  EXPECT_TRUE(run.state().robots[0].stalled);
  EXPECT_NEAR(run.state().robots[0].X_WR.x, -0.25, 1e-6);
  Do(run, "r", Open(1.0), 20);
  Do(run, "r", Motion(1.0), 20);
  EXPECT_GT(run.state().robots[0].X_WR.x, 1.0);
  ExpectNoOverlap(run);
}

TEST(Doors, WaitForARobotInTheDoorwayWithoutTouchingItsBits) {
  Simulation run = Simulate(kGate + "cart ( name \"r\" pose [-1 0 0 0] )");
  Do(run, "r", Open(1.0, 1.0), 10);  // the leaf is still in its way
  Do(run, "r", Open(1.0, 0.0), 20);
  Do(run, "r", Motion(1.0), 3);
  const Pose before = run.state().robots[0].X_WR;
  ASSERT_LT(std::fabs(before.x), 0.2);
  Do(run, "r", Open(0.0), 30);
  EXPECT_TRUE(Door(run).blocked);
  // The leaf reaches from y = -0.6 to 0.6 when closed; the robot ends at 0.2.
  EXPECT_NEAR(Door(run).opening, (0.2 + 0.595) / 1.2, 1e-6);
  EXPECT_EQ(run.state().robots[0].X_WR, before);
  ExpectNoOverlap(run);
  Do(run, "r", Motion(1.0), 30);
  EXPECT_EQ(Door(run).opening, 0.0);
  EXPECT_FALSE(Door(run).blocked);
}

// The events of `ticks` ticks, as "type thing detail".
std::vector<std::string> EventsOf(Simulation& simulation, int ticks) {
  std::vector<std::string> texts;
  for (int i = 0; i < ticks; ++i) {
    simulation.Step();
    for (const Event& event : simulation.events()) {
      if (!IsOfBuilding(event.type)) continue;
      EXPECT_EQ(event.tick, simulation.tick());
      const std::string detail = event.detail.empty() ? "" : " " + event.detail;
      texts.push_back(NameOf(event.type) + (" " + simulation.world().model(*event.object).name) + detail);
    }
  }
  return texts;
}

TEST(Doors, AreInTheEventsOfTheStep) {
  Simulation run = Simulate(kGate + "cart ( name \"r\" pose [-1 0 0 0] )");
  const std::string name = run.world().model(run.world().doors[0].model).name;
  Do(run, "r", Open(1.0), 0);
  EXPECT_THAT(EventsOf(run, 30), testing::ElementsAre("door_opened " + name));
  Do(run, "r", Motion(1.0), 10);  // into the doorway
  Do(run, "r", Open(0.0), 0);
  EXPECT_THAT(EventsOf(run, 30), testing::ElementsAre("door_blocked " + name));
  Do(run, "r", Motion(1.0), 0);
  EXPECT_THAT(EventsOf(run, 40), testing::ElementsAre("door_closed " + name));
}

TEST(Doors, WaitForAPersonInTheDoorway) {
  const std::string gate = R"(
    door ( name "gate" pose [0 0 0 90] size [1.2 0.1 2] kind "sliding" seconds 2 opening 1 )
    cart ( name "r" pose [-5 0 0 0] )
  )";
  Simulation run = SimulateWithPerson(gate, 0.0, -0.2);
  const Pose before = run.state().people[0].X_WP;
  for (int i = 0; i < 40; ++i) {
    Do(run, "r", Open(0.0), 1);
    ExpectNoOverlap(run);
  }
  EXPECT_TRUE(Door(run).blocked);
  EXPECT_GT(Door(run).opening, 0.3);
  EXPECT_EQ(run.state().people[0].X_WP.translation(), before.translation());
}

TEST(Doors, AHingedLeafStopsAtABoxAndGoesOnWithoutIt) {
  const std::string door = "door ( name \"d\" size [1 0.04 2] kind \"hinged\" seconds 1 )";
  Simulation run = Simulate(door + "crate ( name \"box\" pose [-0.2 0.5 0 0] ) cart ( name \"r\" pose [5 0 0 0] )");
  Do(run, "r", Open(1.0), 20);
  EXPECT_TRUE(Door(run).blocked);
  EXPECT_GT(Door(run).opening, 0.1);
  EXPECT_LT(Door(run).opening, 0.6);
  ExpectNoOverlap(run);
  const auto scene = std::make_shared<const Scene>(run.world());
  EditedWorld moved = ValueOf(SetPose(scene, run.state(), "box", {4.0, 4.0, 0.0, 0.0}));
  for (int i = 0; i < 20; ++i) moved.state = Step(*moved.scene, moved.state, {}).state;
  EXPECT_EQ(moved.state.doors[0].opening, 1.0);
}

TEST(Doors, OpenByThemselvesForRobotsInReachOnTheirLevel) {
  const std::string door = "door ( name \"d\" pose [0 0 0 90] kind \"sliding\" seconds 1 reach 1.5 )";
  Simulation run = Simulate(door + "cart ( name \"r\" pose [-4 0 0 0] )");
  Do(run, "r", Motion(0.5), 49);  // at -1.55
  EXPECT_EQ(Door(run).opening, 0.0);
  Do(run, "r", Motion(0.5), 30);
  EXPECT_TRUE(Door(run).held);
  EXPECT_EQ(Door(run).opening, 1.0);
  Do(run, "r", Motion(0.5), 60);
  EXPECT_GT(run.state().robots[0].X_WR.x, 2.0);
  EXPECT_EQ(Door(run).opening, 0.0);
  Simulation above = Simulate(door + "cart ( name \"r\" pose [0 0 3 0] )");
  above.Step(20);
  EXPECT_EQ(Door(above).opening, 0.0);
}

TEST(Doors, OfTwoOrdersInATickTheWiderCounts) {
  Simulation run = Simulate(kGate + "cart ( name \"a\" pose [-3 0 0 0] ) cart ( name \"b\" pose [-3 2 0 0] )");
  ASSERT_TRUE(run.Drive(RobotId(0), Open(0.5)).ok());
  ASSERT_TRUE(run.Drive(RobotId(1), Open(0.0)).ok());
  run.Step();
  EXPECT_EQ(Door(run).target, 0.5);
  EXPECT_THAT(run.Drive(RobotId(0), Open(1.5)).error().message,
              HasSubstr("found the opening 1.500000 of a door, expected 0 to 1"));
}

TEST(Doors, AreSeenByRays) {
  Simulation run = Simulate(kGate + R"(cart ( name "r" pose [-2 0 0 0]
      ranger ( pose [0 0 0.1 0] sensor ( range [0 5] fov 0 samples 1 ) ) ))");
  const auto range = [&] { return std::get<RangerReading>(run.Measure(RobotId(0), 0).content).ranges.at(0); };
  EXPECT_NEAR(range(), 1.95, 1e-9);
  Do(run, "r", Open(1.0), 20);
  EXPECT_EQ(range(), 5.0);
}

// The state after a tick with an order of a tool, which the world must accept.
WorldState After(const Scene& scene, const WorldState& state, const Input& input) {
  const Status valid = CheckInput(scene, input);
  EXPECT_TRUE(valid.ok()) << valid.error().message;
  return Step(scene, state, {}, std::span(&input, 1)).state;
}

TEST(Doors, OperatedByAToolAndNeitherMovedNorDeleted) {
  const auto scene = std::make_shared<const Scene>(
      LoadDoors(kGate + "cart ( name \"r\" pose [-3 0 0 0] )" + "door ( name \"fixed\" pose [9 0 0 0] operated 0 )"));
  const WorldState state = InitialState(*scene);
  EXPECT_EQ(After(*scene, state, {{}, DoorOrder{0, 1.0}}).doors[0].target, 1.0);
  EXPECT_THAT(CheckInput(*scene, {{}, DoorOrder{2, 1.0}}).error().message, HasSubstr("found door 2"));
  EXPECT_THAT(CheckInput(*scene, {{}, DoorOrder{1, 1.0}}).error().message, HasSubstr("not operated"));
  EXPECT_THAT(CheckInput(*scene, {{}, DoorOrder{0, 1.5}}).error().message, HasSubstr("expected 0 to 1"));
  EXPECT_FALSE(CheckInput(*scene, {{}, LightOrder{0, true}}).ok());
  EXPECT_FALSE(CheckInput(*scene, {RobotId(1), TwistOrder{}}).ok());
  EXPECT_THAT(DeleteEntity(scene, state, "gate").error().message, HasSubstr("not moved or deleted"));
  EXPECT_THAT(SetPose(scene, state, "gate.right", {}).error().message, HasSubstr("is a leaf of door 'gate'"));
}

// Nothing of a world without doors and lifts changes its hash.
TEST(Doors, ADoorIsAPartOfTheHashAndNoDoorIsNone) {
  const Scene scene(LoadDoors("cart ( name \"r\" )"));
  const WorldState state = InitialState(scene);
  EXPECT_TRUE(state.doors.empty() && state.lifts.empty());
  const Scene with_door(LoadDoors(kGate));
  WorldState other = InitialState(with_door);
  const std::uint64_t closed = StateHash(other);
  other.doors[0].target = 1.0;
  EXPECT_NE(StateHash(other), closed);
}

// Lifts.

// A cabin of 2 m x 2 m at the origin, open to -x, with a door of its own and one of each floor at x = -1.
const std::string kLift = R"(
  define leaf door ( size [1.2 0.04 2] kind "double_sliding" seconds 1 )
  leaf ( name "cabin_door" pose [-0.95 0 0 90] opening 1 )
  leaf ( name "lower" pose [-1.1 0 0 90] opening 1 )
  leaf ( name "upper" pose [-1.1 0 3 90] )
  lift (
    name "up" size [2 2 2.1] pose [0 0 0 0] floors ["ground" "first"] heights [0 3] speed 1
    cabin_doors ["cabin_door"]
    floor_doors ["ground" "cabin_door" "ground" "lower" "first" "cabin_door" "first" "upper"]
    block ( points 4 point[0] [0 0] point[1] [2 0] point[2] [2 2] point[3] [0 2] z [0 0.05] )
    block ( points 4 point[0] [1.95 0] point[1] [2 0] point[2] [2 2] point[3] [1.95 2] z [0.05 2.15] )
    block ( points 4 point[0] [0 0] point[1] [1.9 0] point[2] [1.9 0.05] point[3] [0 0.05] z [0.05 2.15] )
    block ( points 4 point[0] [0 1.95] point[1] [1.9 1.95] point[2] [1.9 2] point[3] [0 2] z [0.05 2.15] )
  )
  cart ( name "r" pose [-2 0 0.06 0] crate ( name "load" pose [0 0 0 0] ) )
)";

const LiftState& LiftOf(const Simulation& simulation) {
  return simulation.state().lifts[0];
}

TEST(Lifts, CarryARobotAndItsLoadToAnotherFloor) {
  Simulation run = Simulate(kLift);
  Do(run, "r", Motion(1.0), 20);  // into the cabin
  const Pose inside = run.state().robots[0].X_WR;
  ASSERT_NEAR(inside.x, 0.0, 1e-9);
  const auto load = [&] { return run.state().objects.back().X_WO; };
  const double height = load().z - inside.z;
  Do(run, "r", Call(1), 5);
  EXPECT_EQ(LiftOf(run).z, 0.0) << "its doors are not closed yet";
  for (int i = 0; i < 100; ++i) {
    Do(run, "r", Motion(0.0), 1);
    ExpectNoOverlap(run);
    const bool moves = LiftOf(run).z != 0.0 && LiftOf(run).z != 3.0;
    for (const DoorState& door : run.state().doors) EXPECT_TRUE(!moves || door.opening == 0.0);
  }
  EXPECT_EQ(LiftOf(run).z, 3.0);
  EXPECT_EQ(LiftOf(run).session, RobotId(0));
  EXPECT_NEAR(run.state().robots[0].X_WR.z, inside.z + 3.0, 1e-12);
  EXPECT_NEAR(load().z - run.state().robots[0].X_WR.z, height, 1e-12);
  EXPECT_EQ(run.state().doors[0].opening, 1.0);
  EXPECT_EQ(run.state().doors[1].opening, 0.0);
  EXPECT_EQ(run.state().doors[2].opening, 1.0);
  Do(run, "r", Motion(-1.0), 25);
  EXPECT_NEAR(run.state().robots[0].X_WR.x, -2.5, 1e-9);
  EXPECT_FALSE(run.state().robots[0].stalled);
}

// A define has the lift and the doors of its landings: under the names by which the lift calls them, at the heights of
// their floors, wherever the lift is put, also at its upper floor.
TEST(Lifts, HaveTheDoorsOfTheirLandingsAsChildren) {
  const std::string landing = "include \"doors.inc\"\n";
  for (const double z : {0.0, 3.0}) {
    const WorldDescription world =
        LoadDoors(landing + "elevator ( name \"e\" pose [4 1 " + std::to_string(z) + " 90] )");
    ASSERT_EQ(world.lifts.size(), 1u);
    ASSERT_EQ(world.doors.size(), 2u);
    for (std::size_t floor = 0; floor < 2; ++floor) {
      ASSERT_EQ(world.lifts[0].floors[floor].doors, std::vector<std::size_t>{floor});
      const DoorDescription& door = world.doors[floor];
      EXPECT_EQ(world.model(door.model).name, floor == 0 ? "e.ground_door" : "e.first_door");
      EXPECT_FALSE(door.is_operated);
      EXPECT_NEAR(world.model(world.lifts[0].model).X_PM.z + world.model(door.model).X_PM.z,
                  3.0 * static_cast<double>(floor), 1e-12);
      for (const DoorLeaf& leaf : door.leaves) {
        EXPECT_NEAR(leaf.X_WH.z, 3.0 * static_cast<double>(floor), 1e-12);
        EXPECT_NEAR(leaf.X_WH.x, 4.84, 1e-9);
      }
    }
  }
  // Two lifts have the names of their doors for themselves, and both serve their floors.
  Simulation run = Simulate(landing + R"(
    elevator ( name "a" pose [0 0 0 0] )
    elevator ( name "b" pose [6 0 0 0] )
    cart ( name "r" pose [6 -2 0 90] )
  )");
  Command call = Motion(0.0);
  call.orders = {LiftOrder{.lift = 1, .floor = 0}};
  Do(run, "r", call, 40);
  EXPECT_EQ(run.state().doors[2].opening, 1.0);
  Do(run, "r", Motion(1.0), 20);
  ASSERT_NEAR(run.state().robots[0].X_WR.y, 0.0, 1e-9) << "in the cabin";
  call.orders = {LiftOrder{.lift = 1, .floor = 1}};
  Do(run, "r", call, 120);
  EXPECT_EQ(run.state().lifts[1].z, 3.0);
  EXPECT_EQ(run.state().lifts[0].z, 0.0);
  EXPECT_EQ(run.state().doors[0].opening, 1.0) << "of a lift that has stayed at its floor";
  EXPECT_EQ(run.state().doors[1].opening, 0.0);
  EXPECT_EQ(run.state().doors[2].opening, 0.0);
  EXPECT_EQ(run.state().doors[3].opening, 1.0);
  EXPECT_NEAR(run.state().robots[0].X_WR.z, 3.0, 1e-9);
  EXPECT_EQ(
      ErrorOfDoors("lift ( floors [\"a\"] heights [0] floor_doors [\"a\" \"none\"] block ( points 3 point[0] [0 0] "
                   "point[1] [1 0] point[2] [0 1] z [0 0.1] ) )"),
      "found no door 'none', expected a 'door' for the lift");
}

TEST(Lifts, ServeOneSessionAtATime) {
  Simulation run = Simulate(kLift + "cart ( name \"other\" pose [-3 2 3 0] )");
  Do(run, "r", Call(1), 1);
  ASSERT_TRUE(run.Drive(RobotId(1), Call(0)).ok());
  run.Step(3);
  EXPECT_EQ(LiftOf(run).floor, 1u);
  EXPECT_EQ(LiftOf(run).session, RobotId(0));
  Command end = Motion(0.0);
  end.orders = {LiftOrder{.lift = 0, .ends = true}};
  Do(run, "r", end, 1);
  EXPECT_FALSE(LiftOf(run).session);
  Do(run, "other", Call(0), 1);
  EXPECT_EQ(LiftOf(run).floor, 0u);
  EXPECT_EQ(LiftOf(run).session, RobotId(1));
}

TEST(Lifts, OpenBothDoorsAgainForWhatIsInTheDoorwayOfOne) {
  // Between the leaves of both doors, and of the landing alone.
  for (const double x : {-1.0, -1.25}) {
    Simulation run = Simulate(kLift);
    Do(run, "r", Motion(1.0), x == -1.0 ? 10 : 0);
    Do(run, "r", Motion(1.5), x == -1.0 ? 0 : 5);
    ASSERT_NEAR(run.state().robots[0].X_WR.x, x, 1e-9);
    int opened = 0;
    Do(run, "r", Call(1), 1);
    for (int i = 0; i < 100; ++i) {
      const bool was_open = run.state().doors[0].opening == 1.0;
      run.Step();
      ExpectNoOverlap(run);
      EXPECT_GT(run.state().doors[0].opening, 0.1) << "the door of the cabin closes before the other one";
      opened += !was_open && run.state().doors[0].opening == 1.0 && run.state().doors[1].opening == 1.0 ? 1 : 0;
    }
    EXPECT_GE(opened, 2);
    EXPECT_EQ(LiftOf(run).z, 0.0);
    EXPECT_EQ(run.state().doors[2].opening, 0.0) << "there is no cabin behind it";
    Do(run, "r", Motion(-1.0), 60);
    EXPECT_EQ(LiftOf(run).z, 3.0);
    EXPECT_FALSE(run.state().doors[0].held);
  }
}

TEST(Lifts, EndTheSessionOfARobotThatProposesNothing) {
  const Scene scene(LoadDoors(kLift + "cart ( name \"other\" pose [-3 2 3 0] )"));
  Proposal own{.robot = RobotId(0)};
  own.orders = {LiftOrder{.lift = 0, .floor = 1}};
  WorldState state = Step(scene, InitialState(scene), std::span(&own, 1)).state;
  own.orders.clear();
  state = Step(scene, state, std::span(&own, 1)).state;
  ASSERT_EQ(state.lifts[0].session, RobotId(0)) << "kept without an order";
  Proposal other{.robot = RobotId(1)};
  other.orders = {LiftOrder{.lift = 0, .floor = 0}};
  state = Step(scene, state, std::span(&other, 1)).state;
  EXPECT_EQ(state.lifts[0].session, RobotId(1));
  state = Step(scene, state, {}).state;
  EXPECT_FALSE(state.lifts[0].session);
  EXPECT_EQ(state.lifts[0].floor, 0u) << "the last call is still executed";
}

// A platform without doors, with a wall above its edge.
TEST(Lifts, StopWhereARobotSticksOutUnderAWall) {
  for (const double y : {0.85, 0.75}) {
    Simulation run = Simulate(R"(
      model ( name "wall" pose [0 1.06 1.5 0] size [6 0.1 2] )
      lift ( name "li" size [2 2 0.1] floors ["G" "U"] heights [0 3] speed 1
        block ( points 4 point[0] [0 0] point[1] [2 0] point[2] [2 2] point[3] [0 2] z [0 0.05] ) )
      cart ( name "r" pose [0 )" +
                              std::to_string(y) + " 0.1 0] )");
    for (int i = 0; i < 50; ++i) {
      Do(run, "r", Call(1), 1);
      ExpectNoOverlap(run);
    }
    const bool sticks_out = y > 0.8;
    EXPECT_EQ(LiftOf(run).blocked, sticks_out);
    EXPECT_NEAR(LiftOf(run).z, sticks_out ? 0.9 : 3.0, 1e-6);
    if (!sticks_out) continue;
    Do(run, "r", {.twist = {0.0, -0.3, 0.0}}, 10);
    Do(run, "r", Motion(0.0), 30);
    EXPECT_NEAR(LiftOf(run).z, 3.0, 1e-9) << "it goes on once the robot is within";
  }
}

TEST(Lifts, StopAboveWhatIsUnderTheCabin) {
  Simulation run = Simulate(kLift + "crate ( name \"below\" pose [0.5 0.5 0 0] obstacle_return 1 )");
  const auto scene = std::make_shared<const Scene>(run.world());
  // The box is put there once the cabin is above.
  EditedWorld edited{scene, After(*scene, run.state(), {{}, LiftOrder{0, 1}})};
  const ObjectId below(edited.state.objects.size() - 1);
  edited.state.objects[below.index()].X_WO.x = 5.0;
  for (int i = 0; i < 100; ++i) edited.state = Step(*scene, edited.state, {}).state;
  ASSERT_EQ(edited.state.lifts[0].z, 3.0);
  // An edit is refused there.
  EXPECT_THAT(SetPose(scene, edited.state, "below", {0.5, 0.5, 0.0, 0.0}).error().message,
              HasSubstr("would be inside"));
  edited.state.objects[below.index()].X_WO = {0.5, 0.5, 0.0, 0.0};
  edited.state = After(*scene, edited.state, {{}, LiftOrder{0, 0}});
  for (int i = 0; i < 100; ++i) edited.state = Step(*scene, edited.state, {}).state;
  EXPECT_TRUE(edited.state.lifts[0].blocked);
  EXPECT_NEAR(edited.state.lifts[0].z, 0.3, 1e-6);
  EXPECT_THAT(CheckInput(*scene, {{}, LiftOrder{0, 2}}).error().message,
              HasSubstr("found a call of lift 0 to floor 2"));
}

// A script rides the lift of the guesthouse to its second level.
TEST(Lifts, OfABuildingAreRiddenByAScript) {
  const std::string site = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/guesthouse.building.yaml";
  test::TemporaryFolder folder;
  std::filesystem::copy(site, folder.Path("g.building.yaml"));
  const std::string scenario = R"({"world": "g.building.yaml", "robots": [{"name": "tiny_1", "pose": [10, -4, 90],
    "controller": {"name": "script", "parameters": {"commands": [
      {"at": 0, "vx": 0.5}, {"at": 5, "vx": 0, "lifts": {"guest_lift": "L2"}}, {"at": 20, "vx": -0.5},
      {"at": 26, "vx": 0, "lifts": {"guest_lift": ""}, "doors": {"lobby_door": "close"}}]}}}]})";
  ScenarioRun run(ValueOf(LoadWorld(folder.Write("s.json", scenario))).world);
  run.Run(400);
  EXPECT_NEAR(run["tiny_1"].X_WR.z, 4.0, 1e-9);
  EXPECT_LT(run["tiny_1"].X_WR.y, -3.4);
  EXPECT_FALSE(run.EverStalled("tiny_1"));
  EXPECT_EQ(run.state().lifts[0].z, 4.0);
  EXPECT_FALSE(run.state().lifts[0].session);
  EXPECT_EQ(run.state().doors[*FindDoor(run.scene().world(), "lobby_door")].opening, 0.0);
}

TEST(Lifts, AreInTheEventsOfTheStep) {
  Simulation run = SimulateWithPerson(kLift, 0.3, 0.3, 0.06);
  Do(run, "r", Call(1), 0);
  std::vector<std::string> events = EventsOf(run, 200);
  std::erase_if(events, [](const std::string& event) { return event.starts_with("door"); });
  EXPECT_THAT(events,
              testing::ElementsAre(HasSubstr("lift_left"), HasSubstr("lift_arrived"), "person_alighted p1 first"));
}

// Guests of a house ride its lift to their goals: by the expectations of a user.
TEST(Lifts, AndPeopleAreSignalsOfExpectations) {
  const std::string file = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/guesthouse_guests.json";
  Simulation run = ValueOf(Simulation::Load(file));
  const ExpectationScope scope{run.world()};
  std::vector<Monitor> monitors;
  for (const char* const text :
       {"exists p in people: eventually event(person_boarded, p)", "exists p in people: eventually level(p) == 'L2'",
        "forall l in lifts: always (open(l) -> stands(l))", "eventually event(lift_arrived, guest_lift, 'L2')",
        "exists p in people: eventually (lift(p) == 'guest_lift' and floor(p) == 'L2')",
        "eventually[0 s, 120 s] open(lobby_door)", "forall p in people: always speed(p) < 2.5 m/s",
        "exists p in people: eventually event(person_arrived, p)", "always count(people) == 6 or count(people) > 6"}) {
    const Result<Expectation> expectation = Expectation::Parse(text, scope);
    ASSERT_TRUE(expectation.ok()) << text << ": " << expectation.error().message;
    monitors.emplace_back(expectation.value());
  }
  for (int tick = 0; tick <= 1200; ++tick) {
    for (Monitor& monitor : monitors) ASSERT_TRUE(monitor.Push(run).ok());
    run.Step();
  }
  for (Monitor& monitor : monitors) {
    monitor.Finish();
    EXPECT_EQ(monitor.verdict(), Verdict::kTrue) << monitor.expectation().text();
  }
}

TEST(Lifts, CarryAPersonAndLeaveAnotherOne) {
  for (const bool is_inside : {true, false}) {
    Simulation run = SimulateWithPerson(kLift, is_inside ? 0.3 : 3.0, 0.3, 0.06);
    const double height = run.state().people[0].X_WP.z;
    for (int i = 0; i < 100; ++i) {
      Do(run, "r", Call(1), 1);
      ExpectNoOverlap(run);
    }
    EXPECT_EQ(LiftOf(run).z, 3.0);
    EXPECT_NEAR(run.state().people[0].X_WP.z, height + (is_inside ? 3.0 : 0.0), 1e-12);
  }
}

}  // namespace
}  // namespace troupe
