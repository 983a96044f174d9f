#include "transport/dds/convert/convert_proposal.h"

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

// Calls `take(proposal, i)` for the proposal of each of the ascending robots; false if there is none, or it refuses.
template <typename Take>
bool ForEachRow(std::span<const std::uint32_t> robots, std::vector<Proposal>& proposals, const Take& take) {
  auto proposal = proposals.begin();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    while (proposal != proposals.end() && proposal->robot.index() < robots[i]) ++proposal;
    if (proposal == proposals.end() || proposal->robot.index() != robots[i] || !take(*proposal, i)) return false;
  }
  return true;
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
  bool lengths_fit = true;
  const bool rows_fit = ForEachRow(robot, proposals, [&](Proposal& proposal, std::size_t i) {
    lengths_fit = length[i] <= bytes.size();
    if (!lengths_fit || to[i] < -1) return false;
    const auto own = bytes.first(length[i]);
    bytes = bytes.subspan(length[i]);
    RadioMessage& message = proposal.messages.emplace_back();
    message.radio = radio[i];
    if (to[i] >= 0) message.to = RobotId(static_cast<std::size_t>(to[i]));
    message.bytes.assign(own.begin(), own.end());
    return true;
  });
  if (!lengths_fit) return Error{{}, "proposal with fewer bytes of radio messages than their lengths say"};
  if (!rows_fit) return Error{{}, "proposal with a radio message of or to a robot that it does not have"};
  if (!bytes.empty()) return Error{{}, "proposal with more bytes of radio messages than their lengths say"};
  return {};
}

void OrdersToWire(const std::vector<Proposal>& proposals, troupe_wire_Proposal& wire, WireArena& arena) {
  std::size_t lights = 0;
  std::size_t cameras = 0;
  std::size_t texts = 0;
  for (const Proposal& proposal : proposals) {
    lights += proposal.lights.size();
    cameras += proposal.cameras.size();
    texts += proposal.say.empty() ? 0 : 1;
  }
  std::uint32_t* light_robot = arena.Fill(wire.light_robot, lights);
  std::uint32_t* light_number = arena.Fill(wire.light_number, lights);
  std::uint8_t* light_on = arena.Fill(wire.light_on, lights);
  std::uint32_t* camera_robot = arena.Fill(wire.camera_robot, cameras);
  std::uint32_t* camera_sensor = arena.Fill(wire.camera_sensor, cameras);
  double* camera_pan = arena.Fill(wire.camera_pan, cameras);
  double* camera_tilt = arena.Fill(wire.camera_tilt, cameras);
  std::uint32_t* say_robot = arena.Fill(wire.say_robot, texts);
  char** say = arena.Fill(wire.say, texts);
  for (const Proposal& proposal : proposals) {
    for (const LightOrder& order : proposal.lights) {
      *light_robot++ = static_cast<std::uint32_t>(proposal.robot.index());
      *light_number++ = static_cast<std::uint32_t>(order.light);
      *light_on++ = order.on ? 1 : 0;
    }
    for (const CameraOrder& order : proposal.cameras) {
      *camera_robot++ = static_cast<std::uint32_t>(proposal.robot.index());
      *camera_sensor++ = static_cast<std::uint32_t>(order.sensor);
      *camera_pan++ = order.pan;
      *camera_tilt++ = order.tilt;
    }
    if (proposal.say.empty()) continue;
    *say_robot++ = static_cast<std::uint32_t>(proposal.robot.index());
    *say++ = arena.Copy(proposal.say);
  }
}

Status OrdersFromWire(const troupe_wire_Proposal& wire, std::vector<Proposal>& proposals) {
  const auto light_robot = Elements(wire.light_robot);
  const auto light_number = Elements(wire.light_number);
  const auto light_on = Elements(wire.light_on);
  const auto camera_robot = Elements(wire.camera_robot);
  const auto camera_sensor = Elements(wire.camera_sensor);
  const auto camera_pan = Elements(wire.camera_pan);
  const auto camera_tilt = Elements(wire.camera_tilt);
  const auto say_robot = Elements(wire.say_robot);
  const auto say = Elements(wire.say);
  if (!SameLength(light_robot, light_number, light_on) || !SameLength(say_robot, say) ||
      !SameLength(camera_robot, camera_sensor, camera_pan, camera_tilt)) {
    return Error{{},
                 "proposal with columns of lights, cameras or texts of different lengths, expected one row for each"};
  }
  const bool lights_fit = ForEachRow(light_robot, proposals, [&](Proposal& proposal, std::size_t i) {
    proposal.lights.push_back({light_number[i], light_on[i] == 1});
    return light_on[i] <= 1;
  });
  if (!lights_fit) return Error{{}, "proposal with a light of a robot that it does not have, or neither on nor off"};
  const bool cameras_fit = ForEachRow(camera_robot, proposals, [&](Proposal& proposal, std::size_t i) {
    proposal.cameras.push_back({camera_sensor[i], camera_pan[i], camera_tilt[i]});
    return true;
  });
  if (!cameras_fit) return Error{{}, "proposal with a camera of a robot that it does not have"};
  const bool texts_fit = ForEachRow(say_robot, proposals, [&](Proposal& proposal, std::size_t i) {
    if (!proposal.say.empty()) return false;
    proposal.say = Text(say[i]);
    return true;
  });
  if (!texts_fit) return Error{{}, "proposal with a text of a robot that it does not have, or with two of one robot"};
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
  OrdersToWire(message.proposals, wire, arena);
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
    message.proposals.push_back({RobotId(robot[i]), {vx[i], vy[i], wz[i]}, {own.begin(), own.end()}});
  }
  if (!velocities.empty()) return WrongJoints();
  if (Status problem = MessagesFromWire(wire, message.proposals); !problem.ok()) return problem;
  if (Status problem = OrdersFromWire(wire, message.proposals); !problem.ok()) return problem;
  message.reports = Strings(wire.reports);
  return {};
}

}  // namespace troupe::dds
