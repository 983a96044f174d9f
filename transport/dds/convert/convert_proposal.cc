#include <algorithm>
#include <string>
#include <string_view>

#include "transport/dds/convert/columns.h"
#include "transport/dds/convert/convert.h"

namespace troupe::dds {
namespace {

Error WrongJoints() {
  return {{}, "proposal with another number of joint velocities than its column 'joints' says"};
}

// Columns of rows that each belong to a proposal: its robot, then a column for each leaf of the row.
template <typename RowsOf, typename Columns>
void RowsToWire(const std::vector<Proposal>& proposals, const RowsOf& rows_of, Columns& columns, WireArena& arena) {
  std::size_t count = 0;
  for (const Proposal& proposal : proposals) count += rows_of(proposal).size();
  if (count == 0) return;
  const auto members = MembersOf(columns);
  std::uint32_t* robot = arena.Fill(std::get<0>(members), count);
  for (const Proposal& proposal : proposals) {
    robot = std::fill_n(robot, rows_of(proposal).size(), static_cast<std::uint32_t>(proposal.robot.index()));
  }
  const auto for_each_row = [&](const auto& use) {
    for (const Proposal& proposal : proposals) {
      for (const auto& row : rows_of(proposal)) use(row);
    }
  };
  using Row = typename std::remove_cvref_t<decltype(rows_of(proposals[0]))>::value_type;
  ListToColumns(count, for_each_row, kLeaves<Row>, WithoutFirst(members), arena);
}

// Rows are in the order of their robots.
template <typename RowsOf, typename Columns>
Status RowsFromWire(std::string_view what, const Columns& columns, const RowsOf& rows_of,
                    std::vector<Proposal>& proposals) {
  const auto members = MembersOf(columns);
  const bool is_empty = std::apply([](const auto&... column) { return (... && Elements(column).empty()); }, members);
  if (is_empty) return {};
  const auto robots = Elements(std::get<0>(members));
  std::remove_cvref_t<decltype(rows_of(proposals[0]))> rows;
  using Row = typename decltype(rows)::value_type;
  Status problem = ListFromColumns(what, kLeaves<Row>, WithoutFirst(members), rows);
  if (!problem.ok()) return problem;
  if (robots.size() != rows.size()) return Error{{}, std::string(what) + " with columns of different lengths"};
  auto proposal = proposals.begin();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    while (proposal != proposals.end() && proposal->robot.index() < robots[i]) ++proposal;
    if (proposal == proposals.end() || proposal->robot.index() != robots[i]) {
      return Error{{}, std::string(what) + " of a robot that it does not have"};
    }
    rows_of(*proposal).push_back(std::move(rows[i]));
  }
  return {};
}

// The texts of robots that say something.
void TextsToWire(const std::vector<Proposal>& proposals, troupe_wire_SayColumns& wire, WireArena& arena) {
  const auto says = [](const Proposal& proposal) { return !proposal.say.empty(); };
  const auto count = static_cast<std::size_t>(std::count_if(proposals.begin(), proposals.end(), says));
  std::uint32_t* robot = arena.Fill(wire.robot, count);
  char** say = arena.Fill(wire.say, count);
  for (const Proposal& proposal : proposals) {
    if (!says(proposal)) continue;
    *robot++ = static_cast<std::uint32_t>(proposal.robot.index());
    *say++ = arena.Copy(proposal.say);
  }
}

Status TextsFromWire(const troupe_wire_SayColumns& wire, std::vector<Proposal>& proposals) {
  const auto robots = Elements(wire.robot);
  const auto texts = Elements(wire.say);
  if (!SameLength(robots, texts)) return Error{{}, "proposal of texts with columns of different lengths"};
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const auto proposal =
        std::lower_bound(proposals.begin(), proposals.end(), robots[i],
                         [](const Proposal& a, std::uint32_t robot) { return a.robot.index() < robot; });
    if (proposal == proposals.end() || proposal->robot.index() != robots[i] || !proposal->say.empty()) {
      return Error{{}, "proposal with a text of a robot that it does not have, or with two of one robot"};
    }
    proposal->say = Text(texts[i]);
  }
  return {};
}

static_assert(kMemberCount<Proposal> == 9, "a new field of a proposal needs a column here");

constexpr auto kMessages = [](auto& proposal) -> auto& {
  return proposal.messages;
};
constexpr auto kLights = [](auto& proposal) -> auto& {
  return proposal.lights;
};
constexpr auto kCameras = [](auto& proposal) -> auto& {
  return proposal.cameras;
};
constexpr auto kDoors = [](auto& proposal) -> auto& {
  return proposal.doors;
};
constexpr auto kLifts = [](auto& proposal) -> auto& {
  return proposal.lifts;
};

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
  RowsToWire(message.proposals, kMessages, wire.messages, arena);
  RowsToWire(message.proposals, kLights, wire.lights, arena);
  RowsToWire(message.proposals, kCameras, wire.cameras, arena);
  TextsToWire(message.proposals, wire.say, arena);
  RowsToWire(message.proposals, kDoors, wire.doors, arena);
  RowsToWire(message.proposals, kLifts, wire.lifts, arena);
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
  Status problem = RowsFromWire("proposal of radio messages", wire.messages, kMessages, message.proposals);
  if (problem.ok()) problem = RowsFromWire("proposal of lights", wire.lights, kLights, message.proposals);
  if (problem.ok()) problem = RowsFromWire("proposal of cameras", wire.cameras, kCameras, message.proposals);
  if (problem.ok()) problem = TextsFromWire(wire.say, message.proposals);
  if (problem.ok()) problem = RowsFromWire("proposal of doors", wire.doors, kDoors, message.proposals);
  if (problem.ok()) problem = RowsFromWire("proposal of lifts", wire.lifts, kLifts, message.proposals);
  if (!problem.ok()) return problem;
  message.reports = Strings(wire.reports);
  return {};
}

}  // namespace troupe::dds
