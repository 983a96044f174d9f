#include "common/dds/convert/convert_proposal.h"

#include <algorithm>

namespace troupe::dds {
namespace {

Error WrongJoints() {
  return {{}, "proposal with another number of joint velocities than its column 'joints' says"};
}

void MessagesToWire(const std::vector<Proposal>& proposals, troupe_wire_Proposal& wire, WireArena& arena) {
  std::size_t count = 0;
  std::size_t bytes = 0;
  for (const Proposal& proposal : proposals) {
    count += proposal.messages.size();
    for (const RadioMessage& message : proposal.messages) bytes += message.bytes.size();
  }
  if (count == 0) return;
  std::uint32_t* robot = arena.Fill(wire.message_robot, count);
  std::uint32_t* radio = arena.Fill(wire.message_radio, count);
  std::int32_t* to = arena.Fill(wire.message_to, count);
  std::uint32_t* length = arena.Fill(wire.message_length, count);
  std::uint8_t* content = arena.Fill(wire.message_bytes, bytes);
  for (const Proposal& proposal : proposals) {
    for (const RadioMessage& message : proposal.messages) {
      *robot++ = static_cast<std::uint32_t>(proposal.robot.index());
      *radio++ = static_cast<std::uint32_t>(message.radio);
      *to++ = message.to ? static_cast<std::int32_t>(message.to->index()) : -1;
      *length++ = static_cast<std::uint32_t>(message.bytes.size());
      content = std::copy(message.bytes.begin(), message.bytes.end(), content);
    }
  }
}

Status MessagesFromWire(const troupe_wire_Proposal& wire, std::vector<Proposal>& proposals) {
  const auto robot = Elements(wire.message_robot);
  const auto radio = Elements(wire.message_radio);
  const auto to = Elements(wire.message_to);
  const auto length = Elements(wire.message_length);
  auto bytes = Elements(wire.message_bytes);
  if (!SameLength(robot, radio, to, length)) {
    return Error{{}, "proposal with columns of radio messages of different lengths, expected one row for each"};
  }
  auto proposal = proposals.begin();
  for (std::size_t i = 0; i < robot.size(); ++i) {
    while (proposal != proposals.end() && proposal->robot.index() < robot[i]) ++proposal;
    if (proposal == proposals.end() || proposal->robot.index() != robot[i] || to[i] < -1) {
      return Error{{}, "proposal with a radio message of or to a robot that it does not have"};
    }
    if (length[i] > bytes.size())
      return Error{{}, "proposal with fewer bytes of radio messages than their lengths say"};
    const auto own = bytes.first(length[i]);
    bytes = bytes.subspan(length[i]);
    RadioMessage& message = proposal->messages.emplace_back();
    message.radio = radio[i];
    if (to[i] >= 0) message.to = RobotId(static_cast<std::size_t>(to[i]));
    message.bytes.assign(own.begin(), own.end());
  }
  if (!bytes.empty()) return Error{{}, "proposal with more bytes of radio messages than their lengths say"};
  return {};
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
  MessagesToWire(message.proposals, wire, arena);
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
  if (!SameLength(robot, vx, vy, wz, joints)) {
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
    message.proposals.push_back({RobotId(robot[i]), {vx[i], vy[i], wz[i]}, {own.begin(), own.end()}, {}});
  }
  if (!velocities.empty()) return WrongJoints();
  if (Status problem = MessagesFromWire(wire, message.proposals); !problem.ok()) return problem;
  message.reports = Strings(wire.reports);
  return {};
}

}  // namespace troupe::dds
