#include <algorithm>
#include <string>
#include <string_view>

#include "transport/dds/convert/columns.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/convert/order_columns.h"

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

// Null if there is none of that robot.
Proposal* FindProposal(std::vector<Proposal>& proposals, RobotId robot) {
  const auto found = std::lower_bound(proposals.begin(), proposals.end(), robot,
                                      [](const Proposal& a, RobotId b) { return a.robot < b; });
  return found != proposals.end() && found->robot == robot ? &*found : nullptr;
}

void OrdersToWire(const std::vector<Proposal>& proposals, troupe_wire_Proposal& wire, WireArena& arena) {
  if (std::all_of(proposals.begin(), proposals.end(), [](const Proposal& each) { return each.orders.empty(); })) return;
  const auto for_each = [&](const auto& use) {
    for (const Proposal& proposal : proposals) {
      for (const Order& order : proposal.orders) use(proposal.robot, order);
    }
  };
  OrdersToColumns<LightOrder>(for_each, wire.lights, arena);
  OrdersToColumns<CameraOrder>(for_each, wire.cameras, arena);
  OrdersToColumns<DoorOrder>(for_each, wire.doors, arena);
  OrdersToColumns<LiftOrder>(for_each, wire.lifts, arena);
  OrdersToColumns<TrafficOrder>(for_each, wire.traffic, arena);
  OrdersToColumns<ChargeOrder>(for_each, wire.charging, arena);
  OrdersToColumns<JobOrder>(for_each, wire.jobs, arena);
  OrdersToColumns<WaitOrder>(for_each, wire.waits, arena);
  OrdersToColumns<LoadOrder>(for_each, wire.loads, arena);
}

Status OrdersFromWire(const troupe_wire_Proposal& wire, std::vector<Proposal>& proposals) {
  const auto add = [&](RobotId robot, const Order& order) {
    Proposal* const proposal = FindProposal(proposals, robot);
    if (proposal != nullptr) proposal->orders.push_back(order);
    return proposal != nullptr;
  };
  Status problem = OrdersFromColumns<LightOrder>("proposal of lights", wire.lights, add);
  if (problem.ok()) problem = OrdersFromColumns<CameraOrder>("proposal of cameras", wire.cameras, add);
  if (problem.ok()) problem = OrdersFromColumns<DoorOrder>("proposal of doors", wire.doors, add);
  if (problem.ok()) problem = OrdersFromColumns<LiftOrder>("proposal of lifts", wire.lifts, add);
  if (problem.ok()) problem = OrdersFromColumns<TrafficOrder>("proposal of traffic", wire.traffic, add);
  if (problem.ok()) problem = OrdersFromColumns<ChargeOrder>("proposal of charging", wire.charging, add);
  if (problem.ok()) problem = OrdersFromColumns<JobOrder>("proposal of jobs", wire.jobs, add);
  if (problem.ok()) problem = OrdersFromColumns<WaitOrder>("proposal of waits", wire.waits, add);
  if (problem.ok()) problem = OrdersFromColumns<LoadOrder>("proposal of loads", wire.loads, add);
  return problem;
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
    Proposal* const proposal = FindProposal(proposals, RobotId(robots[i]));
    if (proposal == nullptr || !proposal->say.empty()) {
      return Error{{}, "proposal with a text of a robot that it does not have, or with two of one robot"};
    }
    proposal->say = Text(texts[i]);
  }
  return {};
}

static_assert(kMemberCount<Proposal> == 7, "a new field of a proposal needs a column here");
// A twist is an order of tools alone, which no proposal has.
static_assert(std::variant_size_v<Order> == 12, "a new kind of order needs columns here, and in convert_order.cc");

constexpr auto kMessages = [](auto& proposal) -> auto& {
  return proposal.messages;
};
constexpr auto kFleet = [](auto& proposal) -> auto& {
  return proposal.fleet;
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
  RowsToWire(message.proposals, kFleet, wire.fleet, arena);
  TextsToWire(message.proposals, wire.say, arena);
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
  Status problem = RowsFromWire("proposal of radio messages", wire.messages, kMessages, message.proposals);
  if (problem.ok()) problem = RowsFromWire("proposal of fleet messages", wire.fleet, kFleet, message.proposals);
  if (problem.ok()) problem = TextsFromWire(wire.say, message.proposals);
  if (problem.ok()) problem = OrdersFromWire(wire, message.proposals);
  if (!problem.ok()) return problem;
  message.reports = Strings(wire.reports);
  return {};
}

}  // namespace troupe::dds
