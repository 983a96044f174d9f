#include "robot-agent/robot/external_command.h"

#include "robot-agent/drive/drive.h"

namespace troupe {

void AddCommand(const RobotCommand& added, const DriveDescription& drive, ExternalCommand& external) {
  if (added.twist) {
    const Command motion = CommandFromTwist(*added.twist, drive);
    external.command.twist = motion.twist;
    external.command.speed = motion.speed;
    external.command.steering = motion.steering;
    external.drives = true;
  }
  for (const GripperOrder& order : added.grippers) {
    external.command.grippers.push_back({.gripper = order.gripper, .lift = order.lift, .opening = order.opening});
  }
  external.goal = added.goal;
}

}  // namespace troupe
