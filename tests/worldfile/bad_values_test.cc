// Invalid values: properties, blocks, bitmaps, robots, rangers.
#include <gtest/gtest.h>

#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

struct BadValue {
  const char* name;
  std::string text;
  const char* message;
};

const BadValue kBadValues[] = {
    {"unknown type", "robot( )",
     "w.world:1:1: error: found model type 'robot', expected the name of a define, or one of model position ranger "
     "actuator blinkenlight blobfinder bumper camera contact fiducial gripper imu lightindicator radio"},
    {"type of older versions", "laser( )",
     "w.world:1:1: error: found model type 'laser', which Stage 4 no longer has; today it is a 'ranger' with a 'sensor "
     "( range [min max] "
     "fov degrees samples number )', expected the name of a define, or one of model position ranger actuator "
     "blinkenlight blobfinder bumper camera contact fiducial gripper imu "
     "lightindicator "
     "radio"},
    {"macro of a type of older versions",
     "define red_puck puck( )\n"
     "red_puck( )",
     "w.world:2:1: error: found model type 'puck', which Stage 4 no longer has; today it is a 'model' with "
     "'gripper_return 1', expected the name of a define "
     "(red_puck), "
     "or one "
     "of model position ranger actuator blinkenlight blobfinder bumper camera contact fiducial gripper imu "
     "lightindicator "
     "radio"},
    {"misspelt type", "define rover position( )\ndefine box model( )\nrovr( )",
     "w.world:3:1: error: found model type 'rovr', expected the name of a define (box, rover), or one of model "
     "position "
     "ranger actuator blinkenlight blobfinder bumper camera contact fiducial gripper imu lightindicator radio; did you "
     "mean "
     "'rover'?"},
    {"use before the define",
     "rob( )\n"
     "define rob position( )\n",
     "w.world:1:1: error: found 'rob' before its define at line 2, expected the define first"},
    {"block outside of a model", "block( )",
     "w.world:1:1: error: found a 'block' outside of a model, expected it inside one"},
    {"sensor outside of a ranger", "model( sensor( ) )",
     "w.world:1:8: error: found a 'sensor' outside of a ranger, expected it inside one"},
    {"sensor at the top level", "sensor( )",
     "w.world:1:1: error: found a 'sensor' outside of a ranger, expected it inside one"},
    {"model inside a block", "model( block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] model( ) ) )",
     "w.world:1:77: error: found 'model' inside a block, expected only properties"},
    {"model inside a sensor", "position( ranger( sensor( model( ) ) ) )",
     "w.world:1:27: error: found 'model' inside a sensor, expected only properties"},
    {"pose of three values", "model( pose [0 0 90] )", "w.world:1:13: error: found 3 values for 'pose', expected 4"},
    {"pose of one number", "model( pose 5 )", "w.world:1:13: error: found 1 value for 'pose', expected 4"},
    {"size of two values", "model( size [1 1] )", "w.world:1:13: error: found 2 values for 'size', expected 3"},
    {"origin of three values", "position( origin [-0.04465 0.0 0.0] )",
     "w.world:1:18: error: found 3 values for 'origin', expected 4"},
    {"empty origin", "position( origin [] )", "w.world:1:18: error: found 0 values for 'origin', expected 4"},
    {"colour of three values", "model( color_rgba [1 0 0] )",
     "w.world:1:19: error: found 3 values for 'color_rgba', expected 4"},
    {"block of a million points", "model( block( points 1000000 ) )",
     "w.world:1:22: error: found a block of 1000000 points, expected at most 1000"},
    {"point before the first", "model( block( points 3 point[0] [0 0] point[-2] [1 1] point[2] [1 0] z [0 1] ) )",
     "w.world:1:39: error: found 'point[-2]', expected a blank before '[', or an index as in 'point[0]'"},
    {"point of one number", "model( block( points 3 point[0] [0 0] point[1] 1 point[2] [1 0] z [0 1] ) )",
     "w.world:1:48: error: found 1 value for 'point[1]', expected 2"},
    {"block with z of one value", "model( block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z 1 ) )",
     "w.world:1:71: error: found 1 value for 'z', expected 2"},
    {"missing bitmap", "model( bitmap \"missing.png\" )",
     "w.world:1:15: error: bitmap 'missing.png': cannot read the image (No such file or directory), expected a "
     "readable file"},
    {"bitmap that is no image", "model( bitmap \"text.png\" )",
     "w.world:1:15: error: bitmap 'text.png': found an unknown image format, expected PNG, JPEG, BMP or PGM (P2 or "
     "P5)"},
    {"bitmap that is a folder", "model( bitmap \"folder\" )",
     "w.world:1:15: error: bitmap 'folder': found something that is not a regular file, expected an image"},
    {"bitmap without a name", "model( bitmap \"\" )",
     "w.world:1:15: error: bitmap '': found something that is not a regular file, expected an image"},
    {"bitmap cut off", "model( bitmap \"cut.pgm\" )",
     "w.world:1:15: error: bitmap 'cut.pgm': found 16 bytes, which cannot hold an image of 10 x 10 pixels"},
    {"bitmap that asks for too much", "model( bitmap \"bomb.pgm\" )",
     "w.world:1:15: error: bitmap 'bomb.pgm': found 22 bytes, which cannot hold an image of 60000 x 60000 pixels"},
    {"missing ROS map", "model( map_yaml \"missing.yaml\" )",
     "w.world:1:17: error: cannot read 'missing.yaml' (No such file or directory), expected a readable file"},
    {"velocity bounds of two values", "position( velocity_bounds [-1 1] )",
     "w.world:1:27: error: found 2 values for 'velocity_bounds', expected 8"},
    {"odometry error of three values", "position( localization \"odom\" odom_error [0.05 0.05 0.1] )",
     "w.world:1:42: error: found 3 values for 'odom_error', expected 4"},
    {"range of one value", "position( ranger( sensor( range 5 ) ) )",
     "w.world:1:33: error: found 1 value for 'range', expected 2"},
    {"noise of one value", "position( ranger( sensor( noise 0.1 ) ) )",
     "w.world:1:33: error: found 1 value for 'noise', expected 3"},
    {"sensor size of two values", "position( ranger( sensor( size [0.01 0.04] ) ) )",
     "w.world:1:32: error: found 2 values for 'size', expected 3"},
    {"gripper of no size", "position( gripper( size [0 0 0] ) )",
     "w.world:1:25: error: found a gripper without pads: its size is 0"},
    {"gripper with its heights the wrong way round", "position( gripper( min_height 0.5 max_height 0.2 ) )",
     "w.world:1:46: error: found a 'max_height' of 0.2 below the lowest height, 0.5, expected at least that"},
    {"gripper with one finger", "position( gripper( left_finger \"a\" ) )",
     "w.world:1:32: error: found 'left_finger' without 'right_finger', expected both or neither"},
    {"gripper with unknown fingers",
     "position( gripper( left_finger \"a\" right_finger \"b\" actuator( name \"l\" axis [0 1 0] ) ) )",
     "w.world:1:32: error: found no model 'a' in gripper 'position:0.gripper:0', expected one of 'l'"},
    {"gripper with unknown fingers and without children", "position( gripper( left_finger \"a\" right_finger \"b\" ) )",
     "w.world:1:32: error: found no model 'a' in gripper 'position:0.gripper:0', expected one of its children, but it "
     "has none"},
    {"gripper with an unknown lift", "position( gripper( lift \"mast\" ) )",
     "w.world:1:25: error: found no model 'mast' in gripper 'position:0.gripper:0' or its robot, expected one of "
     "'left_paddle' 'right_paddle'"},
    {"gripper with a finger that does not move",
     "position( gripper( left_finger \"a\" right_finger \"b\" model( name \"a\" ) ) )",
     "w.world:1:32: error: found 'a', which does not move, expected the name of an actuator"},
    {"gripper with one finger twice",
     "position( gripper( left_finger \"a\" right_finger \"a\" actuator( name \"a\" axis [0 1 0] ) ) )",
     "w.world:1:49: error: found fingers 'a' and 'a', of which one carries the other, expected two beside each other"},
    {"gripper with a lift that moves nothing of it",
     "position( gripper( lift \"m\" ) actuator( name \"m\" axis [0 0 1] ) )",
     "w.world:1:25: error: found lift 'm', which does not move both fingers, expected one that carries them"},
    {"gripper with fingers without body",
     "define f actuator( axis [0 1 0] noblocks 1 )\n"
     "position( gripper( left_finger \"a\" right_finger \"b\" f( name \"a\" ) f( name \"b\" ) ) )",
     "w.world:2:11: error: found a gripper without pads: 'position:0.gripper:0.a' has no body, expected fingers with "
     "blocks, or the names of their pads"},
    {"gripper with a pad that its finger does not move",
     "define f actuator( axis [0 1 0] )\n"
     "position( gripper( left_finger \"a\" right_finger \"b\" right_pad \"a\" f( name \"a\" ) f( name \"b\" ) ) )",
     "w.world:2:63: error: found pad 'a', which finger 'gripper:0.b' does not move, expected the finger or a model on "
     "it"},
    {"grippers that share fingers",
     "define f actuator( axis [0 1 0] )\n"
     "position( gripper( left_finger \"g.a\" right_finger \"g.b\"\n"
     "  gripper( name \"g\" left_finger \"a\" right_finger \"b\" f( name \"a\" ) f( name \"b\" ) ) ) )",
     "w.world:3:3: error: found the fingers of gripper 'gripper:0', or others mounted on the same model, expected each "
     "gripper to have its own"},
    {"gripper with a paddle far away",
     "position( actuator( name \"m\" axis [0 0 1] gripper( lift \"m\" origin [1000000 0 0 0] noblocks 1 ) ) )",
     "w.world:1:43: error: found a gripper with a paddle beyond 1000 km, expected it nearer"},
};

TEST(BadValues, GivesOneLineWithThePlaceAndTheExpectedText) {
  WorldFolder folder;
  for (const BadValue& world : kBadValues) {
    folder.Write("w.world", world.text);
    EXPECT_EQ(folder.ErrorOf("w.world"), world.message) << world.name;
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
