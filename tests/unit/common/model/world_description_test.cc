#include "troupe/world_description.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "common/model/find_robots.h"
#include "common/model/states.h"
#include "tests/support/random_rows.h"
#include "tests/support/small_world.h"
#include "tests/support/test_world.h"
#include "troupe/sensor_description.h"

namespace troupe {
namespace {

std::vector<LaneGraph> OneLane() {
  LaneGraph graph;
  graph.vertices.resize(2);
  graph.vertices[1].position = {4.0, 0.0};
  graph.lanes.push_back({.start = 0, .end = 1, .mutex = "", .doors = {}});
  return {graph};
}

// A world in which every field of a description can be changed.
WorldDescription FullWorld() {
  test::TestWorld test;
  test.world.name = "full";
  const ModelId floor = test.AddModel(test::Square(3.0), {0.0, 0.1}, {1.0, 1.0, 0.0, 0.5});
  test.AddModel(test::Square(0.5), {0.0, 1.0}, {0.5, 0.0, 0.1, 0.25}, floor);
  const RobotId robot = test.AddRobot(test::Square(0.4), {0.0, 0.5}, {5.0, 6.0, 0.0, 1.0});
  const ModelId laser = test.AddModel(test::Square(0.1), {0.0, 0.1}, {0.1, 0.0, 0.5, 0.0}, ModelId(2));
  test.world.shapes[0].rectangles = {{0.0, 0.0, 1.0, 1.0}};
  test.world.shapes[0].rectangles_z = {0.0, 1.0};
  test.world.robots[robot.index()].sensors = {
      {.name = "ranger:0", .model = laser, .period_ticks = 1, .parameters = RangerParameters{{{}}}}};
  return test.world;
}

TEST(ModelPoses, FollowTheTreeAtTheStart) {
  const WorldDescription world = FullWorld();
  const std::vector<Pose> X_WM = ModelPoses(world, PlacedState(world));
  ASSERT_EQ(X_WM.size(), 4u);
  EXPECT_EQ(X_WM[0], (Pose{1.0, 1.0, 0.0, 0.5}));
  EXPECT_EQ(X_WM[1], (X_WM[0] * Pose{0.5, 0.0, 0.1, 0.25}));
  EXPECT_DOUBLE_EQ(X_WM[1].heading, 0.75);
  EXPECT_DOUBLE_EQ(X_WM[1].z, 0.1);
  EXPECT_EQ(X_WM[3], (X_WM[2] * Pose{0.1, 0.0, 0.5, 0.0}));
}

TEST(FindRobot, FindsByName) {
  const WorldDescription world = FullWorld();
  EXPECT_EQ(FindRobot(world, "m2"), RobotId(0));
  EXPECT_EQ(FindRobot(world, "m0"), std::nullopt) << "a model, but no robot";
  EXPECT_EQ(FindRobot(world, ""), std::nullopt);
}

TEST(FindRobots, FindsThoseThatExist) {
  test::TestWorld test;
  std::vector<RobotId> robots;
  for (int i = 0; i < 12; ++i) robots.push_back(test.AddRobot(test::Square(0.4), {0.0, 0.5}, {1.0 * i, 0.0, 0.0, 0.0}));
  test.world.models[test.world.robot(robots[3]).root.index()].removed = true;
  std::vector<std::string> names = {"m", ""};
  for (const RobotId id : robots) names.insert(names.begin(), test.world.robot(id).name);
  names.push_back(names.front());
  const std::vector<std::optional<RobotId>> found = FindRobots(test.world, names);
  ASSERT_EQ(found.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool exists = !names[i].empty() && names[i] != "m" && names[i] != test.world.robot(robots[3]).name;
    EXPECT_EQ(found[i], FindRobot(test.world, names[i])) << names[i];
    EXPECT_EQ(found[i].has_value(), exists) << names[i];
  }
  EXPECT_EQ(NamesThatExist(test.world, {"m", names[0], "", names[1]}), (std::vector<std::string>{names[0], names[1]}));
}

// Calls use() with each field of a value changed, one after another, and each list shortened.
template <typename Value, typename Use>
void WithEachChange(Value& value, const Use& use) {
  const auto with = [&](const auto& other) {
    const Value before = value;
    value = other;
    use();
    value = before;
  };
  if constexpr (HasFields<Value>) {
    ForEachField<Value>([&](const auto& field) { WithEachChange(field.Of(value), use); });
  } else if constexpr (std::is_same_v<Value, SensorParameters>) {
    std::visit([&](auto& kind) { WithEachChange(kind, use); }, value);
  } else if constexpr (std::is_same_v<Value, Vec2>) {
    with(Vec2(value.x() + 1e-9, value.y()));
    with(Vec2(value.x(), value.y() + 1e-9));
  } else if constexpr (kIsList<Value>) {
    for (auto& element : value) WithEachChange(element, use);
    ASSERT_FALSE(value.empty());
    with(Value(value.begin(), value.end() - 1));
  } else if constexpr (std::is_same_v<Value, std::string>) {
    with(value + "x");
  } else if constexpr (kIsId<Value>) {
    with(Value(value.index() == 0 ? 1 : 0));
  } else if constexpr (std::is_same_v<Value, std::optional<PixelArea>>) {
    // the hash is that of its rectangles
  } else if constexpr (kIsOptional<Value>) {
    ASSERT_TRUE(value.has_value());
    with(std::nullopt);
    WithEachChange(*value, use);
  } else if constexpr (std::is_same_v<Value, bool>) {
    with(!value);
  } else if constexpr (std::is_enum_v<Value>) {
    with(value == Value() ? LastOf(value) : Value());
  } else if constexpr (std::is_arithmetic_v<Value>) {
    with(static_cast<Value>(value * 2 + 1));
  } else {
    WithEachChange(value.Change(), use);  // Shared
  }
}

// One row of each type, with values.
WorldDescription WorldOfEachRow() {
  test::RandomRows random(1);
  const auto one = [&](auto& rows) {
    rows.resize(1);
    random.Fill(rows[0]);
  };
  WorldDescription world;
  one(world.shapes);
  one(world.shapes[0].blocks);
  world.shapes[0].blocks[0].outline.assign(3, Vec2(1.0, 2.0));
  one(world.shapes[0].rectangles);
  one(world.models);
  world.models[0].parent = ModelId(0);
  one(world.robots);
  world.robots[0].ros.domain = 5;
  one(world.robots[0].sensors);
  one(world.robots[0].frames);
  RangerParameters ranger;
  one(ranger.ray_sensors.Change());
  one(ranger.ray_sensors.Change()[0].elevations);
  world.robots[0].sensors[0].parameters = ranger;
  one(world.joints);
  one(world.grippers);
  world.grippers[0].lift = JointId(0);
  one(world.grippers[0].beams);
  world.objects.resize(1);
  one(world.places);
  one(world.places[0].tags);
  one(world.doors);
  one(world.doors[0].leaves);
  one(world.lifts);
  world.lifts[0].cabin_doors = {0};
  one(world.lifts[0].floors);
  world.lifts[0].floors[0].doors = {0};
  one(world.goal_sets);
  world.goal_sets[0].points = {{1.0, 2.0}};
  one(world.goal_sets[0].next);
  world.goal_sets[0].heights = {0.5};
  one(world.people);
  world.people[0].leader = PersonId(0);
  one(world.levels);
  one(world.lane_graphs);
  one(world.lane_graphs[0].vertices);
  world.lane_graphs[0].vertices[0].lift = 0;
  one(world.lane_graphs[0].lanes);
  one(world.lane_graphs[0].lanes[0].doors);
  one(world.zones);
  one(world.zones[0].outline);
  world.zones[0].exits = 0;
  one(world.flows);
  one(world.timed_actions);
  one(world.lane_trips);
  one(world.visitor_flows);
  world.visitor_flows[0].times = world.visitor_flows[0].per_hour = {1.0};
  one(world.visitors);
  world.visitors[0].flow = 0;
  world.visitors[0].track = {{1.0, 2.0}};
  world.visitors[0].track_times = {3.0};
  world.exits = {0};
  world.lane_trips[0].goals = world.lane_trips[0].path = world.lane_trips[0].steps = {0};
  return world;
}

TEST(WorldHash, ChangesWithEveryField) {
  WorldDescription world = WorldOfEachRow();
  std::set<std::uint64_t> hashes = {Hash(world)};
  std::size_t changes = 1;
  WithEachChange(world, [&] {
    ++changes;
    EXPECT_TRUE(hashes.insert(Hash(world)).second) << "change " << changes;
  });
  EXPECT_GT(changes, 200u);
  EXPECT_EQ(Hash(world), Hash(WorldOfEachRow()));
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Model 0 is static; model 1 is robot 0's root, model 2 its ranger; model 3 is robot 1's root.
WorldDescription GoodWorld() {
  test::TestWorld test;
  test.AddModel(test::Square(3.0), {0.0, 0.1}, {1.0, 1.0, 0.0, 0.5});
  test.AddRobot(test::Square(0.4), {0.0, 0.5}, {5.0, 6.0, 0.0, 1.0});
  const ModelId laser = test.AddModel(std::vector<Block>{}, {0.1, 0.0, 0.5, 0.0}, ModelId(1));
  test.AddRobot(test::Square(0.4), {0.0, 0.5}, {7.0, 6.0, 0.0, 1.0});
  test.world.robots[0].sensors = {
      {.name = "ranger:0", .model = laser, .period_ticks = 1, .parameters = RangerParameters{{{}}}}};
  test.world.shapes[0].rectangles = {{0.0, 0.0, 1.0, 1.0}};
  return test.world;
}

TEST(Validate, AcceptsAGoodWorld) {
  const Status problem = Validate(GoodWorld());
  EXPECT_TRUE(problem.ok()) << problem.error().message;
  EXPECT_TRUE(Validate(WorldDescription{}).ok()) << "an empty description is valid, too";
}

struct Fault {
  std::function<void(WorldDescription&)> change;
  const char* message;
};

const Fault kFaults[] = {
    {[](auto& w) { w.interval_ns = 0; }, "interval: found 0, expected from 1 to 1e+12 ns"},
    {[](auto& w) { w.interval_ns = -5; }, "interval: found -5, expected from 1 to 1e+12 ns"},
    {[](auto& w) { w.shapes[0].blocks[0].outline.resize(2); },
     "shape 0: the outline of a block is not usable: found 2 vertices, expected at least 3"},
    {[](auto& w) { std::swap(w.shapes[0].blocks[0].outline[0], w.shapes[0].blocks[0].outline[2]); },
     "shape 0: the outline of a block is not normalized"},
    {[](auto& w) {
       w.shapes[0].blocks[0].z = {1.0, 0.0};
     },
     "shapes.0.blocks.0.z: found an interval from 1 to 0, expected an end that is not below its beginning"},
    {[](auto& w) { w.shapes[0].rectangles[0].max_x = 0.0; }, "shape 0: a rectangle has no area"},
    {[](auto& w) { w.shapes[0].rectangles[0].max_x = kInfinity; },
     "shapes.0.rectangles.0.max_x: found inf, expected at most 1e+06 in size"},
    {[](auto& w) { w.shapes[0].rectangles_z.max = kNan; },
     "shapes.0.rectangles_z.max: found nan, expected at most 1e+06 in size"},
    {[](auto& w) { w.models[0].name = ""; }, "model 0 '': it has no name"},
    {[](auto& w) { w.models[1].name = "m0"; }, "model 1 'm0': another model has the same name"},
    {[](auto& w) { w.models[0].parent = ModelId(0); }, "model 0 'm0': its parent does not precede it"},
    {[](auto& w) { w.models[0].parent = ModelId(9); }, "models.0.parent: found 9, expected one of 4"},
    {[](auto& w) { w.models[0].shape = ShapeId(4); }, "models.0.shape: found 4, expected one of 4"},
    {[](auto& w) { w.models[0].X_PM.x = kNan; },
     "models.0.pose_in_parent.x: found nan, expected at most 1e+06 in size"},
    {[](auto& w) { w.models[0].X_PM.x = 1e7; },
     "models.0.pose_in_parent.x: found 1e+07, expected at most 1e+06 in size"},
    {[](auto& w) { w.models[0].size_x = kInfinity; }, "models.0.size_x: found inf, expected at most 1e+06 in size"},
    {[](auto& w) { w.models[0].color.r = kNan; }, "models.0.color.r: found nan, expected at most 1e+06 in size"},
    {[](auto& w) { w.models[0].ranger_return = kNan; },
     "models.0.ranger_return: found nan, expected at most 1e+06 in size"},
    {[](auto& w) { w.robots[0].root = ModelId(77); }, "robots.0.root: found 77, expected one of 4"},
    {[](auto& w) { w.robots[1] = w.robots[0]; }, "robot 1 'm1': it is not in the order of the root models"},
    {[](auto& w) { w.robots[0].root = ModelId(2); }, "robot 0 'm1': its root model has a parent"},
    {[](auto& w) { w.robots[0].name = "x"; }, "robot 0 'x': its root model has another name: 'm1'"},
    {[](auto& w) { w.robots[0].drive.wheelbase = 0.0; }, "robots.0.drive.wheelbase: found 0, expected above 0 m"},
    {[](auto& w) {
       w.robots[0].drive.velocity.x = {1.0, -1.0};
     },
     "robots.0.drive.velocity.x: found an interval from 1 to -1, expected an end that is not below its beginning"},
    {[](auto& w) { w.robots[0].drive.velocity.x.max = kInfinity; },
     "robots.0.drive.velocity.x.max: found inf, expected at most 1e+06 in size"},
    {[](auto& w) { w.robots[0].drive.acceleration.y.min = 1.0; },
     "robot 0 'm1': its acceleration bounds are not intervals around 0"},
    {[](auto& w) { w.robots[0].localization.origin.y = kNan; },
     "robots.0.localization.origin.y: found nan, expected at most 1e+06 in size"},
    {[](auto& w) { w.robots[0].localization.error_x = kNan; },
     "robots.0.localization.error_x: found nan, expected at most 1e+06 in size"},
    {[](auto& w) { w.robots[0].ros.domain = 231; }, "robots.0.ros.ros_domain: found 231, expected from 0 to 230"},
    {[](auto& w) { w.robots[0].ros.domain = w.robots[1].ros.domain = 5; },
     "found the ROS domain 5 for robot 'm3', which robot 'm1' has already, expected one for each robot"},
    {[](auto& w) { w.robots[0].sensors[0].model = ModelId(0); },
     "robot 0 'm1': its ranger 'ranger:0' is not one of its models"},
    {[](auto& w) { w.robots[0].sensors[0].model = ModelId(50); },
     "robots.0.sensors.0.model: found 50, expected one of 4"},
    {[](auto& w) { w.robots[0].sensors[0].period_ticks = 0; },
     "robots.0.sensors.0.period: found 0, expected at least 1 tick"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].X_MS.x = kNan; },
     "robots.0.sensors.0.parameters.ray_sensors.0.pose.x: found nan, expected at most 1e+06 in size"},
    {[](auto& w) {
       RaySensors(w.robots[0].sensors[0])[0].range = {-1.0, 1.0};
     },
     "robots.0.sensors.0.parameters.ray_sensors.0.range.min: found -1, expected at least 0 m"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].fov = -0.1; },
     "robots.0.sensors.0.parameters.ray_sensors.0.fov: found -5.72958, expected at least 0 degrees"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].samples = 0; },
     "robots.0.sensors.0.parameters.ray_sensors.0.samples: found 0, expected from 1 to 100000"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].samples = 100'001; },
     "robots.0.sensors.0.parameters.ray_sensors.0.samples: found 100001, expected from 1 to 100000"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].noise_variance = -1.0; },
     "robots.0.sensors.0.parameters.ray_sensors.0.noise_variance: found -1, expected at least 0"},
};

// The lanes of a peer.
TEST(Validate, NamesTheFaultOfASite) {
  const Fault faults[] = {
      {[](auto& w) { w.levels[1].z = -1.0; }, "level 1: it is not above level 0"},
      {[](auto& w) { w.levels[1].z = 0.0; }, "level 1: it is not above level 0"},
      {[](auto& w) { w.levels[0].z = kNan; }, "levels.0.z: found nan, expected at most 1e+06 in size"},
      {[](auto& w) { w.lane_graphs.push_back(w.lane_graphs[0]); },
       "lanes 0: they are not in the order of their numbers"},
      {[](auto& w) { w.lane_graphs[0].vertices[1].z = kInfinity; },
       "lane_graphs.0.vertices.1.z: found inf, expected at most 1e+06 in size"},
      {[](auto& w) { w.lane_graphs[0].vertices[0].lift = 0; }, "lanes 0: vertex 0: its lift does not exist"},
      {[](auto& w) {
         w.zones.push_back({.name = "z", .outline = {{0.0, 0.0}, {1.0, 0.0}}});
       },
       "zone 0: its outline is no normalized polygon"},
      {[](auto& w) { w.flows.push_back({.from = "a", .to = "a"}); }, "flow 0: it goes nowhere"},
      {[](auto& w) { w.timed_actions.push_back({.kind = TimedKind::kZone, .number = 5}); },
       "timed action 0: its zone does not exist"},
      {[](auto& w) { w.lane_graphs[0].lanes[0].end = 2; }, "lanes 0: lane 0: an end of it does not exist"},
      {[](auto& w) { w.lane_graphs[0].lanes[0].end = 0; }, "lanes 0: lane 0: its ends are one vertex"},
      {[](auto& w) { w.lane_graphs[0].lanes[0].speed_limit = -1.0; },
       "lane_graphs.0.lanes.0.speed_limit: found -1, expected at least 0 m/s"},
      {[](auto& w) { w.lane_graphs[0].lanes[0].facing = static_cast<LaneFacing>(3); },
       "lane_graphs.0.lanes.0.facing: found 3, expected a known kind"},
      {[](auto& w) {
         w.lane_graphs[0].lanes[0].doors = {{0, 1.0}};
       },
       "lanes 0: lane 0: a door of it does not exist"},
      {[](auto& w) {
         w.lane_trips = {{RobotId(9), {}, {}, {}}};
       },
       "lane_trips.0.robot: found 9, expected one of 2"},
      {[](auto& w) {
         w.lane_trips = {{RobotId(0), {99}, {}, {}}};
       },
       "trip 0: a goal of it does not exist"},
      {[](auto& w) {
         w.lane_trips = {{RobotId(0), {0}, {0, 1}, {0}}};
       },
       "trip 0: its path has not a step for each vertex"},
      {[](auto& w) {
         w.lane_trips = {{RobotId(0), {0}, {0, 1}, {0, 0}}};
       },
       "trip 0: its steps do not ascend from 0"},
  };
  for (const Fault& c : faults) {
    WorldDescription world = GoodWorld();
    world.levels = {{"L1", 0.0}, {"L2", 4.0}};
    world.lane_graphs = OneLane();
    ASSERT_TRUE(Validate(world).ok());
    c.change(world);
    const Status problem = Validate(world);
    ASSERT_FALSE(problem.ok()) << c.message;
    EXPECT_EQ(problem.error().message, c.message);
  }
}

TEST(Validate, ARemovedRobotHasNoRosDomain) {
  WorldDescription world = GoodWorld();
  world.robots[0].ros.domain = world.robots[1].ros.domain = 5;
  world.models[1].removed = true;
  const Status problem = Validate(world);
  EXPECT_TRUE(problem.ok()) << problem.error().message;
}

TEST(Validate, NamesTheFault) {
  for (const Fault& c : kFaults) {
    WorldDescription world = GoodWorld();
    c.change(world);
    const Status problem = Validate(world);
    ASSERT_FALSE(problem.ok()) << c.message;
    EXPECT_EQ(problem.error().message, c.message);
  }
}

// One of each kind, with values that are no defaults.
std::vector<SensorParameters> AllKinds() {
  RaySensorDescription ray{{1, 2, 3, 0.5}, {0.5, 9.0}, 2.0, 7, 0.1, 0.2, 0.3, {-0.5, 0.25}};
  return {
      RangerParameters{{ray, RaySensorDescription{}}},
      BreakBeamParameters{{{{1, 2}, {3, 4}, 5}}},
      FiducialParameters{{1, 2, 3, 0.5}, {0.5, 9.0}, 3.0, 2.0, -1'000'000'000, true},
      BumperParameters{{{{1, 2, 3, 0.5}, 0.25}, {{}, 1.0}}, 0.1},
      ContactParameters{},
      BlobfinderParameters{{1, 2, 3, 0.5}, 10, 20, 3.0, 1.0, {{0.1, 0.2, 0.3, 0.4}, {}}},
      CameraParameters{{1, 2, 3, 0.5}, 10, 20, {0.5, 9.0}, 1.0, {-0.2, 0.4}},
      RadioParameters{{1, 2, 3, 0.5}, 4, 20.0, 5e3, 0.2, 0.1, 0.2, 15.0, 2.5, 9.0, 4.0, true, 0.1, 0.05},
      ImuParameters{{1, 2, 3, 0.5}, 0.01, 0.02, 0.03, 0.04, 0.05},
  };
}

TEST(SensorDescription, ParametersOfEveryKindPass) {
  const std::vector<SensorParameters> kinds = AllKinds();
  ASSERT_EQ(kinds.size(), std::variant_size_v<SensorParameters>);
  for (const SensorParameters& parameters : kinds) {
    if (TypeOf(parameters) == "break_beam") continue;  // they belong to grippers
    EXPECT_TRUE(CheckParameters(parameters).ok()) << CheckParameters(parameters).error().message;
  }
}

TEST(SensorDescription, ValuesThatCannotBeAreRefused) {
  const SensorParameters cases[] = {
      FiducialParameters{.range = {2.0, 1.0}},
      FiducialParameters{.range = {-1.0, 1.0}},
      FiducialParameters{.id_range = std::nan("")},
      FiducialParameters{.fov = 7.0},
      BumperParameters{.segments = {{{}, -1.0}}},
      BumperParameters{.height = -0.1},
      BlobfinderParameters{.width = 0},
      BlobfinderParameters{.height = 5000},
      BlobfinderParameters{.fov = 6.4},
      CameraParameters{.fov = 0.0},
      CameraParameters{.elevation = {0.3, 0.3}},
      CameraParameters{.elevation = {0.0, 1.55}},
      CameraParameters{.X_MS = {2e6, 0, 0, 0}},
      RangerParameters{{{.X_MS = {}, .elevations = {0.2, 0.1}}}},
      RangerParameters{{{.X_MS = {}, .elevations = {1.5}}}},
      RangerParameters{{{.X_MS = {}, .samples = 100'000, .elevations = std::vector<double>(41, 0.0)}}},
      BreakBeamParameters{},
  };
  for (const SensorParameters& parameters : cases) EXPECT_FALSE(CheckParameters(parameters).ok());
}

TEST(SensorDescription, SummariesCount) {
  EXPECT_EQ(SummaryOf(AllKinds()[0]), "2 sensors, 15 rays");
  EXPECT_EQ(SummaryOf(AllKinds()[2]), "up to 9 m");
  EXPECT_EQ(SummaryOf(AllKinds()[3]), "2 segments");
  EXPECT_EQ(SummaryOf(AllKinds()[4]), "");
  EXPECT_EQ(SummaryOf(AllKinds()[5]), "10 x 20 pixels, 2 colors");
  EXPECT_EQ(SummaryOf(AllKinds()[6]), "10 x 20 pixels");
}

}  // namespace
}  // namespace troupe
