#include "common/worldfile/edit/property_table.h"

namespace troupe {
namespace {

constexpr PropertyHelp kTable[] = {
    {"world", "name", "text", "", "", "Shown in summaries; without it the file's name"},
    {"world", "interval_sim", "number", "ms", "100", "Length of a tick"},
    {"world", "gravity", "number", "m/s2", "9.81", "0: released objects stay in the air"},
    {"world", "quit_time", "number", "s", "0", "The run ends after this simulated time; 0: it does not"},
    {"world", "unit_length", "m|cm|mm", "", "\"m\"", "Of all lengths in the file and its includes"},
    {"world", "unit_angle", "degrees|radians", "", "\"degrees\"", "Of all angles in the file and its includes"},

    {"*", "name", "text", "", "", "Unique; without it TYPE:N"},
    {"*", "pose", "x y z heading", "m, deg", "[0 0 0 0]", "In the parent's frame, or the world's"},
    {"*", "size", "x y z", "m", "[0.4 0.4 1]", "The body is stretched to it; a size of 0 leaves no body"},
    {"*", "origin", "x y z heading", "m, deg", "[0 0 0 0]", "The body's centre in the model's frame"},
    {"*", "stack_children", "flag", "", "1", "Children are on top: their z counts from the model's height"},
    {"*", "noblocks", "flag", "", "0", "Leaves the box out"},
    {"*", "boundary", "flag", "", "0", "Four thin walls around the box or the bitmap"},
    {"*", "bitmap", "text", "", "", "A PNG or PGM whose dark pixels are the body"},
    {"*", "map_yaml", "text", "", "", "A map of ROS's map_server as the body"},
    {"*", "obstacle_return", "flag", "", "1", "Collides"},
    {"*", "ranger_return", "number", "", "1", "Intensity that a ranger reads; below 0 it is invisible to rangers"},
    {"*", "gripper_return", "flag", "", "0", "An object: may be gripped, moved and dropped"},
    {"*", "fiducial_return", "number", "", "0", "The id that fiducial finders read; 0: they do not find it"},
    {"*", "fiducial_key", "number", "", "0", "Only finders with the same key find it"},
    {"*", "color", "text", "", "\"red\"", "A name of X11's rgb.txt, or \"random\""},
    {"*", "color_rgba", "r g b a", "0 to 1", "", "Without color"},
    {"*", "gui_nose", "flag", "", "0", "Pictures show the front"},

    {"position", "drive", "diff|omni|car", "", "\"diff\"", "How it moves"},
    {"position", "wheelbase", "number", "m", "1", "Of a car"},
    {"position", "velocity_bounds", "xmin xmax ymin ymax zmin zmax amin amax", "m/s, deg/s", "[-1 1 -1 1 -1 1 -90 90]",
     "Each pair includes 0"},
    {"position", "acceleration_bounds", "xmin xmax ymin ymax zmin zmax amin amax", "m/s2, deg/s2",
     "[-1 1 -1 1 -1 1 -90 90]", "Each pair includes 0"},
    {"position", "localization", "gps|odom", "", "\"gps\"", "gps: it knows its pose; odom: it adds up its motion"},
    {"position", "localization_origin", "x y z heading", "m, deg", "", "Odometry reports poses relative to it"},
    {"position", "odom_error", "x y z heading", "proportion", "", "A motion d is read as d (1 + error)"},
    {"position", "ctrl", "text", "", "", "\"wander\", \"expand_pioneer\" or \"expand_swarm\""},

    {"ranger", "update_interval", "number", "ms", "100", "The period of its measurements"},
    {"sensor", "pose", "x y z heading", "m, deg", "[0 0 0 0]", "In the ranger's body"},
    {"sensor", "size", "x y z", "m", "[0.02 0.02 0.02]", "Half of z raises the rays"},
    {"sensor", "range", "min max", "m", "[0 5]", "Readings are within it"},
    {"sensor", "fov", "number", "deg", "", "The fan spans half of it to both sides"},
    {"sensor", "samples", "number", "", "1", "Number of rays"},
    {"sensor", "planes", "number", "", "1", "Planes of rays, one above another"},
    {"sensor", "vertical_fov", "number", "deg", "30", "Of several planes, from the lowest to the highest"},
    {"sensor", "elevations", "numbers", "deg", "", "The elevation of each plane"},
    {"sensor", "noise", "variance proportional angle", "m2, proportion", "", "Added to a hit"},

    {"fiducial", "range_min", "number", "m", "0", "From the finder to the model"},
    {"fiducial", "range_max", "number", "m", "8", "From the finder to the model"},
    {"fiducial", "range_max_id", "number", "m", "5", "Beyond it the id reads 0"},
    {"fiducial", "fov", "number", "deg", "180", "Of the finder"},
    {"fiducial", "ignore_zloc", "flag", "", "0", "Also finds what is above or below its plane"},
    {"bumper", "bcount", "number", "", "0", "Number of strips"},
    {"bumper", "bpose", "x y z heading", "m, deg", "[0 0 0 0]", "bpose[i]: the middle of strip i"},
    {"bumper", "blength", "number", "m", "0", "Of all strips, or blength[i]"},
    {"blobfinder", "image", "width height", "pixels", "[80 60]", "Of the image"},
    {"blobfinder", "range", "number", "m", "12", "Of its sight"},
    {"blobfinder", "fov", "number", "deg", "60", "Of the width"},
    {"blobfinder", "pan", "number", "deg", "0", "To the left"},
    {"blobfinder", "colors_count", "number", "", "", "Of colors"},
    {"blobfinder", "colors", "texts", "", "", "The colours that it finds; without them all"},
    {"camera", "resolution", "width height", "pixels", "[32 32]", "Of the image"},
    {"camera", "range", "min max", "m", "[0.2 8]", "Of depths"},
    {"camera", "fov", "horizontal vertical", "deg", "[70 40]", "Of the image"},
    {"camera", "pantilt", "pan tilt", "deg", "[0 0]", "To the left, and up"},
    {"blinkenlight", "period", "number", "ms", "1000", "Of the light"},
    {"blinkenlight", "dutycycle", "number", "0 to 1", "1", "The share of each period in which it is on"},
    {"blinkenlight", "enabled", "flag", "", "1", "0: always off"},

    {"actuator", "type", "linear|rotational", "", "\"linear\"", "Shifts along the axis, or turns about the vertical"},
    {"actuator", "axis", "x y z", "", "", "A direction in the actuator's frame"},
    {"actuator", "max_speed", "number", "m/s, deg/s", "1", "To both sides"},
    {"actuator", "min_position", "number", "m, deg", "0", "Lower limit"},
    {"actuator", "max_position", "number", "m, deg", "1", "Upper limit"},
    {"actuator", "start_position", "number", "m, deg", "", "At the start"},
    {"gripper", "paddle_size", "x y z", "proportion", "[0.66 0.1 0.4]", "Length, thickness and height of a paddle"},
    {"gripper", "paddle_state", "texts", "", "[\"open\" \"down\"]", "\"open\" or \"closed\", \"up\" or \"down\""},
    {"gripper", "autosnatch", "flag", "", "0", "Closes by itself when a break beam is broken"},
    {"gripper", "min_height", "number", "m", "", "Of the paddles' underside above the robot's base, at 0 percent"},
    {"gripper", "max_height", "number", "m", "", "The same at 100 percent"},
    {"gripper", "paddle_speed", "number", "m/s", "", "Of each paddle"},
    {"gripper", "lift_speed", "number", "m/s", "", "Of the lift"},
    {"gripper", "vDistanceDivision", "number", "updates", "20", "Of the lift for its full travel"},
    {"gripper", "update_interval", "number", "ms", "100", "The length of an update"},
    {"gripper", "left_finger", "text", "", "", "An actuator of the gripper"},
    {"gripper", "right_finger", "text", "", "", "An actuator of the gripper"},
    {"gripper", "left_pad", "text", "", "", "The model of the left finger that touches"},
    {"gripper", "right_pad", "text", "", "", "The model of the right finger that touches"},
    {"gripper", "lift", "text", "", "", "The actuator that carries both fingers"},
};

}  // namespace

std::span<const PropertyHelp> PropertyTable() {
  return kTable;
}

}  // namespace troupe
