#include "common/model/states.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/model/device_limits.h"
#include "tests/support/test_world.h"
#include "troupe/event.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/random.h"

namespace troupe {
namespace {

// The counts of each kind; CheckState reads nothing else of the description.
WorldDescription SomeWorld() {
  WorldDescription world;
  world.models.resize(4);
  world.robots.resize(1);
  world.robots[0].root = ModelId(0);
  world.joints.resize(2);
  world.grippers.resize(1);
  world.objects.resize(2);
  return world;
}

WorldState SomeState() {
  WorldState state;
  state.robots.resize(1);
  state.joints.resize(2);
  state.grippers.resize(1);
  state.objects.resize(2);
  return state;
}

TEST(CheckStateTest, AStateOfTheWorldPasses) {
  WorldState state = SomeState();
  state.grippers[0] = {ModelId(3), ModelId(3), ObjectId(1)};
  state.objects[1].mode = ObjectMode::kHeld;
  state.objects[1].holder = GripperId(0);
  state.objects[0].support = ModelId(3);
  EXPECT_TRUE(CheckState(SomeWorld(), state).ok());
}

TEST(CheckStateTest, StatesThatDoNotBelongToTheWorldAreRefused) {
  struct Case {
    const char* part;
    std::function<void(WorldState&)> spoil;
  };
  const Case cases[] = {
      {"robots", [](WorldState& s) { s.robots.clear(); }},
      {"joints", [](WorldState& s) { s.joints.pop_back(); }},
      {"grippers", [](WorldState& s) { s.grippers.resize(2); }},
      {"objects", [](WorldState& s) { s.objects.resize(3); }},
      {"pose of a robot", [](WorldState& s) { s.robots[0].X_WR.x = std::nan(""); }},
      {"position of a joint", [](WorldState& s) { s.joints[1].position = std::nan(""); }},
      {"velocity of a joint", [](WorldState& s) { s.joints[1].velocity = HUGE_VAL; }},
      {"pose of an object", [](WorldState& s) { s.objects[1].X_WO.heading = std::nan(""); }},
      {"fall speed", [](WorldState& s) { s.objects[0].fall_speed = std::nan(""); }},
      {"left contact", [](WorldState& s) { s.grippers[0].left_contact = ModelId(4); }},
      {"right contact", [](WorldState& s) { s.grippers[0].right_contact = ModelId(4); }},
      {"clamped", [](WorldState& s) { s.grippers[0].clamped = ObjectId(2); }},
      {"support", [](WorldState& s) { s.objects[0].support = ModelId(4); }},
      {"held without a holder", [](WorldState& s) { s.objects[0].mode = ObjectMode::kHeld; }},
      {"resting with a holder", [](WorldState& s) { s.objects[0].holder = GripperId(0); }},
      {"held by an unknown gripper",
       [](WorldState& s) {
         s.objects[0].mode = ObjectMode::kHeld;
         s.objects[0].holder = GripperId(1);
       }},
      {"a door that the world does not have", [](WorldState& s) { s.doors.resize(1); }},
      {"a lift that the world does not have", [](WorldState& s) { s.lifts.resize(1); }},
      {"a zone that the world does not have", [](WorldState& s) { s.zones.resize(1); }},
      {"cells that the world does not have", [](WorldState& s) { s.coverage.resize(1); }},
      {"a flow that the world does not have", [](WorldState& s) { s.flows.resize(1); }},
      {"a rule of a lane that the world does not have", [](WorldState& s) { s.lane_rules.resize(1); }},
      {"a charger that the world does not have",
       [](WorldState& s) { s.charging_robots = {{.robot = RobotId(0), .vertex = 0}}; }},
      {"goods of a flow that the world does not have", [](WorldState& s) { s.jobs.resize(1); }},
  };
  for (const Case& bad : cases) {
    WorldState state = SomeState();
    bad.spoil(state);
    EXPECT_FALSE(CheckState(SomeWorld(), state).ok()) << bad.part;
  }
}

// A row of each kind, of a world that has them.
TEST(CheckStateTest, EveryNumberIsFinite) {
  WorldDescription world = SomeWorld();
  WorldState state = SomeState();
  const DeviceCounts devices{.stores = 1, .imus = 1, .lights = 1, .cameras = 1};
  state.stores.resize(1);
  state.imus.resize(1);
  state.lights.resize(1);
  state.cameras.resize(1);
  world.doors.resize(1);
  state.doors.resize(1);
  world.lifts.emplace_back().floors.resize(1);
  state.lifts.resize(1);
  world.goal_sets.resize(1);
  world.people.push_back({.root = ModelId(0)});
  state.people.resize(1);
  LaneGraph& graph = world.lane_graphs.emplace_back();
  graph.vertices.resize(2);
  graph.lanes.push_back({.start = 0, .end = 1});
  state.lane_rules.resize(1);
  ASSERT_TRUE(CheckState(world, devices, state).ok());
  int numbers = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    ForEachLeaf<Row>([&]<typename Leaf>(const Leaf& leaf) {
      if constexpr (std::is_same_v<typename Leaf::Part, double>) {
        WorldState bad = state;
        leaf.Of(table.Of(bad).back()) = std::nan("");
        EXPECT_FALSE(CheckState(world, devices, bad).ok()) << table.name << ": " << leaf.name;
        ++numbers;
      }
    });
  });
  EXPECT_EQ(numbers, 7 + 2 + 5 + 2 + 3 + 2 + 2 + 1 + 6 + 1);
}

WorldState HashedState() {
  test::TestWorld test;
  test.AddRobot(test::Square(0.4), {0.0, 1.0}, {1.0, 2.0, 0.5, 0.3});
  test.AddRobot(test::Square(0.4), {0.0, 1.0}, {-1.0, 0.0, 0.0, 0.0});
  return PlacedState(test.world);
}

TEST(StateHash, ChangesWithEveryPartOfTheState) {
  const std::function<void(WorldState&)> changes[] = {
      [](WorldState&) {},
      [](WorldState& s) { s.tick = 1; },
      [](WorldState& s) { s.robots[0].X_WR.x = std::nextafter(s.robots[0].X_WR.x, 9.0); },
      [](WorldState& s) { s.robots[0].X_WR.y += 1e-9; },
      [](WorldState& s) { s.robots[0].X_WR.z += 1e-9; },
      [](WorldState& s) { s.robots[0].X_WR.heading += 1e-9; },
      [](WorldState& s) { s.robots[1].twist.vx = 1.0; },
      [](WorldState& s) { s.robots[1].twist.vy = 1.0; },
      [](WorldState& s) { s.robots[1].twist.wz = 1.0; },
      [](WorldState& s) { s.robots[0].twist.vx = 1.0; },
      [](WorldState& s) { s.robots[1].stalled = true; },
      [](WorldState& s) { std::swap(s.robots[0], s.robots[1]); },
      [](WorldState& s) { s.robots.pop_back(); },
  };
  std::set<std::uint64_t> hashes;
  for (const auto& change : changes) {
    WorldState state = HashedState();
    change(state);
    EXPECT_TRUE(hashes.insert(StateHash(state)).second) << "change " << hashes.size();
  }
}

// Another value.
void Change(double& number) {
  number += 1.0;
}
void Change(bool& flag) {
  flag = !flag;
}
void Change(std::uint32_t& number) {
  ++number;
}
void Change(std::uint64_t& number) {
  ++number;
}
void Change(ObjectMode& mode) {
  mode = ObjectMode::kFalling;
}
void Change(std::vector<std::uint8_t>& bytes) {
  bytes.push_back(0);
}
template <typename Tag>
void Change(Id<Tag>& id) {
  id = Id<Tag>(7);
}
template <typename Tag>
void Change(std::optional<Id<Tag>>& id) {
  id = Id<Tag>(0);
}
void Change(std::optional<std::uint32_t>& number) {
  number = 0;
}

TEST(StateHash, ChangesWithEveryFieldOfEveryRow) {
  WorldState state;
  state.tick = 1;
  ForEachTable([&](const auto& table) { table.Of(state).resize(2); });
  std::set<std::uint64_t> hashes = {StateHash(state)};
  std::size_t fields = 1;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    ForEachLeaf<Row>([&](const auto& leaf) {
      for (std::size_t row = 0; row < 2; ++row) {
        WorldState changed = state;
        Change(leaf.Of(table.Of(changed)[row]));
        EXPECT_TRUE(hashes.insert(StateHash(changed)).second) << table.name << " " << row << ": " << leaf.name;
      }
      fields += 2;
    });
  });
  EXPECT_EQ(hashes.size(), fields);
}

// The hashes of recordings: they never change.
TEST(StateHash, OfAStateIsAlwaysTheSame) {
  WorldState state{.tick = 2,
                   .robots = {{{1.0, 2.0, 3.0, 0.25}, {4.0, 5.0, 6.0}, true}, {}},
                   .joints = {{0.5, -0.125, true}},
                   .grippers = {{ModelId(3), std::nullopt, ObjectId(0)}},
                   .objects = {{{1.5, 2.5, 3.5, -0.5}, ObjectMode::kHeld, 0.75, GripperId(0), std::nullopt},
                               {{}, ObjectMode::kResting, 0.0, std::nullopt, ModelId(9)}}};
  EXPECT_EQ(StateHash(state), 0xed2b4e8603fc4992);
  state.stores = {{12.5, 7.5}};
  state.imus = {{8.0, 9.0, 10.0}};
  state.lights = {{false}, {true}};
  state.cameras = {{0.5, -0.25}};
  state.transmissions = {{RobotId(1), 1, 9, 3, {2, RobotId(0), {1, 2, 3}}}, {.from = RobotId(0)}};
  EXPECT_EQ(StateHash(state), 0xd372da59c89fd345);
  state.tick = 0;  // the support of the second object is not hashed
  EXPECT_EQ(StateHash(state), 0xb461254dea607bf9);
  state.objects[1].mode = ObjectMode::kPlaced;
  state.objects[1].support.reset();
  EXPECT_EQ(StateHash(state), 0xb461254dea607bf9);
}

TEST(StateHash, IsAFunctionOfTheState) {
  EXPECT_EQ(StateHash(HashedState()), StateHash(HashedState()));
}

struct Inner {
  std::optional<RobotId> robot = {};
  std::vector<std::uint8_t> bytes = {};
  static constexpr auto Fields() { return std::tuple{Field{"robot", &Inner::robot}, Field{"bytes", &Inner::bytes}}; }
};

struct Outer {
  RobotId id;
  Pose pose = {};
  std::string text = {};
  std::optional<Twist> twist = {};
  Inner inner = {};
  std::vector<Inner> list = {};
  bool flag = false;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"inner", &Outer::inner}, Field{"id", &Outer::id},       Field{"pose", &Outer::pose},
        Field{"text", &Outer::text},   Field{"twist", &Outer::twist}, Field{"list", &Outer::list},
        Field{"flag", &Outer::flag},
    };
  }
};

TEST(FieldsTest, MembersOfAllKindsCount) {
  EXPECT_EQ(kMemberCount<Pose>, 4u);
  EXPECT_EQ(kMemberCount<Inner>, 2u);
  EXPECT_EQ(kMemberCount<Outer>, 7u);
}

TEST(FieldsTest, AFieldHasItsUnitItsLimitsAndItsDocumentation) {
  const auto opening = std::get<0>(kFields<DoorState>);
  EXPECT_EQ(opening.documentation, "from 0, closed, to 1");
  EXPECT_TRUE(opening.limits.Contain(1.0));
  EXPECT_FALSE(opening.limits.Contain(1.1));
  EXPECT_EQ(std::get<0>(kFields<LiftState>).unit, "m");
  EXPECT_EQ(std::get<3>(kLeaves<RobotState>).unit, "rad") << "that of the leaf";
  EXPECT_EQ(std::get<2>(kLeaves<GoalSet>).unit, "m");
  constexpr auto above = Field{"x", &Pose::x}.Above(0).AtMost(2).limits;
  EXPECT_FALSE(above.Contain(0.0));
  EXPECT_TRUE(above.Contain(2.0));
  EXPECT_FALSE(FieldLimits().Contain(HUGE_VAL));
  EXPECT_FALSE(FieldLimits().Contain(std::nan("")));
}

TEST(CheckStateTest, AFieldBeyondItsLimitsIsNamed) {
  WorldDescription world = SomeWorld();
  world.doors.resize(2);
  WorldState state = SomeState();
  state.doors.resize(2);
  EXPECT_TRUE(CheckState(world, state).ok());
  state.doors[1].opening = 1.5;
  EXPECT_EQ(CheckState(world, state).error().message, "state: doors.1.opening: found 1.5, expected from 0 to 1");
}

TEST(FieldsTest, AMemberThatIsListedTwiceIsFound) {
  EXPECT_TRUE(fields_internal::AreDistinct(Outer::Fields()));
  EXPECT_FALSE(fields_internal::AreDistinct(std::tuple{Field{"x", &Pose::x}, Field{"y", &Pose::x}}));
}

TEST(FieldsTest, LeavesReachIntoBranchesInTheOrderOfTheLists) {
  Outer row;
  std::vector<std::string> names;
  std::vector<const void*> places;
  ForEachLeaf<Outer>([&](const auto& leaf) {
    names.emplace_back(leaf.name);
    places.push_back(&leaf.Of(row));
  });
  EXPECT_EQ(names, (std::vector<std::string>{"robot", "bytes", "id", "x", "y", "z", "heading", "text", "twist", "list",
                                             "flag"}));
  EXPECT_EQ(places,
            (std::vector<const void*>{&row.inner.robot, &row.inner.bytes, &row.id, &row.pose.x, &row.pose.y,
                                      &row.pose.z, &row.pose.heading, &row.text, &row.twist, &row.list, &row.flag}));
}

TEST(Id, ADefaultOneIsThatOfNothing) {
  EXPECT_NE(ModelId(), ModelId(0));
  EXPECT_GE(ModelId().index(), std::numeric_limits<std::uint32_t>::max()) << "the first entity has 0";
}

TEST(Id, AnIndexOfMoreBitsIsNotCutToThatOfSomethingElse) {
  constexpr std::size_t kMax = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(RobotId(kMax - 1).index(), kMax - 1);
  for (const std::size_t index : {kMax, kMax + 1, kMax + 4, std::numeric_limits<std::size_t>::max()}) {
    EXPECT_EQ(RobotId(index), RobotId()) << index;
  }
}

TEST(Event, HasANameForEveryType) {
  EXPECT_STREQ(NameOf(EventType::kStallBegan), "stall_began");
  EXPECT_STREQ(NameOf(EventType::kStallEnded), "stall_ended");
  EXPECT_STREQ(NameOf(EventType::kJoined), "joined");
  EXPECT_STREQ(NameOf(EventType::kLeft), "left");
  EXPECT_STREQ(NameOf(EventType::kProposalRejected), "proposal_rejected");
  EXPECT_STREQ(NameOf(static_cast<EventType>(200)), "unknown");
}

DriveDescription SomeDrive(DriveType type) {
  return {.type = type,
          .wheelbase = 0.5,
          .velocity = {{-0.5, 1.0}, {-0.2, 0.2}, {-1.0, 1.0}},
          .acceleration = {{-2.0, 1.0}, {-1.0, 1.0}, {-5.0, 5.0}}};
}

TEST(DriveLimits, KeepVelocitiesWithinTheirBounds) {
  DriveDescription drive = SomeDrive(DriveType::kOmni);
  const Interval any{-1e6, 1e6};
  drive.acceleration = {any, any, any};
  EXPECT_EQ(ClampToLimits(drive, {}, {5.0, 5.0, 5.0}, 0.1), (Twist{1.0, 0.2, 1.0}));
  EXPECT_EQ(ClampToLimits(drive, {}, {-5.0, -5.0, -5.0}, 0.1), (Twist{-0.5, -0.2, -1.0}));
  EXPECT_EQ(ClampToLimits(drive, {}, {0.3, -0.1, 0.2}, 0.1), (Twist{0.3, -0.1, 0.2}));
}

TEST(DriveLimits, KeepChangesWithinTheAccelerationBounds) {
  const DriveDescription drive = SomeDrive(DriveType::kOmni);
  EXPECT_EQ(ClampToLimits(drive, {}, {1.0, 0.2, 1.0}, 0.1), (Twist{0.1, 0.1, 0.5}));
  EXPECT_EQ(ClampToLimits(drive, {.vx = 0.8}, {}, 0.1), (Twist{.vx = 0.8 - 0.2}));
}

TEST(DriveLimits, BrakeAsHardAsPossibleWhenTooFast) {
  const DriveDescription drive = SomeDrive(DriveType::kDifferential);
  EXPECT_EQ(ClampToLimits(drive, {.vx = 3.0}, {.vx = 3.0}, 0.1), (Twist{.vx = 2.8}));
}

TEST(DriveLimits, DifferentialDriveDoesNotMoveSideways) {
  const DriveDescription drive = SomeDrive(DriveType::kDifferential);
  EXPECT_EQ(ClampToLimits(drive, {}, {0.05, 0.05, 0.1}, 0.1), (Twist{0.05, 0.0, 0.1}));
  EXPECT_FALSE(WithinLimits(drive, {}, {0.05, 0.05, 0.1}, 0.1));
}

TEST(DriveLimits, CarTwistFollowsTheSteeredWheel) {
  EXPECT_EQ(CarTwist(1.0, 0.0, 0.5), (Twist{1.0, 0.0, 0.0}));
  const Twist left = CarTwist(2.0, kPi / 6.0, 0.5);
  EXPECT_NEAR(left.vx, 2.0 * 0.8660254037844386, 1e-12);
  EXPECT_NEAR(left.wz, 2.0 * 0.5 / 0.5, 1e-12);
  EXPECT_EQ(left.vy, 0.0);
}

TEST(DriveLimits, CarBoundsSpeedAndSteering) {
  DriveDescription drive = SomeDrive(DriveType::kCar);
  drive.velocity.heading = {-0.6, 0.6};
  const auto expect_near = [](const Twist& a, const Twist& b) {
    EXPECT_NEAR(a.vx, b.vx, 1e-12);
    EXPECT_EQ(a.vy, 0.0);
    EXPECT_NEAR(a.wz, b.wz, 1e-12);
  };
  const Twist cruising = CarTwist(1.0, 0.0, 0.5);
  expect_near(ClampToLimits(drive, cruising, CarTwist(1.0, 0.4, 0.5), 0.1), CarTwist(1.0, 0.4, 0.5));
  expect_near(ClampToLimits(drive, cruising, CarTwist(1.0, 1.4, 0.5), 0.1), CarTwist(1.0, 0.6, 0.5));
  expect_near(ClampToLimits(drive, cruising, CarTwist(9.0, -0.4, 0.5), 0.1), CarTwist(1.0, -0.4, 0.5));
  expect_near(ClampToLimits(drive, {}, CarTwist(1.0, 0.3, 0.5), 0.1), CarTwist(0.1, 0.3, 0.5));
  expect_near(ClampToLimits(drive, {}, CarTwist(-1.0, 0.3, 0.5), 0.1), CarTwist(-0.2, 0.3, 0.5));
  expect_near(ClampToLimits(drive, {}, {}, 0.1), {});
}

TEST(DriveLimits, AcceptTwistsThatTheyClamped) {
  for (DriveType type : {DriveType::kDifferential, DriveType::kOmni, DriveType::kCar}) {
    const DriveDescription drive = SomeDrive(type);
    Twist current;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const auto draw = [&](std::uint64_t k) { return 6.0 * RandomUniform({i, k}) - 3.0; };
      const Twist desired{draw(0), draw(1), draw(2)};
      const Twist next = ClampToLimits(drive, current, desired, 0.1);
      ASSERT_TRUE(WithinLimits(drive, current, next, 0.1)) << "draw " << i;
      ASSERT_FALSE(WithinLimits(drive, current, {next.vx + 3.0, next.vy, next.wz}, 0.1)) << "draw " << i;
      current = next;
    }
  }
}

}  // namespace
}  // namespace troupe
