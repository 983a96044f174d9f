// No statement of a file is dropped in silence.
#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

TEST(Warnings, NameEveryPropertyWithoutEffectAndTheReason) {
  EXPECT_THAT(
      WorldFolder().WarningsOf("resolution 0.02\nspeedup 1\nmodel( debug 5\n gui_grid 1\n laser_return 1\n colour 3 )\n"
                               "window( size [1 1] )\n"),
      ElementsAre("w.world:1:1: warning: property 'resolution' has no effect: geometry is exact, without cells",
                  "w.world:2:1: warning: property 'speedup' has no effect: the command line sets the speed",
                  "w.world:3:8: warning: property 'debug' has no effect: it has none in Stage either",
                  "w.world:4:2: warning: no effect, because they only concern Stage's window: property 'gui_grid', "
                  "'window'",
                  "w.world:5:2: warning: property 'laser_return' has no effect: only older versions of Stage knew it",
                  "w.world:6:2: warning: property 'colour' has no effect in a 'model'"));
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
  EXPECT_THAT(
      WorldFolder().WarningsOf(text),
      ElementsAre(
          "w.world:1:22: warning: property 'debug' has no effect: it has none in Stage either",
          "w.world:2:18: warning: property 'view' has no effect: only older versions of Stage knew it",
          "w.world:2:27: warning: 'lightindicator' models are not simulated yet; they are only bodies",
          "w.world:2:43: warning: property 'period' has no effect: 'lightindicator' models are not simulated yet"));
}

TEST(Warnings, NameAMacroOfATypeThatIsNotSimulatedOnce) {
  EXPECT_THAT(
      WorldFolder().WarningsOf(
          "define skirt lightindicator( )\nposition( skirt( )\n skirt( ) )\nskirt( pose [5 0 0 0] )\n"),
      ElementsAre("w.world:2:11: warning: 'skirt' is only a body: 'lightindicator' models are not simulated yet"));
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
              ElementsAre("w.world:1:41: warning: map 'hall' is seen but never hit: its 'obstacle_return' is 0"));
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

}  // namespace
}  // namespace troupe
