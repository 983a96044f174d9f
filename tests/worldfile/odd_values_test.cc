// Values that Stage reads, and that are not meant so: each loads with its nearest sensible meaning and a warning
// (docs/world-files.md lists them).
#include <string>
#include <vector>

#include "tests/support/small_world.h"
#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

using testing::ElementsAre;

struct OddValue {
  const char* name;
  std::string text;
  std::vector<std::string> warnings;  // without "w.world:"
};

const OddValue kOddValues[] = {
    {"interval of zero",
     "interval_sim 0",
     {"1:14: warning: found 0 for 'interval_sim', expected 0.001 to 1000000; 100 is used"}},
    {"negative interval",
     "interval_sim -100",
     {"1:14: warning: found -100 for 'interval_sim', expected 0.001 to 1000000; 100 is used"}},
    {"interval as text",
     "interval_sim \"fast\"",
     {"1:14: warning: found string 'fast' for 'interval_sim', expected a number; the default is used"}},
    {"negative quit time",
     "quit_time -1",
     {"1:11: warning: found -1 for 'quit_time', expected 0 to 1000000000; 0 is used"}},
    {"world name of two values",
     "name [\"a\" \"b\"]",
     {"1:6: warning: found 2 values for 'name', expected one string; the first is used"}},
    {"pose with text",
     "model( pose [0 0 \"high\" 0] )",
     {"1:13: warning: found string 'high' for 'pose', expected a number; 0 is used"}},
    {"pose far away",
     "model( pose [10000000000 0 0 0] )",
     {"1:13: warning: found '10000000000' for 'pose', expected a number of at most 1000000; 1000000 is used"}},
    {"negative size",
     "model( size [1 -1 1] )",
     {"1:13: warning: found a negative size, expected values of at least 0; the sign is ignored"}},
    {"size that is not a number",
     "model( size [\"nan\" 1 1] )",
     {"1:13: warning: found string 'nan' for 'size', expected a number; 0 is used",
      "1:13: warning: this model has a size of 0, so it has no body"}},
    {"infinite size",
     "model( size [\"inf\" 1 1] )",
     {"1:13: warning: found string 'inf' for 'size', expected a number; 0 is used",
      "1:13: warning: this model has a size of 0, so it has no body"}},
    {"huge size",
     "model( size [100000000 1 1] )",
     {"1:13: warning: found '100000000' for 'size', expected a number of at most 1000000; 1000000 is used"}},
    {"name twice",
     "model( name \"a\" )\nmodel( name \"a\" )",
     {"2:13: warning: found name 'a' twice, expected each name once (first at w.world:1); the others get a number, as "
      "in 'a:2'"}},
    {"global name twice",
     "define r position( model( name \"/arm\" ) )\nr( )\nr( )",
     {"1:32: warning: found name 'arm' twice, expected each name once (first at w.world:1); the others get a number, "
      "as in 'arm:2'"}},
    {"empty name",
     "model( name \"\" )",
     {"1:13: warning: found a 'name' that cannot be one; the model is called 'model:0'"}},
    {"name that is a number",
     "model( name 5 )",
     {"1:13: warning: found a name that is not a string, expected it in quotes; it is read as '5'"}},
    {"colour as two values",
     "model( color [\"red\" \"blue\"] )",
     {"1:14: warning: found 2 values for 'color', expected one string; the first is used"}},
    {"fiducial return out of range",
     "model( fiducial_return 5000000000 )",
     {"1:24: warning: found '5000000000' for 'fiducial_return', expected a number of at most 1000000000; 1000000000 is "
      "used"}},
    {"block without points",
     "model( block( z [0 1] ) )",
     {"1:8: warning: found a block that is no simple polygon: found 0 vertices, expected at least 3; it is left out"}},
    {"block of two points",
     "model( block( points 2 point[0] [0 0] point[1] [1 0] ) )",
     {"1:8: warning: found a block that is no simple polygon: found 2 vertices, expected at least 3; it is left out"}},
    {"block with a point missing",
     "model( block( points 3 point[0] [0 0] point[2] [1 0] z [0 1] ) )",
     {"1:8: warning: found a block of 3 points without 'point[1]', expected all of them; it is [0 0]",
      "1:8: warning: found a block that is no simple polygon: the outline has no area; it is left out"}},
    {"block without area",
     "model( block( points 3 point[0] [0 0] point[1] [1 1] point[2] [2 2] z [0 1] ) )",
     {"1:8: warning: found a block that is no simple polygon: the outline has no area; it is left out"}},
    {"block of equal points",
     "model( block( points 4 point[0] [1 1] point[1] [1 1] point[2] [1 1] point[3] [1 1] z [0 1] ) )",
     {"1:8: warning: found a block that is no simple polygon: the outline has no area; it is left out"}},
    {"block that crosses itself",
     "model(\n  block( points 4 point[0] [0 0] point[1] [1 1] point[2] [1 0] point[3] [0 1] z [0 1] ) )",
     {"2:3: warning: found a block that is no simple polygon: edges of the outline cross each other; its convex hull "
      "is used"}},
    {"block upside down",
     "model( block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [1 0] ) )",
     {"1:71: warning: found z from 1 to 0, expected [min max]; they are exchanged"}},
    {"unknown drive",
     "position( drive \"tank\" )",
     {"1:17: warning: found 'tank' for 'drive', expected \"diff\", \"omni\" or \"car\"; 'diff' is used"}},
    {"unknown localization",
     "position( localization \"slam\" )",
     {"1:24: warning: found 'slam' for 'localization', expected \"gps\" or \"odom\"; 'gps' is used"}},
    {"wheelbase of zero",
     "position( drive \"car\" wheelbase 0 )",
     {"1:33: warning: found 0 m for 'wheelbase', expected more than 0; 1 m is used"}},
    {"velocity bounds without zero",
     "position( velocity_bounds [0.1 1 0 0 0 0 -90 90] )",
     {"1:27: warning: found bounds in 'velocity_bounds' that leave out 0, expected min <= 0 <= max for each pair; they "
      "are exchanged or extended"}},
    {"acceleration bounds the wrong way round",
     "position( acceleration_bounds [1 -1 0 0 0 0 -90 90] )",
     {"1:31: warning: found bounds in 'acceleration_bounds' that leave out 0, expected min <= 0 <= max for each pair; "
      "they are exchanged or extended"}},
    {"range the wrong way round",
     "position( ranger( sensor( range [5 1] ) ) )",
     {"1:33: warning: found range [5 1], expected [min max] with 0 <= min < max <= 1000 km; [1 5] is used"}},
    {"negative range",
     "position( ranger( sensor( range [-1 1] ) ) )",
     {"1:33: warning: found range [-1 1], expected [min max] with 0 <= min < max <= 1000 km; [0 1] is used"}},
    {"negative field of view",
     "position( ranger( sensor( fov -10 ) ) )",
     {"1:31: warning: found -10 for 'fov', expected 0 to 360 degrees; 10 degrees is used"}},
    {"field of view of more than a turn",
     "position( ranger( sensor( fov 400 ) ) )",
     {"1:31: warning: found 400 for 'fov', expected 0 to 360 degrees; 360 degrees is used"}},
    {"no samples",
     "position( ranger( sensor( samples 0 ) ) )",
     {"1:35: warning: found 0 for 'samples', expected 1 to 100000; 1 is used"}},
    {"too many samples",
     "position( ranger( sensor( samples 1000000000 ) ) )",
     {"1:35: warning: found '1000000000' for 'samples', expected a number of at most 1000000; 1000000 is used",
      "1:35: warning: found 1000000 for 'samples', expected 1 to 100000; 100000 is used"}},
    {"negative noise",
     "position( ranger( sensor( noise [-1 0 0] ) ) )",
     {"1:33: warning: found negative noise, expected values of at least 0; 0 is used"}},
    {"negative gravity", "gravity -9.81", {"1:9: warning: found -9.81 for 'gravity', expected 0 to 1000; 0 is used"}},
    {"actuator of another type",
     "position( actuator( type \"screw\" ) )",
     {"1:26: warning: found 'screw' for 'type', expected \"linear\" or \"rotational\"; 'linear' is used",
      "1:11: warning: found a linear actuator without 'axis', expected its direction [x y z]; it does not move"}},
    {"actuator without axis",
     "position( actuator( ) )",
     {"1:11: warning: found a linear actuator without 'axis', expected its direction [x y z]; it does not move"}},
    {"actuator with an axis of zero",
     "position( actuator( axis [0 0 0] ) )",
     {"1:26: warning: found axis [0 0 0], expected a direction; this actuator does not move"}},
    {"actuator with limits the wrong way round",
     "position( actuator( axis [0 0 1] min_position 2 ) )",
     {"1:47: warning: found a 'max_position' of 1 below the 'min_position' of 2, expected the other way round; they "
      "are exchanged"}},
    {"actuator that starts beyond its limits",
     "position( actuator( axis [0 0 1] start_position 1.5 ) )",
     {"1:49: warning: found 1.5 for 'start_position', expected 0 to 1; 1 is used"}},
    {"actuator of negative speed",
     "position( actuator( axis [0 0 1] max_speed -1 ) )",
     {"1:44: warning: found -1 for 'max_speed', expected 0 to 1000000; 0 is used"}},
    {"gripper without paddles",
     "position( gripper( paddle_size [0.66 0 0.4] ) )",
     {"1:32: warning: found paddle_size [0.66 0 0.4], expected proportions of the gripper's size, above 0, up to [1 "
      "0.5 1]; the nearest ones are used"}},
    {"gripper that is half open",
     "position( gripper( paddle_state [\"half\" \"up\"] ) )",
     {"1:33: warning: found ['half' 'up'] for 'paddle_state', expected [\"open\" or \"closed\" \"up\" or \"down\"]; "
      "[\"open\" \"up\"] is used"}},
    {"gripper with paddles of negative speed",
     "position( gripper( paddle_speed -0.1 ) )",
     {"1:33: warning: found -0.1 for 'paddle_speed', expected 0 to 1000000; 0 is used"}},
    {"gripper with a lift of negative speed",
     "position( gripper( lift_speed -0.1 ) )",
     {"1:31: warning: found -0.1 for 'lift_speed', expected 0 to 1000000; 0 is used"}},
    {"gripper that lifts in no time",
     "position( gripper( vDistanceDivision 0 ) )",
     {"1:38: warning: found 0 for 'vDistanceDivision', expected 1 to 1000000; 20 is used"}},
    {"gripper with a child called like its lift",
     "position( gripper( model( name \"lift\" ) ) )",
     {"1:32: warning: found name 'lift' twice, expected each name once (first at w.world:1); the others get a number, "
      "as in 'lift:2'"}},
    {"negative update interval",
     "position( ranger( update_interval -1 ) )",
     {"1:11: warning: this ranger has no 'sensor', so it measures nothing",
      "1:35: warning: found -1 for 'update_interval', expected 0 to 1000000000; 0 is used"}},
    {"number of two points",
     "gravity 1.2.3",
     {"1:9: warning: found '1.2.3', expected a number such as 1, -0.5 or .25; it is read as 1.2"}},
    {"number of two signs",
     "model( pose [--5 1 0 0] )",
     {"1:14: warning: found '--5', expected a number such as 1, -0.5 or .25; it is read as 0"}},
    {"number with plus and minus",
     "model( pose [+-5 1 0 0] )",
     {"1:14: warning: found '+-5', expected a number such as 1, -0.5 or .25; it is read as 0"}},
    {"lone point", "gravity .", {"1:9: warning: found '.', expected a number such as 1, -0.5 or .25; it is read as 0"}},
    {"string that is not UTF-8",
     "model( name \"K\374che\" )",
     {"1:15: warning: found a byte that is not UTF-8 in string 'K\\xfcche'; the string is read as Latin-1"}},
    {"number with a unit in quotes",
     "gravity \"5 m\"",
     {"1:9: warning: found string '5 m' for 'gravity', expected a number; 5 is used"}},
    {"word for yes",
     "model( gripper_return \"Yes\" )",
     {"1:23: warning: found string 'Yes' for 'gripper_return', expected a number; 1 is used"}},
    {"drive in another case",
     "position( drive \"OMNI\" )",
     {"1:17: warning: found 'OMNI' for 'drive', expected \"diff\", \"omni\" or \"car\"; 'omni' is used"}},
    {"localization in another case",
     "position( localization \"GPS\" )",
     {"1:24: warning: found 'GPS' for 'localization', expected \"gps\" or \"odom\"; 'gps' is used"}},
    {"paddles in another case",
     "position( gripper( paddle_state [\"Closed\" \"UP\"] ) )",
     {"1:33: warning: found ['Closed' 'UP'] for 'paddle_state', expected [\"open\" or \"closed\" \"up\" or \"down\"]; "
      "[\"closed\" \"up\"] is used"}},
    {"paddles of one word",
     "position( gripper( paddle_state \"open\" ) )",
     {"1:33: warning: found ['open'] for 'paddle_state', expected [\"open\" or \"closed\" \"up\" or \"down\"]; "
      "[\"open\" \"down\"] is used"}},
    {"field of view of a camera",
     "position( camera( fov [400 0] ) )",
     {"1:23: warning: found 400 for 'fov', expected more than 0 and at most 170 degrees; 170 degrees is used",
      "1:23: warning: found 0 for 'fov', expected more than 0 and at most 170 degrees; 40 degrees is used"}},
    {"camera without pixels",
     "position( camera( resolution [0 1000000] ) )",
     {"1:30: warning: found 0 pixels for 'resolution', expected 1 to 4096; 1 is used",
      "1:30: warning: found 1000000 pixels for 'resolution', expected 1 to 4096; 4096 is used"}},
    {"camera that looks straight up",
     "position( camera( pantilt [0 90] ) )",
     {"1:27: warning: found a picture that ends beyond 85 degrees above or below the horizontal, expected it within; "
      "it ends there"}},
    {"camera that looks beyond the zenith",
     "position( camera( pantilt [0 180] ) )",
     {"1:27: warning: found a picture that ends beyond 85 degrees above or below the horizontal, expected it within; "
      "it ends there"}},
    {"finder with ranges the wrong way round",
     "position( fiducial( range_min 5 range_max 2 ) )",
     {"1:43: warning: found a 'range_max' below the 'range_min', expected the other way round; they are exchanged"}},
    {"finder of negative range",
     "position( fiducial( range_max -2 ) )",
     {"1:31: warning: found a negative 'range_max', expected at least 0; 0 is used"}},
    {"more colours than names",
     "position( blobfinder( colors_count 3 colors [\"red\" \"blue\"] ) )",
     {"1:36: warning: found 2 colours, expected 3"}},
    {"range of zero",
     "position( ranger( sensor( range [0 0] ) ) )",
     {"1:33: warning: found range [0 0], expected [min max] with 0 <= min < max <= 1000 km; [0 5] is used"}},
    {"range of one point",
     "position( ranger( sensor( range [3 3] ) ) )",
     {"1:33: warning: found range [3 3], expected [min max] with 0 <= min < max <= 1000 km; [0 3] is used"}},
    {"pan of more than a turn",
     "position( blobfinder( pan 700 ) )",
     {"1:27: warning: found 700 for 'pan', expected at most 360 degrees to both sides; 360 degrees is used"}},
    {"joules twice",
     "position( joules 5 kjoules 6 )",
     {"1:28: warning: found both 'joules' and 'kjoules', expected one of them; the latter counts"}},
    {"negative capacity",
     "position( joules_capacity -5 )",
     {"1:1: warning: found a negative capacity for energy, expected at least 0; it is 0"}},
};

TEST(OddValues, LoadWithAWarningThatQuotesThemAndSaysTheirMeaning) {
  const WorldFolder folder;
  for (const OddValue& world : kOddValues) {
    std::vector<std::string> found;
    for (const std::string& warning : folder.WarningsOf(world.text)) {
      if (warning.find("starts inside") == std::string::npos) found.push_back(warning.substr(sizeof("w.world:") - 1));
    }
    EXPECT_EQ(found, world.warnings) << world.name;
  }
}

TEST(OddValues, HaveTheMeaningThatTheWarningSays) {
  const WorldFolder folder;
  const auto world_of = [&](const std::string& text) { return folder.LoadText(text).world; };
  EXPECT_EQ(world_of("interval_sim 0").interval_ns, 100'000'000);
  EXPECT_EQ(world_of("gravity +.5").gravity, 0.5);
  EXPECT_EQ(world_of("gravity \"+5 m\"").gravity, 5.0);
  EXPECT_EQ(world_of("model( pose [1 \"north\" 3 0] )").models[0].X_PM, (Pose{1, 0, 3, 0}));
  EXPECT_EQ(world_of("model( size [1 -2 3] )").models[0].size_y, 2.0);
  EXPECT_EQ(world_of("model( name \"K\374che\" )").models[0].name, "K\303\274che");
  EXPECT_TRUE(world_of("model( gripper_return \"true\" )").models[0].gripper_return);
  EXPECT_EQ(world_of("position( drive \"Omni\" )").robots[0].drive.type, DriveType::kOmni);
  EXPECT_EQ(world_of("position( velocity_bounds [0.1 1 0 0 0 0 90 -90] )").robots[0].drive.velocity.x,
            (Interval{0.0, 1.0}));
  EXPECT_EQ(RaySensors(world_of("position( ranger( sensor( range [5 1] ) ) )").robots[0].sensors[0])[0].range,
            (Interval{1.0, 5.0}));
  EXPECT_TRUE(world_of("position( actuator( ) )").joints.empty());
  EXPECT_EQ(world_of("position( joules 5 kjoules 6 )").models[0].power.joules, 6000.0);
}

TEST(OddValues, APolygonThatCrossesItselfIsItsConvexHull) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "model( size [2 2 1] block( points 5 point[0] [0 0] point[1] [1 1] point[2] [1 0] point[3] [0 1] point[4] [0.5 "
      "0.2] "
      "z [0 1] ) )");
  const Shape& shape = loaded.world.shape(loaded.world.models[0].shape);
  ASSERT_EQ(shape.blocks.size(), 1u);
  EXPECT_EQ(shape.blocks[0].outline.size(), 4u);
  EXPECT_EQ(SignedArea(shape.blocks[0].outline), 4.0);
}

TEST(OddValues, NamesThatAreGivenAgainGetANumber) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "model( name \"a\" )\nmodel( name \"a:2\" )\nmodel( name \"a\" model( name \"b\" ) )\nmodel( name \"a\" )\n"
      "model( name \"/a\" )\nmodel( name \"model:6\" )\nmodel( )\n");
  std::vector<std::string> names;
  for (const ModelDescription& model : loaded.world.models) names.push_back(model.name);
  EXPECT_THAT(names, ElementsAre("a", "a:2", "a:3", "a:3.b", "a:4", "a:5", "model:6", "model:6:2"));
}

}  // namespace
}  // namespace troupe
