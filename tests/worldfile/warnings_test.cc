// No statement of a file is dropped in silence.
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "common/model/states.h"
#include "tests/support/small_world.h"
#include "tests/support/stage_worlds.h"
#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

TEST(Warnings, NameEveryPropertyWithoutEffectAndTheReason) {
  EXPECT_THAT(
      WorldFolder().WarningsOf("resolution 0.02\nthreads 1\nmodel( debug 5\n gui_grid 1\n laser_return 1\n colour 3 )\n"
                               "window( size [1 1] )\n"),
      ElementsAre("w.world:1:1: warning: property 'resolution' has no effect: geometry is exact, without cells",
                  "w.world:2:1: warning: property 'threads' has no effect: each robot has its own process",
                  "w.world:3:8: warning: property 'debug' has no effect: it has none in Stage either",
                  "w.world:4:2: warning: no effect, because they only concern Stage's window: property 'gui_grid', "
                  "'window'",
                  "w.world:5:2: warning: property 'laser_return' has no effect: it is 'ranger_return' today",
                  "w.world:6:2: warning: property 'colour' has no effect in a 'model'"));
}

TEST(Warnings, NameTheWordOfTodayForAnOldOne) {
  const auto hint = [](const std::string& text) {
    const std::vector<std::string> warnings = WorldFolder().WarningsOf(text);
    EXPECT_EQ(warnings.size(), 1u) << text;
    return warnings.empty() ? "" : warnings[0].substr(warnings[0].find("property"));
  };
  EXPECT_EQ(hint("position( ranger( sensor( range_max 5 ) ) )"),
            "property 'range_max' has no effect: it is 'range [min max]' today");
  EXPECT_EQ(hint("position( ranger( range_max 5 sensor( ) ) )"),
            "property 'range_max' has no effect: it is 'range [min max]' of a 'sensor ( ... )' today");
  EXPECT_EQ(hint("position( ranger( spose[3] [0 0 0] sensor( ) ) )"),
            "property 'spose[3]' has no effect: it is 'pose' of a 'sensor ( ... )' today");
  EXPECT_EQ(hint("model( sonar_return 1 )"), "property 'sonar_return' has no effect: it is 'ranger_return' today");
  EXPECT_EQ(hint("position( fiducial( range 5 ) )"), "property 'range' has no effect: it is 'range_max' today");
  EXPECT_EQ(hint("position( blobfinder( channels [\"red\"] ) )"),
            "property 'channels' has no effect: they are 'colors' today");
  EXPECT_EQ(hint("position( steer \"car\" )"), "property 'steer' has no effect: it is 'drive' today");
  const WorldFolder folder;
  const auto error = [&](const std::string& text) {
    folder.Write("w.world", text);
    return folder.ErrorOf("w.world");
  };
  EXPECT_THAT(error("position( laser( ) )"), testing::HasSubstr("today it is a 'ranger' with a 'sensor ("));
  EXPECT_THAT(error("position( wifi( ) )"), testing::HasSubstr("today it is a 'radio'"));
  EXPECT_THAT(error("puck( )"), testing::HasSubstr("today it is a 'model' with 'gripper_return 1'"));
}

// Every type of Stage 4.3, and every property but `bitmap`.
constexpr char kAllOfStage[] = R"(
name "all"
resolution 0.02
interval_sim 100
quit_time 0
threads 1
show_clock 0
show_clock_interval 100
unit_length "m"
unit_angle "degrees"
speedup 1
test 0
paused 0
confirm_on_quit 0
model( name "m" pose [3 3 0 0] size [1 1 1] origin [0 0 0 0] update_interval 100 color "red" noblocks 0 boundary 0
 stack_children 1 obstacle_return 1 ranger_return 1 blob_return 1 gripper_return 0 fiducial_return 0 fiducial_key 0
 gui_nose 0 gui_grid 0 gui_outline 0 gui_move 0 mass 1 watts 0 give_watts 0 take_watts 0 joules 1 joules_capacity 2
 map_resolution 0.1 friction 0 say "hi" alwayson 0 debug 0 event_queue 0 trail_length 20 trail_interval 10 )
model( name "n" pose [5 5 0 0] color_rgba [1 0 0 1] kjoules 1 kjoules_capacity 2
 block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] ) )
position( name "p" update_interval 50 drive "diff" wheelbase 1 velocity [0 0 0 0]
 velocity_bounds [-1 1 -1 1 -1 1 -90 90] acceleration_bounds [-1 1 -1 1 -1 1 -90 90]
 localization "gps" localization_origin [0 0 0 0] odom_error [0.1 0.1 0 0.1]
 ranger( sensor( pose [0 0 0 0] size [0.02 0.02 0.02] range [0 5] fov 10 samples 2 noise [0 0 0] color "red" ) )
 gripper( autosnatch 0 paddle_size [0.66 0.1 0.4] paddle_state ["open" "down"] size [0.2 0.3 0.2] )
 fiducial( range_min 0 range_max 8 range_max_id 5 fov 180 ignore_zloc 0 )
 blobfinder( image [80 60] range 12 fov 60 pan 0 colors_count 1 colors ["red"] )
 bumper( noblocks 1 bcount 1 bpose[0] [0 0 0 0] blength 0.1 blength[0] 0.1 )
 actuator( type "linear" axis [1 0 0] max_speed 1 min_position 0 max_position 1 start_position 0 )
 camera( resolution [32 32] range [0.2 8] fov [70 40] pantilt [0 0] )
 blinkenlight( dutycycle 1 period 1000 enabled 1 )
 lightindicator( )
)
window( size [100 100] )
)";

// docs/stage-differences.md lists them.
TEST(Warnings, NameAllThatStageHasAndThatIsWithoutEffect) {
  std::set<std::string> named;
  const std::regex quoted("'([a-z_]+)'");
  const std::regex place(" in a '[a-z]+'");
  for (const std::string& text : WorldFolder().WarningsOf(kAllOfStage)) {
    const std::string warning = std::regex_replace(text, place, "");
    for (std::sregex_iterator match(warning.begin(), warning.end(), quoted), end; match != end; ++match) {
      named.insert((*match)[1]);
    }
  }
  EXPECT_THAT(named, testing::ElementsAre("alwayson", "blob_return", "color", "confirm_on_quit", "debug", "event_queue",
                                          "friction", "gui_grid", "gui_move", "gui_outline", "localization_origin",
                                          "map_resolution", "odom_error", "paused", "resolution", "say", "show_clock",
                                          "show_clock_interval", "test", "threads", "trail_interval", "trail_length",
                                          "update_interval", "velocity", "window"));
}

TEST(Warnings, StatementsForStagesWindowShareOne) {
  EXPECT_THAT(
      WorldFolder().WarningsOf("show_clock 1\nmodel( gui_grid 1 )\nmodel( gui_grid 0\n gui_outline 1 )\n"
                               "position( pose [5 0 0 0] ranger( sensor( color \"red\" ) ) )\nwindow( size [1 1] )\n"),
      ElementsAre("w.world:1:1: warning: no effect, because they only concern Stage's window: property "
                  "'show_clock', property 'gui_grid', property 'gui_outline', property 'color' of a sensor, "
                  "'window'"));
  EXPECT_THAT(WorldFolder().WarningsOf("model( )\nwindow( )\nwindow( )"),
              ElementsAre("w.world:2:1: warning: 'window' has no effect: it only concerns Stage's window"));
}

TEST(Warnings, AreGivenOnceForALineHoweverManyModelsItMakes) {
  std::string text = "define rob position( debug 5\n ranger( sensor( view 1 ) lightindicator( period 3 ) ) )\n";
  for (int i = 0; i < 100; ++i) text += "rob( pose [" + std::to_string(i) + " 0 0 0] )\n";
  EXPECT_THAT(WorldFolder().WarningsOf(text),
              ElementsAre("w.world:1:22: warning: property 'debug' has no effect: it has none in Stage either",
                          "w.world:2:18: warning: property 'view' has no effect: only older versions of Stage knew it",
                          "w.world:2:43: warning: property 'period' has no effect in a 'lightindicator'"));
}

TEST(Warnings, ValuesThatStageReadsInAnotherWayAreNamed) {
  EXPECT_THAT(
      WorldFolder().WarningsOf("model( pose [1 2 3 4 5]\n color \"reddish\"\n fiducial_return 1.5 )\n"
                               "model( color \"red\" color_rgba [1 1 1 1]\n)\nmodel( color_rgba [2 0 0 1] )\n"
                               "unit_length \"feet\"\nunit_angle \"turns\"\n"),
      ElementsAre("w.world:7:13: warning: unit_length 'feet' is not \"m\", \"cm\" or \"mm\"; metres are used",
                  "w.world:8:12: warning: unit_angle 'turns' is not \"degrees\" or \"radians\"; degrees are used",
                  "w.world:1:13: warning: found 5 values for 'pose', expected 4; the rest is ignored",
                  "w.world:2:8: warning: colour 'reddish' is not known; red is used",
                  "w.world:3:18: warning: found 1.5 for 'fiducial_return', expected a whole number; 1 is used",
                  "w.world:4:20: warning: property 'color_rgba' has no effect beside 'color'",
                  "w.world:6:19: warning: found a colour beyond 0 to 1; it is clamped"));
}

TEST(Warnings, QuotedNumbersAreRead) {
  const WorldFolder folder;
  EXPECT_THAT(folder.WarningsOf("model( pose [\"1\" 2 \"-3.5\" 0] obstacle_return \"0\" )"), SizeIs(0));
}

TEST(Warnings, ReportAMapThatIsSeenButNeverHit) {
  EXPECT_THAT(WorldFolder().WarningsOf(
                  "define floorplan model( obstacle_return 0 )\nfloorplan( name \"hall\" bitmap \"map.pgm\" )"),
              testing::Contains("w.world:1:41: warning: map 'hall' is seen but never hit: its 'obstacle_return' is 0"));
}

TEST(Warnings, StateTheSizeOfABitmapWithAndWithoutItsBlankMargin) {
  const WorldFolder folder;
  const auto margin = [&](const std::string& row, int width) {
    std::string image = "P2 " + std::to_string(width) + " 1 255\n" + row;
    folder.Write("margin.pgm", image);
    return folder.WarningsOf("model( bitmap \"margin.pgm\" )");
  };
  EXPECT_THAT(
      margin("255 0 0 255", 4),
      ElementsAre("w.world:1:15: warning: bitmap 'margin.pgm' has a blank margin: it is 4 x 1 pixels, but 2 x 1 "
                  "pixels without its margin, and those are stretched to the model's size, as in Stage"));
  EXPECT_THAT(margin("0 255 255 0", 4), SizeIs(0));
  std::string wide;
  for (int x = 0; x < 99; ++x) wide += "0 ";
  EXPECT_THAT(margin(wide + "255", 100), SizeIs(0));  // 1 percent
}

TEST(Warnings, NameRobotsThatStartInsideSomething) {
  EXPECT_THAT(WorldFolder().WarningsOf("define wall model( size [1 1 1] )\n"
                                       "wall( name \"a\" )\nwall( name \"b\" obstacle_return 0 pose [5 0 0 0] )\n"
                                       "wall( name \"table\" pose [8 0 1 0] )\n"
                                       "position( name \"in_a\" pose [0.6 0 0 0] )\n"
                                       "position( name \"touches_a\" pose [-0.7 0 0 0] )\n"
                                       "position( name \"in_b\" pose [5 0 0 0] )\n"
                                       "position( name \"under_table\" pose [8 0 0 0] )\n"
                                       "position( name \"on_robot\" pose [8.3 0 0.5 0] model( ) )\n"),
              ElementsAre("w.world: warning: robot 'in_a' starts inside 'a', so it may be stuck",
                          "w.world: warning: robot 'under_table' starts inside 'on_robot', so it may be stuck",
                          "w.world: warning: robot 'on_robot' starts inside 'table', so it may be stuck"));
}

TEST(Warnings, SizeOfZeroLeavesNoBody) {
  EXPECT_THAT(WorldFolder().WarningsOf("model( size [0 0 0] )"),
              ElementsAre("w.world:1:13: warning: this model has a size of 0, so it has no body"));
}

// Worlds of the Stage project.

using testing::Each;
using testing::Field;

class StageWorlds : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::StageWorldsFolder();
    if (!std::filesystem::exists(folder_ + "/simple.world")) {
      GTEST_SKIP() << "no Stage worlds in " << folder_ << "; set TROUPE_STAGE_WORLDS";
    }
  }

  LoadedWorld Load(const std::string& name) const { return LoadValid(folder_ + "/" + name); }

  // The height of a ray above the ground.
  static double RayHeight(const LoadedWorld& loaded, std::size_t robot, std::size_t ranger) {
    const SensorDescription& description = loaded.world.robots[robot].sensors[ranger];
    return ModelPoses(loaded.world, PlacedState(loaded.world))[description.model.index()].z +
           RaySensors(description)[0].X_MS.z;
  }

  std::string folder_;
};

TEST_F(StageWorlds, SimpleWorldLoads) {
  const LoadedWorld loaded = Load("simple.world");
  ASSERT_EQ(loaded.world.robots.size(), 2u);
  EXPECT_EQ(loaded.world.models.size(), 7u);
  EXPECT_EQ(loaded.world.robots[0].name, "r0");
  EXPECT_EQ(loaded.world.robots[1].name, "r1");
  EXPECT_THAT(loaded.world.robots,
              Each(Field(&RobotDescription::controller, Field(&ControllerDescription::name, "wander"))));
  EXPECT_EQ(loaded.settings.ticks, 36000u);
  EXPECT_EQ(loaded.map_width, 500);
  const Shape& cave = loaded.world.shape(loaded.world.models[0].shape);
  EXPECT_GT(cave.rectangles.size(), 100u);
  EXPECT_EQ(cave.blocks.size(), 4u);  // its boundary
  EXPECT_EQ(cave.rectangles_z, (ZRange{0.0, 0.8}));
  Rectangle bounds = Rectangle::Nothing();
  for (const Rectangle& r : cave.rectangles) bounds.Extend(r);
  EXPECT_EQ(bounds, (Rectangle{-8, -8, 8, 8}));
}

TEST_F(StageWorlds, RangersOfThePioneerHaveTheirHeights) {
  const LoadedWorld loaded = Load("simple.world");
  ASSERT_EQ(loaded.world.robots[0].sensors.size(), 2u);
  EXPECT_EQ(loaded.world.robots[0].sensors[0].name, "ranger:0");
  EXPECT_EQ(RaySensors(loaded.world.robots[0].sensors[0]).size(), 16u);
  EXPECT_EQ(RaySensors(loaded.world.robots[0].sensors[1])[0].samples, 180u);
  // On top of the robot (0.22) and 0.03 lower, plus half of the 0.01 high sonar.
  EXPECT_NEAR(RayHeight(loaded, 0, 0), 0.195, 1e-12);
  // On top of the robot, the sensor 0.1 higher, plus half of its default height.
  EXPECT_NEAR(RayHeight(loaded, 0, 1), 0.33, 1e-12);
}

TEST_F(StageWorlds, NoModelIsWithoutEffectAndNoControllerUnknown) {
  int worlds = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
    if (entry.path().extension() != ".world") continue;
    ++worlds;
    for (const Warning& warning : Load(std::filesystem::relative(entry.path(), folder_).string()).warnings) {
      EXPECT_THAT(warning.ToString(), testing::Not(testing::HasSubstr("not simulated yet")));
      EXPECT_THAT(warning.ToString(), testing::Not(testing::HasSubstr("is not known")));
    }
  }
  EXPECT_GE(worlds, 3);
}

TEST_F(StageWorlds, LaboratoryLoads) {
  const LoadedWorld loaded = Load("uoa_robotics_lab.world");
  ASSERT_EQ(loaded.world.robots.size(), 1u);
  EXPECT_EQ(loaded.world.models.size(), 29u);
  EXPECT_EQ(loaded.world.models[1].name, "r0");
  EXPECT_EQ(loaded.world.models[7].name, "model:1");  // the first table; the map was model 0
  const Shape& table = loaded.world.shape(loaded.world.models[7].shape);
  EXPECT_EQ(table.blocks.size(), 13u);
  EXPECT_NEAR(table.blocks[0].z.max, 0.725, 1e-12);
  EXPECT_NEAR(table.blocks[1].z.min, 0.959 * 0.725, 1e-12);
  EXPECT_EQ(loaded.world.models[7].shape, loaded.world.models[8].shape);
}

TEST_F(StageWorlds, CaveBenchmarkLoads) {
  const LoadedWorld loaded = Load("benchmark/cave.world");
  ASSERT_EQ(loaded.world.robots.size(), 100u);
  EXPECT_EQ(loaded.world.models.size(), 301u);
  EXPECT_EQ(loaded.world.shapes.size(), 4u);
  EXPECT_THAT(loaded.world.robots,
              Each(Field(&RobotDescription::controller, Field(&ControllerDescription::name, "expand"))));
  EXPECT_EQ(loaded.world.robots[99].name, "position:99");
  EXPECT_FALSE(loaded.world.models[0].obstacle_return);
  EXPECT_EQ(loaded.world.models[0].ranger_return, 0.5);
  EXPECT_LE(loaded.warnings.size(), 20u);
}

}  // namespace
}  // namespace troupe
