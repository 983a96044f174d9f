// The robot models that building files name, as text in Stage's language: boxes of about their size, with the speeds of
// the fleets of Open-RMF's demos.
//
// Text in the language of world files, parsed for the tree of every building, so that scenarios may use the defines by
// name. A file's robot type is looked up by name without regard to case (site_tree.cc).
#pragma once

namespace troupe {

inline constexpr const char kSiteRobots[] = R"(
define SiteLidar ranger ( size [ 0.06 0.06 0.06 ] color "black" obstacle_return 0
  sensor ( range [ 0.05 8 ] fov 270 samples 181 ) )

define SiteRobot position ( drive "diff" size [ 0.6 0.6 0.5 ] color "SteelBlue"
  velocity_bounds [ -0.5 0.5 0 0 0 0 -34.4 34.4 ] acceleration_bounds [ -0.75 0.75 0 0 0 0 -114.6 114.6 ]
  SiteLidar ( pose [ 0.25 0 -0.3 0 ] ) )

define TinyRobot position ( drive "diff" size [ 0.45 0.42 0.3 ] origin [ -0.1 0 0 0 ] color "SteelBlue"
  velocity_bounds [ -0.5 0.5 0 0 0 0 -34.4 34.4 ] acceleration_bounds [ -0.75 0.75 0 0 0 0 -114.6 114.6 ]
  SiteLidar ( pose [ 0.05 0 -0.1 0 ] ) )

define DeliveryRobot position ( drive "diff" size [ 0.7 0.7 1.0 ] color "DarkOrange"
  velocity_bounds [ -0.7 0.7 0 0 0 0 -34.4 34.4 ] acceleration_bounds [ -0.75 0.75 0 0 0 0 -114.6 114.6 ]
  SiteLidar ( pose [ 0.3 0 -0.8 0 ] ) )

define CleanerBotA position ( drive "diff" size [ 1.3 0.8 1.3 ] origin [ 0.46 0 0 0 ] color "SeaGreen"
  velocity_bounds [ 0 0.7 0 0 0 0 -22.9 22.9 ] acceleration_bounds [ -0.5 0.5 0 0 0 0 -57.3 57.3 ]
  SiteLidar ( pose [ 1.05 0 -1.1 0 ] ) )

define CleanerBotE position ( drive "diff" size [ 1.1 0.7 1.1 ] origin [ 0.35 0 0 0 ] color "OliveDrab"
  velocity_bounds [ 0 0.7 0 0 0 0 -22.9 22.9 ] acceleration_bounds [ -0.5 0.5 0 0 0 0 -57.3 57.3 ]
  SiteLidar ( pose [ 0.85 0 -0.9 0 ] ) )

define HospitalRobot position ( drive "diff" size [ 0.8 0.6 1.2 ] color "MediumPurple"
  velocity_bounds [ -0.7 0.7 0 0 0 0 -34.4 34.4 ] acceleration_bounds [ -0.75 0.75 0 0 0 0 -114.6 114.6 ]
  SiteLidar ( pose [ 0.35 0 -1.0 0 ] ) )

define Caddy position ( drive "car" wheelbase 1.3 size [ 2.3 1.34 1.8 ] origin [ -0.25 0 0 0 ] color "firebrick"
  velocity_bounds [ -2 2 0 0 0 0 -34.4 34.4 ] acceleration_bounds [ -1 1 0 0 0 0 -57.3 57.3 ]
  SiteLidar ( pose [ 0.8 0 -1.4 0 ] ) )
)";

}  // namespace troupe
