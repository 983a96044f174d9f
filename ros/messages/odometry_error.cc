#include "ros/messages/odometry_error.h"

#include <cmath>

namespace troupe::ros {
namespace {

double Square(double value) {
  return value * value;
}

}  // namespace

void OdometryError::AddMotion(const Twist& twist, double seconds) {
  twist_ = twist;
  along_x_ += std::fabs(twist.vx) * seconds;
  along_y_ += std::fabs(twist.vy) * seconds;
  turned_ += std::fabs(twist.wz) * seconds;
}

Covariance OdometryError::covariance() const {
  if (localization_.type == LocalizationType::kGps) return {};
  // A wrong heading displaces the position, in both directions, by at most its error times the path length.
  const double displacement = localization_.error_heading * turned_ * (along_x_ + along_y_);
  return {.x = Square(localization_.error_x * along_x_) + Square(displacement),
          .y = Square(localization_.error_y * along_y_) + Square(displacement),
          .heading = Square(localization_.error_heading * turned_),
          .vx = Square(localization_.error_x * twist_.vx),
          .vy = Square(localization_.error_y * twist_.vy),
          .wz = Square(localization_.error_heading * twist_.wz)};
}

}  // namespace troupe::ros
