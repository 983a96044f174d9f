#include "world-service/core/validate_proposal.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "common/base/utf8.h"
#include "common/model/drive_limits.h"
#include "troupe/check.h"
#include "troupe/radio_limits.h"

namespace troupe {
namespace {

Error BadProposal(std::string reason) {
  return {{}, std::move(reason)};
}

std::string ToText(const Twist& twist) {
  char text[128];
  std::snprintf(text, sizeof text, "(%.6g m/s, %.6g m/s, %.6g rad/s)", twist.vx, twist.vy, twist.wz);
  return text;
}

Status CheckJointVelocities(const WorldDescription& world, const Proposal& proposal) {
  const std::vector<double>& velocities = proposal.joint_velocities;
  if (velocities.empty()) return Status();
  std::size_t number = 0;
  for (const JointDescription& joint : world.joints) {
    if (joint.robot != proposal.robot) continue;
    if (number < velocities.size() && !(std::abs(velocities[number]) <= joint.max_speed * (1.0 + 1e-9))) {
      char text[96];
      std::snprintf(text, sizeof text, "%.6g, expected at most %.6g either way", velocities[number], joint.max_speed);
      return BadProposal("found a velocity of joint '" + joint.name + "' of " + text);
    }
    ++number;
  }
  if (velocities.size() == number) return Status();
  return BadProposal("found velocities of " + std::to_string(velocities.size()) +
                     " joints, expected none or those of the robot's " + std::to_string(number));
}

Status CheckRadioMessages(const WorldDescription& world, const Proposal& proposal) {
  for (const RadioMessage& message : proposal.messages) {
    if (!message.to || message.to->index() < world.robots.size()) continue;
    return BadProposal("found a radio message to robot " + std::to_string(message.to->index()) + ", expected one of " +
                       std::to_string(world.robots.size()) + " robots");
  }
  return CheckMessages(world.robot(proposal.robot), world.interval_seconds(), proposal.messages);
}

Status CheckLightsAndText(const WorldDescription& world, const Proposal& proposal) {
  if (proposal.say.size() > kMostSaidBytes) {
    return BadProposal("found a text of " + std::to_string(proposal.say.size()) + " bytes, expected at most " +
                       std::to_string(kMostSaidBytes));
  }
  // It is printed on terminals.
  if (!IsPlainLine(proposal.say)) {
    return BadProposal("found a text with a control character or a byte that is not UTF-8, expected a line of UTF-8");
  }
  if (proposal.lights.empty()) return Status();
  std::size_t lights = 0;
  for (const LightPlace& light : FindLights(world)) lights += light.robot == proposal.robot ? 1 : 0;
  for (const LightOrder& order : proposal.lights) {
    if (order.light < lights) continue;
    return BadProposal("found light " + std::to_string(order.light) + ", expected one of the robot's " +
                       std::to_string(lights));
  }
  return Status();
}

Status CheckCameras(const WorldDescription& world, const Proposal& proposal) {
  for (const CameraOrder& order : proposal.cameras) {
    const CameraParameters* const camera = FindCamera(world.robot(proposal.robot), order.sensor);
    if (camera == nullptr) {
      return BadProposal("found sensor " + std::to_string(order.sensor) + ", expected a camera of the robot");
    }
    const Interval limits = camera->TiltLimits();
    if (order.pan >= -kPi && order.pan <= kPi && order.tilt >= limits.min && order.tilt <= limits.max) continue;
    return BadProposal("found the pan " + std::to_string(order.pan) + " and tilt " + std::to_string(order.tilt) +
                       " of a camera, expected -pi to pi and " + std::to_string(limits.min) + " to " +
                       std::to_string(limits.max));
  }
  return Status();
}

}  // namespace

Status ValidateProposal(const WorldDescription& world, const WorldState& state, const Proposal& proposal) {
  TROUPE_CHECK(state.robots.size() == world.robots.size());
  const std::size_t index = proposal.robot.index();
  if (index >= world.robots.size()) {
    return BadProposal("found robot " + std::to_string(index) + ", expected one of " +
                       std::to_string(world.robots.size()) + " robots");
  }
  if (!IsFinite(proposal.twist)) return BadProposal("found a twist that is not finite: " + ToText(proposal.twist));
  const DriveDescription& drive = world.robots[index].drive;
  const Twist& current = state.robots[index].twist;
  const double seconds = world.interval_seconds();
  if (!WithinLimits(drive, current, proposal.twist, seconds)) {
    return BadProposal("found the twist " + ToText(proposal.twist) + " after " + ToText(current) +
                       ", expected one within the drive's bounds: " +
                       ToText(ClampToLimits(drive, current, proposal.twist, seconds)) + " is the nearest");
  }
  if (Status problem = CheckJointVelocities(world, proposal); !problem.ok()) return problem;
  if (Status problem = CheckRadioMessages(world, proposal); !problem.ok()) return problem;
  if (Status problem = CheckCameras(world, proposal); !problem.ok()) return problem;
  return CheckLightsAndText(world, proposal);
}

}  // namespace troupe
