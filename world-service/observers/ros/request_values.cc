#include "world-service/observers/ros/request_values.h"

#include <cmath>

#include "ros/messages/names.h"
#include "transport/dds/binding/wire.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kMostTilt = 1e-3;  // of a unit quaternion's x and y: room for rounding

}  // namespace

Result<Pose> PoseFromRos(const char* frame, const ros::PoseMessage& pose) {
  const std::string name = dds::Text(frame);
  if (!name.empty() && name != ros::kMapFrame && name != "world") {
    return Error{{}, "found a pose in frame '" + name + "', expected one in '" + ros::kMapFrame + "'"};
  }
  const auto& q = pose.orientation;
  const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!std::isfinite(norm) || !std::isfinite(pose.position.x) || !std::isfinite(pose.position.y) ||
      !std::isfinite(pose.position.z)) {
    return Error{{}, "found a pose that is not finite"};
  }
  if (norm < 1e-6) return Error{{}, "found an orientation of zeros, expected a quaternion"};
  if (std::abs(q.x) > kMostTilt * norm || std::abs(q.y) > kMostTilt * norm) {
    return Error{{}, "found a tilted pose, expected one that is upright"};
  }
  return Pose{pose.position.x, pose.position.y, pose.position.z, WrapAngle(2.0 * Atan2(q.z, q.w))};
}

Result<Twist> TwistFromRos(const ros::TwistMessage& twist) {
  for (const double number :
       {twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z}) {
    if (!std::isfinite(number)) return Error{{}, "found a twist that is not finite"};
  }
  if (twist.linear.z != 0.0 || twist.angular.x != 0.0 || twist.angular.y != 0.0) {
    return Error{{}, "found a twist out of the ground, expected linear x and y and angular z"};
  }
  return Twist{twist.linear.x, twist.linear.y, twist.angular.z};
}

}  // namespace troupe
