#include "common/dds/convert/convert_proposal.h"

#include <algorithm>

namespace troupe::dds {
namespace {

Error WrongJoints() {
  return {{}, "proposal with another number of joint velocities than its column 'joints' says"};
}

}  // namespace

troupe_wire_Proposal ToWire(const ProposalMessage& message, WireArena& arena) {
  troupe_wire_Proposal wire{};
  wire.agent = message.agent;
  wire.run = message.run;
  wire.tick = message.tick;
  const std::size_t count = message.proposals.size();
  std::uint32_t* robot = arena.Fill(wire.robot, count);
  double* vx = arena.Fill(wire.vx, count);
  double* vy = arena.Fill(wire.vy, count);
  double* wz = arena.Fill(wire.wz, count);
  std::uint32_t* joints = arena.Fill(wire.joints, count);
  std::size_t all_joints = 0;
  for (const Proposal& proposal : message.proposals) all_joints += proposal.joint_velocities.size();
  double* joint_velocity = arena.Fill(wire.joint_velocity, all_joints);
  for (std::size_t i = 0; i < count; ++i) {
    const Proposal& proposal = message.proposals[i];
    robot[i] = static_cast<std::uint32_t>(proposal.robot.index());
    vx[i] = proposal.twist.vx;
    vy[i] = proposal.twist.vy;
    wz[i] = proposal.twist.wz;
    joints[i] = static_cast<std::uint32_t>(proposal.joint_velocities.size());
    joint_velocity = std::copy(proposal.joint_velocities.begin(), proposal.joint_velocities.end(), joint_velocity);
  }
  arena.FillStrings(wire.reports, message.reports);
  wire.paused = message.paused;
  wire.edition = message.edition;
  wire.incarnation = message.incarnation;
  return wire;
}

// Numbers that are not finite pass: the step refuses them with an event that names the robot.
Status FromWire(const troupe_wire_Proposal& wire, ProposalMessage& message) {
  const auto robot = Elements(wire.robot);
  const auto vx = Elements(wire.vx);
  const auto vy = Elements(wire.vy);
  const auto wz = Elements(wire.wz);
  const auto joints = Elements(wire.joints);
  auto velocities = Elements(wire.joint_velocity);
  if (vx.size() != robot.size() || vy.size() != robot.size() || wz.size() != robot.size() ||
      joints.size() != robot.size()) {
    return Error{{}, "proposal with columns of different lengths, expected one row for each robot"};
  }
  message.agent = wire.agent;
  message.run = wire.run;
  message.paused = wire.paused;
  message.edition = wire.edition;
  message.incarnation = wire.incarnation;
  message.tick = wire.tick;
  message.proposals.clear();
  message.proposals.reserve(robot.size());
  for (std::size_t i = 0; i < robot.size(); ++i) {
    if (i > 0 && robot[i] <= robot[i - 1])
      return Error{{}, "proposal with robots out of order, expected ascending ids"};
    if (joints[i] > velocities.size()) return WrongJoints();
    const auto own = velocities.first(joints[i]);
    velocities = velocities.subspan(joints[i]);
    message.proposals.push_back({RobotId(robot[i]), {vx[i], vy[i], wz[i]}, {own.begin(), own.end()}});
  }
  if (!velocities.empty()) return WrongJoints();
  message.reports = Strings(wire.reports);
  return {};
}

}  // namespace troupe::dds
