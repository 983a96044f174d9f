// The descriptions of `position` and `ranger` models: robots with drives, localization, sensors and controllers.
#include "robot-agent/controller/create_controller.h"
#include "tests/support/small_world.h"
#include "tests/worldfile/world_folder.h"
#include "troupe/pose.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RobotDescription RobotOf(const std::string& text, const LoadOverrides& overrides = {}) {
  const LoadedWorld loaded = WorldFolder().LoadText(text, overrides);
  if (loaded.world.robots.size() != 1) {
    ADD_FAILURE() << loaded.world.robots.size() << " robots";
    return {};
  }
  return loaded.world.robots[0];
}

TEST(Robots, DefaultsAreThoseOfStage) {
  const RobotDescription robot = RobotOf("position( )");
  EXPECT_EQ(robot.name, "position:0");
  EXPECT_EQ(robot.drive.type, DriveType::kDifferential);
  EXPECT_EQ(robot.drive.velocity.x, (Interval{-1.0, 1.0}));
  EXPECT_EQ(robot.drive.velocity.heading, (Interval{-0.5 * kPi, 0.5 * kPi}));
  EXPECT_EQ(robot.drive.acceleration, robot.drive.velocity);
  EXPECT_EQ(robot.localization.type, LocalizationType::kGps);
  EXPECT_EQ(robot.controller.name, "idle");
  EXPECT_THAT(robot.sensors, IsEmpty());
}

TEST(Robots, DriveIsRead) {
  const RobotDescription robot = RobotOf(
      "position( drive \"car\" wheelbase 2 velocity_bounds [-1 2 -3 4 -5 6 -90 180]\n"
      "acceleration_bounds [-0.5 0.25 0 0 0 0 -45 90] )");
  EXPECT_EQ(robot.drive.type, DriveType::kCar);
  EXPECT_EQ(robot.drive.wheelbase, 2.0);
  EXPECT_EQ(robot.drive.velocity.x, (Interval{-1, 2}));
  EXPECT_EQ(robot.drive.velocity.y, (Interval{-3, 4}));
  EXPECT_EQ(robot.drive.velocity.heading, (Interval{-0.5 * kPi, kPi}));
  EXPECT_EQ(robot.drive.acceleration.x, (Interval{-0.5, 0.25}));
}

TEST(Robots, OdometryStartsWhereTheRobotIsSeenFromItsOrigin) {
  EXPECT_EQ(RobotOf("position( pose [3 4 0 90] localization \"odom\" )").localization.origin, Pose{});
  const Pose world =
      RobotOf("position( pose [3 4 0 90] localization \"odom\" localization_origin [0 0 0 0] )").localization.origin;
  EXPECT_EQ(world, (Pose{3, 4, 0, 0.5 * kPi}));
  const Pose turned =
      RobotOf("position( pose [3 4 0 90] localization \"odom\" localization_origin [3 0 0 90] )").localization.origin;
  EXPECT_NEAR(turned.x, 4.0, 1e-12);
  EXPECT_NEAR(turned.y, 0.0, 1e-12);
  EXPECT_NEAR(turned.heading, 0.0, 1e-12);
}

TEST(Robots, OdometryErrorsAreProportions) {
  const LocalizationDescription odometry =
      RobotOf("position( localization \"odom\" odom_error [0.1 0.2 0 0.3] )").localization;
  EXPECT_EQ(odometry.error_x, 0.1);
  EXPECT_EQ(odometry.error_y, 0.2);
  EXPECT_EQ(odometry.error_heading, 0.3);
}

TEST(Robots, OdometryWithoutErrorsDrawsThemFromTheSeed) {
  const auto errors = [](std::uint64_t seed) {
    LoadOverrides overrides;
    overrides.seed = seed;
    return RobotOf("position( localization \"odom\" )", overrides).localization;
  };
  EXPECT_EQ(errors(1).error_x, errors(1).error_x);
  EXPECT_NE(errors(1).error_x, errors(2).error_x);
  EXPECT_LE(std::abs(errors(1).error_x), 0.015);
  EXPECT_LE(std::abs(errors(1).error_heading), 0.025);
}

TEST(Robots, SensorsRayHeightIncludesHalfTheSensor) {
  const RobotDescription robot = RobotOf(
      "position( ranger( origin [0.1 0 0.5 90] sensor( pose [1 0 0.2 0] size [1 1 0.06] range [0.5 8] fov 90 samples 7 "
      "noise [0.01 0.02 1] ) sensor( ) ) )");
  ASSERT_EQ(robot.sensors.size(), 1u);
  EXPECT_EQ(robot.sensors[0].name, "ranger:0");
  EXPECT_EQ(robot.sensors[0].model, ModelId(1));
  ASSERT_EQ(RaySensors(robot.sensors[0]).size(), 2u);
  const RaySensorDescription& sensor = RaySensors(robot.sensors[0])[0];
  EXPECT_NEAR(sensor.X_MS.x, 0.1, 1e-12);
  EXPECT_NEAR(sensor.X_MS.y, 1.0, 1e-12);
  EXPECT_NEAR(sensor.X_MS.z, 0.73, 1e-12);
  EXPECT_NEAR(sensor.X_MS.heading, 0.5 * kPi, 1e-12);
  EXPECT_EQ(sensor.range, (Interval{0.5, 8.0}));
  EXPECT_EQ(sensor.fov, 0.5 * kPi);
  EXPECT_EQ(sensor.samples, 7u);
  EXPECT_EQ(sensor.noise_variance, 0.01);
  EXPECT_EQ(sensor.noise_proportional, 0.02);
  EXPECT_NEAR(sensor.noise_angle, kPi / 180.0, 1e-15);
  const RaySensorDescription& standard = RaySensors(robot.sensors[0])[1];
  EXPECT_NEAR(standard.X_MS.z, 0.51, 1e-12);
  EXPECT_EQ(standard.range, (Interval{0.0, 5.0}));
  EXPECT_EQ(standard.fov, 0.1);
  EXPECT_EQ(standard.samples, 1u);
}

TEST(Robots, UpdateIntervalsAreRoundedUpToTicks) {
  for (const auto& [interval, ticks] : {std::pair("100", 1u), {"40", 1u}, {"0", 1u}, {"101", 2u}, {"250", 3u}}) {
    const RobotDescription robot =
        RobotOf(std::string("position( ranger( sensor( ) update_interval ") + interval + " ) )");
    EXPECT_EQ(robot.sensors[0].period_ticks, ticks) << interval;
  }
}

TEST(Robots, FullTurnInRadiansMayBeRoundedUp) {
  const RobotDescription robot =
      RobotOf("unit_angle \"radians\"\nposition( ranger( sensor( fov 6.2832 samples 2 ) ) )");
  EXPECT_EQ(RaySensors(robot.sensors[0])[0].fov, 2.0 * kPi);
}

TEST(Robots, ControllersOfStageMapToOurs) {
  EXPECT_EQ(RobotOf("position( ctrl \"wander\" )").controller.name, "wander");
  EXPECT_EQ(RobotOf("position( ctrl \"expand_pioneer\" )").controller.name, "expand");
  EXPECT_EQ(RobotOf("position( ctrl \"expand_swarm\" )").controller.name, "expand");
  for (const char* name : {"dynamic", "fasr", "fasr2", "fasr_plan", "follow", "go_to", "idle", "lanes", "lasernoise",
                           "patrol", "pioneer_flocking", "rasterize", "sink", "slotcar", "source", "vda5050"}) {
    EXPECT_EQ(RobotOf(std::string("position( ctrl \"") + name + "\" )").controller.name, name);
  }
  EXPECT_EQ(RobotOf("position( ctrl [\"fly\" \"wander\"] )").controller.name, "wander");
}

TEST(Robots, ArgumentsAfterTheNameAreParameters) {
  const auto parameters = [](const std::string& text) {
    return RobotOf("position( ctrl \"" + text + "\" )").controller.parameters;
  };
  EXPECT_EQ(parameters("wander"), "{}");
  EXPECT_EQ(parameters("wander  1 2 "), R"({"min_distance":2,"speed":1})");
  EXPECT_EQ(parameters("wander turn_rate=0.5 1"), R"({"speed":1,"turn_rate":0.5})");
  EXPECT_EQ(parameters("lanes lounge 12 wait=5 pantry"), R"({"places":["lounge","12","pantry"],"wait":5})");
  EXPECT_EQ(parameters("expand_swarm 0.3"), R"({"speed":0.3})");
  EXPECT_EQ(parameters("fasr [1,2] 7"), R"({"sink":7,"source":[1,2]})");
  EXPECT_EQ(parameters("patrol waypoints=[[1,2],[3,4]]"), R"({"waypoints":[[1,2],[3,4]]})");
  EXPECT_EQ(parameters("wander +.5"), R"({"speed":0.5})");
  EXPECT_THAT(WorldFolder().WarningsOf("position( ctrl \"wander 1 2 3\" )"),
              ElementsAre("w.world:1:16: warning: argument '3' of controller 'wander' is ignored"));
}

TEST(Robots, ArgumentsThatCannotBeReadAreIgnored) {
  const std::string deep(100000, '[');
  for (const std::string& argument : {std::string("[1,2"), std::string("speed="), std::string("=1"), deep}) {
    const WorldFolder folder;
    const std::string text = "position( ctrl \"wander " + argument + " turn_rate=0.5\" )";
    const std::vector<std::string> warnings = folder.WarningsOf(text);
    ASSERT_EQ(warnings.size(), 1u) << argument.substr(0, 10);
    EXPECT_THAT(warnings[0], testing::StartsWith("w.world:1:16: warning: argument '" + argument.substr(0, 4)));
    EXPECT_LT(warnings[0].size(), 400u);
    EXPECT_EQ(folder.LoadText(text).world.robots[0].controller.parameters, R"({"turn_rate":0.5})");
  }
}

// By the controllers themselves.
std::vector<std::string> Checked(const std::string& ctrl, ControllerDescription& controller) {
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  const LoadedWorld loaded = WorldFolder().LoadText("\nposition( ctrl \"" + ctrl + "\" )", overrides);
  controller = loaded.world.robots.at(0).controller;
  std::vector<std::string> messages;
  for (const Warning& warning : loaded.warnings) {
    EXPECT_EQ(warning.where.line, 2);
    messages.push_back(warning.message);
  }
  return messages;
}

TEST(Robots, ArgumentsThatTheControllerCannotUseAreIgnored) {
  ControllerDescription controller;
  EXPECT_THAT(
      Checked("wander fast 2", controller),
      ElementsAre("argument 'fast' of controller 'wander' is ignored: it would be parameter 'speed', but wander: "
                  "found the string 'fast' as 'speed', expected a number between 0 and 100"));
  EXPECT_EQ(controller.parameters, R"({"min_distance":2})");
  EXPECT_THAT(
      Checked("wander speed=-1", controller),
      ElementsAre("argument 'speed=-1' of controller 'wander' is ignored: wander: found the number -1 as 'speed', "
                  "expected a number between 0 and 100"));
  EXPECT_EQ(controller.parameters, "{}");
  EXPECT_EQ(Checked("wander a b sped=3 0.5", controller).size(), 4u);
  EXPECT_EQ(controller.parameters, "{}");
  EXPECT_EQ(controller.name, "wander");
}

TEST(Robots, AControllerThatCannotDoWithoutArgumentsIsNone) {
  ControllerDescription controller;
  EXPECT_THAT(Checked("patrol red", controller),
              ElementsAre("argument 'red' of controller 'patrol' is ignored",
                          testing::StartsWith("controller 'patrol' cannot be used, so the robot has none (patrol: ")));
  EXPECT_EQ(controller.name, "idle");
  EXPECT_THAT(Checked("patrol waypoints=[[1,2],[3,4]] speed=fast", controller),
              ElementsAre(testing::StartsWith("argument 'speed=fast' of controller 'patrol' is ignored: patrol: ")));
  EXPECT_EQ(controller.parameters, R"({"waypoints":[[1,2],[3,4]]})");
}

TEST(Robots, CarriersKnowThePlacesOfSourceAndSink) {
  const std::string places =
      "model( name \"source\" pose [1 2 0 0] ctrl \"source\" )\nmodel( name \"sink\" pose [-3 4 0 0] )\n";
  EXPECT_THAT(WorldFolder().WarningsOf(places), ElementsAre());
  const auto parameters = [&](const std::string& robot) {
    return WorldFolder().LoadText(robot + "\n" + places).world.robots[0].controller.parameters;
  };
  EXPECT_EQ(parameters("position( pose [9 9 0 0] ctrl \"fasr\" )"), R"({"sink":[-3.0,4.0],"source":[1.0,2.0]})");
  EXPECT_EQ(parameters("position( pose [9 9 0 0] ctrl \"fasr 5\" )"), R"({"sink":[-3.0,4.0],"source":5})");
  EXPECT_EQ(parameters("position( pose [9 9 0 0] localization \"odom\" odom_error [0 0 0 0] "
                       "localization_origin [1 1 0 0] ctrl \"fasr_plan\" )"),
            R"({"sink":[-4.0,3.0],"source":[0.0,1.0]})");
  EXPECT_EQ(parameters("position( pose [9 9 0 0] ctrl \"wander\" )"), "{}");
}

TEST(Robots, UnknownControllerIdlesWithAWarning) {
  EXPECT_EQ(RobotOf("position( ctrl \"fly 1 2\" )").controller.name, "idle");
  EXPECT_THAT(WorldFolder().WarningsOf("position( ctrl \"fly 1 2\" )"),
              ElementsAre("w.world:1:16: warning: controller 'fly' is not known; the robot has none"));
}

TEST(Robots, ControllerOfTheCommandLineIsForRobotsWithoutOne) {
  LoadOverrides overrides;
  overrides.controller = "script";
  const LoadedWorld loaded =
      WorldFolder().LoadText("position( )\nposition( ctrl \"wander\" )\nposition( ctrl \"fly\" )\n", overrides);
  EXPECT_EQ(loaded.world.robots[0].controller.name, "script");
  EXPECT_EQ(loaded.world.robots[1].controller.name, "wander");
  EXPECT_EQ(loaded.world.robots[2].controller.name, "script");
}

TEST(Robots, PositionBelowAStaticModelIsARobotOfTheWorld) {
  const WorldFolder folder;
  const std::string text = "model( pose [1 0 0 90] size [1 1 2] position( pose [1 0 0 0] model( ) ) )";
  const LoadedWorld loaded = folder.LoadText(text);
  ASSERT_EQ(loaded.world.robots.size(), 1u);
  EXPECT_EQ(loaded.world.robots[0].name, "model:0.position:0");
  const ModelDescription& root = loaded.world.model(loaded.world.robots[0].root);
  EXPECT_FALSE(root.parent);
  EXPECT_NEAR(root.X_PM.x, 1.0, 1e-12);
  EXPECT_NEAR(root.X_PM.y, 1.0, 1e-12);
  EXPECT_EQ(root.X_PM.z, 2.0);
  EXPECT_EQ(loaded.world.models[2].parent, loaded.world.robots[0].root);
  EXPECT_THAT(folder.WarningsOf(text), ElementsAre(HasSubstr("is placed in the world by itself")));
}

TEST(Robots, PositionOnARobotMovesWithIt) {
  const WorldFolder folder;
  const std::string text = "position( model( position( ranger( sensor( ) ) ) ) )";
  const LoadedWorld loaded = folder.LoadText(text);
  ASSERT_EQ(loaded.world.robots.size(), 1u);
  ASSERT_EQ(loaded.world.robots[0].sensors.size(), 1u);
  EXPECT_EQ(loaded.world.robots[0].sensors[0].name, "model:0.position:0.ranger:0");
  EXPECT_EQ(loaded.world.models[2].parent, ModelId(1));
  EXPECT_THAT(folder.WarningsOf(text), ElementsAre(HasSubstr("its own drive is not simulated")));
}

TEST(Robots, RangerOnNoRobotMeasuresNothing) {
  EXPECT_THAT(WorldFolder().WarningsOf("model( ranger( sensor( ) ) )"),
              ElementsAre("w.world:1:8: warning: this ranger is on no robot, so it measures nothing"));
}

TEST(Robots, SpeedupIsTheSpeedOfAWatchedRun) {
  const auto settings = [](const std::string& text) { return WorldFolder().LoadText(text).settings; };
  EXPECT_EQ(settings("speedup 2.5\n").watched_speed, 2.5);
  EXPECT_EQ(settings("speedup 2.5\n").speed, std::nullopt);
  EXPECT_EQ(settings("speedup -1\n").watched_speed, std::nullopt);  // as fast as possible
  EXPECT_EQ(settings("name \"w\"\n").watched_speed, 1.0);
}

TEST(World, SettingsAreRead) {
  const LoadedWorld loaded = WorldFolder().LoadText("name \"lab\"\ninterval_sim 20\nquit_time 0.05\n");
  EXPECT_EQ(loaded.world.name, "lab");
  EXPECT_EQ(loaded.world.interval_ns, 20'000'000);
  EXPECT_EQ(loaded.settings.ticks, 3u);
}

TEST(World, DefaultsAreThoseOfStage) {
  const LoadedWorld loaded = WorldFolder().LoadText("");
  EXPECT_EQ(loaded.world.name, "w.world");
  EXPECT_EQ(loaded.world.interval_ns, 100'000'000);
  EXPECT_FALSE(loaded.settings.ticks);
  EXPECT_THAT(loaded.warnings, IsEmpty());
}

}  // namespace
}  // namespace troupe
