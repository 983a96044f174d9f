#include "common/dds/convert_proposal.h"

namespace troupe::dds {

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
  for (std::size_t i = 0; i < count; ++i) {
    const Proposal& proposal = message.proposals[i];
    robot[i] = static_cast<std::uint32_t>(proposal.robot.index());
    vx[i] = proposal.twist.vx;
    vy[i] = proposal.twist.vy;
    wz[i] = proposal.twist.wz;
  }
  arena.FillStrings(wire.reports, message.reports);
  return wire;
}

// Numbers that are not finite pass: the step refuses them with an event that names the robot.
Status FromWire(const troupe_wire_Proposal& wire, ProposalMessage& message) {
  const auto robot = Elements(wire.robot);
  const auto vx = Elements(wire.vx);
  const auto vy = Elements(wire.vy);
  const auto wz = Elements(wire.wz);
  if (vx.size() != robot.size() || vy.size() != robot.size() || wz.size() != robot.size()) {
    return Error{{}, "proposal with columns of different lengths, expected one row for each robot"};
  }
  message.agent = wire.agent;
  message.run = wire.run;
  message.tick = wire.tick;
  message.proposals.clear();
  message.proposals.reserve(robot.size());
  for (std::size_t i = 0; i < robot.size(); ++i) {
    if (i > 0 && robot[i] <= robot[i - 1])
      return Error{{}, "proposal with robots out of order, expected ascending ids"};
    message.proposals.push_back({RobotId(robot[i]), {vx[i], vy[i], wz[i]}});
  }
  message.reports = Strings(wire.reports);
  return {};
}

}  // namespace troupe::dds
