// The outlines of the robots of a world as they are placed.
#pragma once

#include <vector>

#include "troupe/rectangle.h"
#include "troupe/world_description.h"

namespace troupe {

// Of all parts that are obstacles, in the frame of the robot.
struct RobotOutline {
  Rectangle box = Rectangle::Nothing();  // m
  double radius = 0.0;                   // m, of the circle about the origin that contains it
};

// By robot.
std::vector<RobotOutline> OutlinesOfRobots(const WorldDescription& world);

}  // namespace troupe
