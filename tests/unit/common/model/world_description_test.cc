#include "troupe/world_description.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "common/model/find_robots.h"
#include "common/model/states.h"
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

TEST(WorldHash, ChangesWithEveryField) {
  const std::function<void(WorldDescription&)> changes[] = {
      [](WorldDescription&) {},
      [](WorldDescription& w) { w.name = "other"; },
      [](WorldDescription& w) { w.seed = 1; },
      [](WorldDescription& w) { ++w.interval_ns; },
      [](WorldDescription& w) { w.shapes[0].blocks[0].outline[0].x() += 1e-9; },
      [](WorldDescription& w) { w.shapes[0].blocks[0].z.max += 1e-9; },
      [](WorldDescription& w) { w.shapes[0].rectangles[0].max_y += 1e-9; },
      [](WorldDescription& w) { w.shapes[0].rectangles.push_back({}); },
      [](WorldDescription& w) { w.shapes[0].rectangles_z.min = -1.0; },
      [](WorldDescription& w) { w.models[0].name = "x"; },
      [](WorldDescription& w) { w.models[0].type = "x"; },
      [](WorldDescription& w) { w.models[1].parent.reset(); },
      [](WorldDescription& w) { w.models[1].X_PM.z += 1e-9; },
      [](WorldDescription& w) { w.models[1].shape = ShapeId(0); },
      [](WorldDescription& w) { w.models[1].size_x = 1.0; },
      [](WorldDescription& w) { w.models[1].size_y = 1.0; },
      [](WorldDescription& w) { w.models[1].size_z = 1.0; },
      [](WorldDescription& w) { w.models[1].color.a = 0.5; },
      [](WorldDescription& w) { w.models[1].obstacle_return = false; },
      [](WorldDescription& w) { w.models[1].ranger_return = -1.0; },
      [](WorldDescription& w) { w.models[1].gripper_return = true; },
      [](WorldDescription& w) { w.models[1].fiducial_return = -3; },
      [](WorldDescription& w) { w.models[1].show_nose = true; },
      [](WorldDescription& w) { w.robots[0].name = "x"; },
      [](WorldDescription& w) { w.robots[0].root = ModelId(0); },
      [](WorldDescription& w) { w.robots[0].drive.type = DriveType::kCar; },
      [](WorldDescription& w) { w.robots[0].drive.wheelbase = 2.0; },
      [](WorldDescription& w) { w.robots[0].drive.velocity.y.max = 2.0; },
      [](WorldDescription& w) { w.robots[0].drive.acceleration.heading.min = -2.0; },
      [](WorldDescription& w) { w.robots[0].localization.type = LocalizationType::kOdometry; },
      [](WorldDescription& w) { w.robots[0].localization.origin.x = 2.0; },
      [](WorldDescription& w) { w.robots[0].localization.error_heading = 2.0; },
      [](WorldDescription& w) { w.robots[0].sensors[0].name = "x"; },
      [](WorldDescription& w) { w.robots[0].sensors[0].model = ModelId(2); },
      [](WorldDescription& w) { w.robots[0].sensors[0].period_ticks = 2; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].X_MS.x = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].range.max = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].fov = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].samples = 2; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].noise_variance = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].noise_proportional = 2.0; },
      [](WorldDescription& w) { RaySensors(w.robots[0].sensors[0])[0].noise_angle = 2.0; },
      [](WorldDescription& w) { w.robots[0].sensors.clear(); },
      [](WorldDescription& w) { w.robots[0].controller.name = "wander"; },
      [](WorldDescription& w) { w.robots[0].controller.parameters = "{\"a\":1}"; },
      [](WorldDescription& w) { w.robots.clear(); },
      [](WorldDescription& w) {
        w.levels.push_back({"L1", 0.0});
      },
      [](WorldDescription& w) {
        w.levels.push_back({"L2", 0.0});
      },
      [](WorldDescription& w) {
        w.levels.push_back({"L2", 1.0});
      },
      [](WorldDescription& w) { w.lane_graphs = OneLane(); },
      [](WorldDescription& w) {
        w.lane_graphs = OneLane();
        w.lane_graphs[0].number = 3;
      },
      [](WorldDescription& w) {
        w.lane_graphs = OneLane();
        w.lane_graphs[0].vertices[1].is_charger = true;
      },
      [](WorldDescription& w) {
        w.lane_graphs = OneLane();
        w.lane_graphs[0].vertices[1].lift = 0;
      },
      [](WorldDescription& w) {
        w.lane_graphs = OneLane();
        w.lane_graphs[0].lanes[0].is_bidirectional = true;
      },
      [](WorldDescription& w) {
        w.lane_graphs = OneLane();
        w.lane_graphs[0].lanes[0].facing = LaneFacing::kBackward;
      },
      [](WorldDescription& w) {
        w.lane_graphs = OneLane();
        w.lane_graphs[0].lanes[0].doors = {{0, 0.5}};
      },
  };
  std::set<std::uint64_t> hashes;
  for (const auto& change : changes) {
    WorldDescription world = FullWorld();
    change(world);
    EXPECT_TRUE(hashes.insert(Hash(world)).second) << "change " << hashes.size();
  }
  EXPECT_EQ(Hash(FullWorld()), Hash(FullWorld()));
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
    {[](auto& w) { w.interval_ns = 0; }, "found a tick of 0 ns, expected 1 to 1000000000000"},
    {[](auto& w) { w.interval_ns = -5; }, "found a tick of -5 ns, expected 1 to 1000000000000"},
    {[](auto& w) { w.shapes[0].blocks[0].outline.resize(2); },
     "shape 0: the outline of a block is not usable: found 2 vertices, expected at least 3"},
    {[](auto& w) { std::swap(w.shapes[0].blocks[0].outline[0], w.shapes[0].blocks[0].outline[2]); },
     "shape 0: the outline of a block is not normalized"},
    {[](auto& w) {
       w.shapes[0].blocks[0].z = {1.0, 0.0};
     },
     "shape 0: the height interval of a block is not finite or upside down"},
    {[](auto& w) { w.shapes[0].rectangles[0].max_x = 0.0; }, "shape 0: a rectangle is not finite or has no area"},
    {[](auto& w) { w.shapes[0].rectangles[0].max_x = kInfinity; }, "shape 0: a rectangle is not finite or has no area"},
    {[](auto& w) { w.shapes[0].rectangles_z.max = kNan; },
     "shape 0: the height interval of the rectangles is not finite or upside down"},
    {[](auto& w) { w.models[0].name = ""; }, "model 0 '': it has no name"},
    {[](auto& w) { w.models[1].name = "m0"; }, "model 1 'm0': another model has the same name"},
    {[](auto& w) { w.models[0].parent = ModelId(0); }, "model 0 'm0': its parent does not precede it"},
    {[](auto& w) { w.models[0].parent = ModelId(9); }, "model 0 'm0': its parent does not precede it"},
    {[](auto& w) { w.models[0].shape = ShapeId(4); }, "model 0 'm0': it names a shape that does not exist"},
    {[](auto& w) { w.models[0].X_PM.x = kNan; }, "model 0 'm0': its pose is not finite or too far away"},
    {[](auto& w) { w.models[0].X_PM.x = 1e7; }, "model 0 'm0': its pose is not finite or too far away"},
    {[](auto& w) { w.models[0].size_x = kInfinity; }, "model 0 'm0': its size is not finite or too large"},
    {[](auto& w) { w.models[0].color.r = kNan; }, "model 0 'm0': its color is not finite"},
    {[](auto& w) { w.models[0].ranger_return = kNan; }, "model 0 'm0': its ranger_return is not finite or too large"},
    {[](auto& w) { w.robots[0].root = ModelId(77); }, "robot 0 'm1': its root model does not exist"},
    {[](auto& w) { w.robots[1] = w.robots[0]; }, "robot 1 'm1': it is not in the order of the root models"},
    {[](auto& w) { w.robots[0].root = ModelId(2); }, "robot 0 'm1': its root model has a parent"},
    {[](auto& w) { w.robots[0].name = "x"; }, "robot 0 'x': its root model has another name: 'm1'"},
    {[](auto& w) { w.robots[0].drive.wheelbase = 0.0; }, "robot 0 'm1': its wheelbase is not a positive number"},
    {[](auto& w) {
       w.robots[0].drive.velocity.x = {1.0, -1.0};
     },
     "robot 0 'm1': its velocity bounds are not intervals"},
    {[](auto& w) { w.robots[0].drive.velocity.x.max = kInfinity; },
     "robot 0 'm1': its velocity bounds are not intervals"},
    {[](auto& w) { w.robots[0].drive.acceleration.y.min = 1.0; },
     "robot 0 'm1': its acceleration bounds are not intervals around 0"},
    {[](auto& w) { w.robots[0].localization.origin.y = kNan; },
     "robot 0 'm1': its localization origin is not finite or too far away"},
    {[](auto& w) { w.robots[0].localization.error_x = kNan; },
     "robot 0 'm1': its odometry errors are not finite or too large"},
    {[](auto& w) { w.robots[0].ros.domain = 231; },
     "robot 0 'm1': found the ROS domain 231, expected at most 230: the ports of a higher one would exceed 65535"},
    {[](auto& w) { w.robots[0].ros.domain = w.robots[1].ros.domain = 5; },
     "found the ROS domain 5 for robot 'm3', which robot 'm1' has already, expected one for each robot"},
    {[](auto& w) { w.robots[0].sensors[0].model = ModelId(0); },
     "robot 0 'm1': its ranger 'ranger:0' is not one of its models"},
    {[](auto& w) { w.robots[0].sensors[0].model = ModelId(50); },
     "robot 0 'm1': its ranger 'ranger:0' is not one of its models"},
    {[](auto& w) { w.robots[0].sensors[0].period_ticks = 0; },
     "robot 0 'm1': its ranger 'ranger:0' has a period of no ticks"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].X_MS.x = kNan; },
     "robot 0 'm1': ranger 'ranger:0': ray_sensors.0.pose.x: found nan, expected at most 1e+06 in size"},
    {[](auto& w) {
       RaySensors(w.robots[0].sensors[0])[0].range = {-1.0, 1.0};
     },
     "robot 0 'm1': ranger 'ranger:0': ray_sensors.0.range.min: found -1, expected at least 0 m"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].fov = -0.1; },
     "robot 0 'm1': ranger 'ranger:0': ray_sensors.0.fov: found -0.1, expected at least 0 rad"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].samples = 0; },
     "robot 0 'm1': ranger 'ranger:0': ray_sensors.0.samples: found 0, expected from 1 to 100000"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].samples = 100'001; },
     "robot 0 'm1': ranger 'ranger:0': ray_sensors.0.samples: found 100001, expected from 1 to 100000"},
    {[](auto& w) { RaySensors(w.robots[0].sensors[0])[0].noise_variance = -1.0; },
     "robot 0 'm1': ranger 'ranger:0': ray_sensors.0.noise_variance: found -1, expected at least 0"},
};

// The lanes of a peer.
TEST(Validate, NamesTheFaultOfASite) {
  const Fault faults[] = {
      {[](auto& w) { w.levels[1].z = -1.0; }, "level 1: it is too far away or not above the one before it"},
      {[](auto& w) { w.levels[1].z = 0.0; }, "level 1: it is too far away or not above the one before it"},
      {[](auto& w) { w.levels[0].z = kNan; }, "level 0: it is too far away or not above the one before it"},
      {[](auto& w) { w.lane_graphs.push_back(w.lane_graphs[0]); },
       "lanes 0: they are not in the order of their numbers"},
      {[](auto& w) { w.lane_graphs[0].vertices[1].z = kInfinity; },
       "lanes 0: vertex 1: it is not finite or too far away"},
      {[](auto& w) { w.lane_graphs[0].vertices[0].lift = 0; }, "lanes 0: vertex 0: its lift does not exist"},
      {[](auto& w) { w.lane_graphs[0].lanes[0].end = 2; }, "lanes 0: lane 0: an end of it does not exist"},
      {[](auto& w) { w.lane_graphs[0].lanes[0].end = 0; }, "lanes 0: lane 0: its ends are one vertex"},
      {[](auto& w) { w.lane_graphs[0].lanes[0].speed_limit = -1.0; },
       "lanes 0: lane 0: its speed limit is negative or too large"},
      {[](auto& w) { w.lane_graphs[0].lanes[0].facing = static_cast<LaneFacing>(3); },
       "lanes 0: lane 0: the direction in which robots face does not exist"},
      {[](auto& w) {
         w.lane_graphs[0].lanes[0].doors = {{0, 1.0}};
       },
       "lanes 0: lane 0: a door of it does not exist"},
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
