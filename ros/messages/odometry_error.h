// OdometryError: the uncertainty of a robot's odometry, from the relative errors of its description.
#pragma once

#include "troupe/pose.h"
#include "troupe/world_description.h"

namespace troupe::ros {

// Variances of x, y (m^2) and heading (rad^2) of a pose, and of vx, vy (m^2/s^2) and wz (rad^2/s^2).
struct Covariance {
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;
  double vx = 0.0;
  double vy = 0.0;
  double wz = 0.0;
};

class OdometryError {
 public:
  explicit OdometryError(const LocalizationDescription& localization) : localization_(localization) {}

  // Adds the motion of one tick. Errors are relative to motion, so they grow with the path length.
  void AddMotion(const Twist& twist, double seconds);

  // The squares of the largest possible errors; zeros for gps, which is exact.
  Covariance covariance() const;

 private:
  LocalizationDescription localization_;
  Twist twist_;
  // Path length along each component, forward and back alike: m, m, rad.
  double along_x_ = 0.0;
  double along_y_ = 0.0;
  double turned_ = 0.0;
};

}  // namespace troupe::ros
