// Invalid values: properties, blocks, bitmaps, robots, rangers.
#include <gtest/gtest.h>

#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

struct BadValue {
  std::string text;
  std::string where;  // in w.world, unless it names another file
  std::string what;
};

const BadValue kBadValues[] = {
    {"robot( )", "1:1",
     "found model type 'robot', expected the name of a define, or one of model position ranger actuator blinkenlight "
     "blobfinder bumper camera contact door fiducial gripper imu lift lightindicator radio"},
    {"laser( )", "1:1",
     "found model type 'laser', which Stage 4 no longer has; today it is a 'ranger' with a 'sensor ( range [min max] "
     "fov degrees samples number )', expected the name of a define, or one of model position ranger actuator "
     "blinkenlight blobfinder bumper camera contact door fiducial gripper imu lift lightindicator radio"},
    {"define red_puck puck( )\nred_puck( )", "2:1",
     "found model type 'puck', which Stage 4 no longer has; today it is a 'model' with 'gripper_return 1', expected "
     "the name of a define (red_puck), or one of model position ranger actuator blinkenlight blobfinder bumper camera "
     "contact door fiducial gripper imu lift lightindicator radio"},
    {"define rover position( )\ndefine box model( )\nrovr( )", "3:1",
     "found model type 'rovr', expected the name of a define (box, rover), or one of model position ranger actuator "
     "blinkenlight blobfinder bumper camera contact door fiducial gripper imu lift lightindicator radio; did you mean "
     "'rover'?"},
    {"rob( )\ndefine rob position( )\n", "1:1", "found 'rob' before its define at line 2, expected the define first"},
    {"block( )", "1:1", "found a 'block' outside of a model, expected it inside one"},
    {"model( sensor( ) )", "1:8", "found a 'sensor' outside of a ranger, expected it inside one"},
    {"sensor( )", "1:1", "found a 'sensor' outside of a ranger, expected it inside one"},
    {"model( block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] model( ) ) )", "1:77",
     "found 'model' inside a block, expected only properties"},
    {"position( ranger( sensor( model( ) ) ) )", "1:27", "found 'model' inside a sensor, expected only properties"},
    {"model( pose [0 0 90] )", "1:13", "found 3 values for 'pose', expected 4"},
    {"model( pose 5 )", "1:13", "found 1 value for 'pose', expected 4"},
    {"model( size [1 1] )", "1:13", "found 2 values for 'size', expected 3"},
    {"position( origin [-0.04465 0.0 0.0] )", "1:18", "found 3 values for 'origin', expected 4"},
    {"position( origin [] )", "1:18", "found 0 values for 'origin', expected 4"},
    {"model( color_rgba [1 0 0] )", "1:19", "found 3 values for 'color_rgba', expected 4"},
    {"model( block( points 1000000 ) )", "1:22", "found a block of 1000000 points, expected at most 1000"},
    {"model( block( points 3 point[0] [0 0] point[-2] [1 1] point[2] [1 0] z [0 1] ) )", "1:39",
     "found 'point[-2]', expected a blank before '[', or an index as in 'point[0]'"},
    {"model( block( points 3 point[0] [0 0] point[1] 1 point[2] [1 0] z [0 1] ) )", "1:48",
     "found 1 value for 'point[1]', expected 2"},
    {"model( block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z 1 ) )", "1:71",
     "found 1 value for 'z', expected 2"},
    {"model( bitmap \"missing.png\" )", "1:15",
     "bitmap 'missing.png': cannot read the image (No such file or directory), expected a readable file"},
    {"model( bitmap \"text.png\" )", "1:15",
     "bitmap 'text.png': found an unknown image format, expected PNG, JPEG, BMP or PGM (P2 or P5)"},
    {"model( bitmap \"folder\" )", "1:15",
     "bitmap 'folder': found something that is not a regular file, expected an image"},
    {"model( bitmap \"\" )", "1:15", "bitmap '': found something that is not a regular file, expected an image"},
    {"model( bitmap \"cut.pgm\" )", "1:15",
     "bitmap 'cut.pgm': found 16 bytes, which cannot hold an image of 10 x 10 pixels"},
    {"model( bitmap \"bomb.pgm\" )", "1:15",
     "bitmap 'bomb.pgm': found 22 bytes, which cannot hold an image of 60000 x 60000 pixels"},
    {"model( map_yaml \"missing.yaml\" )", "1:17",
     "cannot read 'missing.yaml' (No such file or directory), expected a readable file"},
    {"position( velocity_bounds [-1 1] )", "1:27", "found 2 values for 'velocity_bounds', expected 8"},
    {"position( localization \"odom\" odom_error [0.05 0.05 0.1] )", "1:42",
     "found 3 values for 'odom_error', expected 4"},
    {"position( ranger( sensor( range 5 ) ) )", "1:33", "found 1 value for 'range', expected 2"},
    {"position( ranger( sensor( noise 0.1 ) ) )", "1:33", "found 1 value for 'noise', expected 3"},
    {"position( ranger( sensor( size [0.01 0.04] ) ) )", "1:32", "found 2 values for 'size', expected 3"},
    {"position( gripper( size [0 0 0] ) )", "1:25", "found a gripper without pads: its size is 0"},
    {"position( gripper( min_height 0.5 max_height 0.2 ) )", "1:46",
     "found a 'max_height' of 0.2 below the lowest height, 0.5, expected at least that"},
    {"position( gripper( left_finger \"a\" ) )", "1:32",
     "found 'left_finger' without 'right_finger', expected both or neither"},
    {"position( gripper( left_finger \"a\" right_finger \"b\" actuator( name \"l\" axis [0 1 0] ) ) )", "1:32",
     "found no model 'a' in gripper 'position:0.gripper:0', expected one of 'l'"},
    {"position( gripper( left_finger \"a\" right_finger \"b\" ) )", "1:32",
     "found no model 'a' in gripper 'position:0.gripper:0', expected one of its children, but it has none"},
    {"position( gripper( lift \"mast\" ) )", "1:25",
     "found no model 'mast' in gripper 'position:0.gripper:0' or its robot, expected one of 'left_paddle' "
     "'right_paddle'"},
    {"position( gripper( left_finger \"a\" right_finger \"b\" model( name \"a\" ) ) )", "1:32",
     "found 'a', which does not move, expected the name of an actuator"},
    {"position( gripper( left_finger \"a\" right_finger \"a\" actuator( name \"a\" axis [0 1 0] ) ) )", "1:49",
     "found fingers 'a' and 'a', of which one carries the other, expected two beside each other"},
    {"position( gripper( lift \"m\" ) actuator( name \"m\" axis [0 0 1] ) )", "1:25",
     "found lift 'm', which does not move both fingers, expected one that carries them"},
    {"define f actuator( axis [0 1 0] noblocks 1 )\nposition( gripper( left_finger \"a\" right_finger \"b\" f( name "
     "\"a\" ) f( name \"b\" ) ) )",
     "2:11",
     "found a gripper without pads: 'position:0.gripper:0.a' has no body, expected fingers with blocks, or the names "
     "of their pads"},
    {"define f actuator( axis [0 1 0] )\nposition( gripper( left_finger \"a\" right_finger \"b\" right_pad \"a\" f( "
     "name \"a\" ) f( name \"b\" ) ) )",
     "2:63", "found pad 'a', which finger 'gripper:0.b' does not move, expected the finger or a model on it"},
    {"define f actuator( axis [0 1 0] )\nposition( gripper( left_finger \"g.a\" right_finger \"g.b\"\n  gripper( name "
     "\"g\" left_finger \"a\" right_finger \"b\" f( name \"a\" ) f( name \"b\" ) ) ) )",
     "3:3",
     "found the fingers of gripper 'gripper:0', or others mounted on the same model, expected each gripper to have its "
     "own"},
    {"position( actuator( name \"m\" axis [0 0 1] gripper( lift \"m\" origin [1000000 0 0 0] noblocks 1 ) ) )", "1:43",
     "found a gripper with a paddle beyond 1000 km, expected it nearer"},
};

TEST(BadValues, GivesOneLineWithThePlaceAndTheExpectedText) {
  WorldFolder folder;
  for (const BadValue& world : kBadValues) {
    folder.Write("w.world", world.text);
    const std::string file = world.where.find(".inc") == std::string::npos ? "w.world:" : "";
    EXPECT_EQ(folder.ErrorOf("w.world"), file + world.where + ": error: " + world.what) << world.text;
  }
}

// Every number is within its limit, but their sums are not.
TEST(BadValues, SumsBeyondReachAreRefused) {
  WorldFolder folder;
  const auto error_of = [&](const std::string& text) {
    folder.Write("w.world", text);
    return folder.ErrorOf("w.world");
  };
  EXPECT_EQ(error_of("model( origin [0 0 1000000 0] )"),
            "w.world:1:15: error: found a body that cannot be: its height is beyond 1000 km");
  EXPECT_EQ(error_of("model( origin [1000000 0 0 0] )"),
            "w.world:1:15: error: found a body that cannot be: a coordinate is beyond 1000 km");
  EXPECT_EQ(error_of("model( size [1 1 1] model( pose [0 0 1000000 0] ) )"),
            "w.world:1:33: error: found a model beyond 1000 km, expected it nearer");
  EXPECT_EQ(error_of("position( ranger( origin [1000000 0 0 0] sensor( pose [1 0 0 0] ) ) )"),
            "w.world:1:55: error: found a sensor beyond 1000 km, expected it nearer");
  EXPECT_EQ(error_of("position( pose [1000000 0 0 0] localization \"odom\" localization_origin [-1000000 0 0 0] )"),
            "w.world:1:72: error: found an origin beyond 1000 km from the robot, expected it nearer");
}

TEST(BadValues, NamesWithoutEndAreRefused) {
  WorldFolder folder;
  folder.Write("w.world", "model( name \"" + std::string(2000, 'x') + "\" )");
  EXPECT_EQ(folder.ErrorOf("w.world"), "w.world:1:13: error: found a name of 2000 bytes, expected at most 1000");
}

}  // namespace
}  // namespace troupe
