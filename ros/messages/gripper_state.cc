#include "ros/messages/gripper_state.h"

#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace troupe::ros {
namespace {

const char* FingersOf(const GripperMotion& motion, double largest) {
  if (motion.opening_rate > 0.0) return "opening";
  if (motion.opening_rate < 0.0) return "closing";
  return motion.opening >= largest ? "open" : "closed";
}

}  // namespace

double LargestOpening(const WorldDescription& world, GripperId gripper) {
  const Interval& left = world.joint(world.gripper(gripper).left).position;
  const Interval& right = world.joint(world.gripper(gripper).right).position;
  return left.max - left.min + right.max - right.min;
}

GripperMotion MotionOf(const WorldDescription& world, GripperId gripper, const WorldState& state) {
  GripperMotion motion;
  for (const JointId id : {world.gripper(gripper).left, world.gripper(gripper).right}) {
    const JointState& finger = state.joints[id.index()];
    motion.opening += world.joint(id).position.max - finger.position;
    motion.opening_rate -= finger.velocity;
    motion.moves = motion.moves || finger.velocity != 0.0;
    motion.blocked = motion.blocked || finger.blocked;
  }
  motion.clamped = state.grippers[gripper.index()].clamped.has_value();
  return motion;
}

std::string GripperJson(const WorldDescription& world, GripperId gripper, const WorldState& state) {
  const GripperMotion motion = MotionOf(world, gripper, state);
  const GripperState& grip = state.grippers[gripper.index()];
  const double largest = LargestOpening(world, gripper);
  nlohmann::json json = {{"tick", state.tick},
                         {"fingers", FingersOf(motion, largest)},
                         {"opening", motion.opening},
                         {"largest_opening", largest}};
  if (grip.left_contact) json["left_contact"] = world.model(*grip.left_contact).name;
  if (grip.right_contact) json["right_contact"] = world.model(*grip.right_contact).name;
  if (grip.clamped) {
    json["clamped"] = world.model(world.objects[grip.clamped->index()]).name;
    if (state.objects[grip.clamped->index()].holder == gripper) json["held"] = json["clamped"];
  }
  if (const std::optional<JointId> lift = world.gripper(gripper).lift) {
    json["lift"] = state.joints[lift->index()].position;
    json["lift_blocked"] = state.joints[lift->index()].blocked;
  }
  return JsonText(json);
}

}  // namespace troupe::ros
