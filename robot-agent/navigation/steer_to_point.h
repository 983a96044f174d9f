// The motion towards a point, for controllers that drive to places.
#pragma once

#include "troupe/controller.h"

namespace troupe {

struct SteerSettings {
  double speed = 0.4;      // m/s
  double turn_rate = 0.8;  // rad/s
};

// The command that brings the robot nearer to `p_R` (m, frame R): it turns towards the point and drives faster the
// better it faces it, a car on the arc through the point. No faster than `most` m/s.
Command SteerToPoint(const DriveDescription& drive, const SteerSettings& settings, const Vec2& p_R, double most);

// The speed (m/s) from which the drive can brake within `distance` m.
double BrakingSpeed(const DriveDescription& drive, double distance);

}  // namespace troupe
