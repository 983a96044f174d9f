// The turns of robots at chargers (step_workspace.h: AssignChargers).
//
// A robot that wants to charge asks for a vertex in each tick: for a charger that no other robot has, or, while all are
// taken, for a place where it waits. A vertex is of the robot that has it until that asks for another one, or for none
// any more; of several that ask for a free one, it goes to the robot with the least energy, in proportion to its
// capacity, and of equal ones to that of the smallest id. Robots see in the next frame who has what, and ask again.
#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

constexpr double kOnePlace = 0.5;  // m: vertices of two graphs so near to each other are one place

struct Wish {
  double level = 0.0;  // of energy, from 0 to 1
  std::size_t row = 0;
  ChargeOrder order;
};

// Of the stores that feed a robot's drive; 1 without any.
double EnergyLevel(const StepWorkspace& workspace, RobotId robot) {
  double joules = 0.0;
  double capacity = 0.0;
  for (std::size_t i = 0; i < workspace.next.stores.size(); ++i) {
    const Store& store = workspace.scene.stores()[i];
    const PowerDescription& power = workspace.world().model(store.model).power;
    if (store.robot != robot || power.endless) continue;
    joules += workspace.next.stores[i].joules;
    capacity += power.capacity;
  }
  return capacity > 0.0 ? joules / capacity : 1.0;
}

const LaneVertex& VertexOf(const WorldDescription& world, std::size_t number) {
  std::size_t graph = 0;
  for (; number >= world.lane_graphs[graph].vertices.size(); ++graph) {
    number -= world.lane_graphs[graph].vertices.size();
  }
  return world.lane_graphs[graph].vertices[number];
}

bool AreOnePlace(const WorldDescription& world, std::uint32_t a, std::uint32_t b) {
  if (a == b) return true;
  const LaneVertex& one = VertexOf(world, a);
  const LaneVertex& other = VertexOf(world, b);
  return one.z == other.z && (one.position - other.position).norm() < kOnePlace;
}

}  // namespace

void AssignChargers(const TickOrders& orders, StepWorkspace& workspace) {
  const WorldDescription& world = workspace.world();
  const std::vector<ChargingRobot> before = std::move(workspace.next.charging_robots);
  std::vector<ChargingRobot>& rows = workspace.next.charging_robots;
  rows.clear();
  std::vector<Wish> wishes;
  orders.ForEachOfRobots<ChargeOrder>([&](RobotId robot, const ChargeOrder& order) {
    if (!rows.empty() && rows.back().robot == robot) return;  // the first one counts
    const auto row = std::lower_bound(before.begin(), before.end(), robot,
                                      [](const ChargingRobot& a, RobotId b) { return a.robot < b; });
    const bool is_known = row != before.end() && row->robot == robot;
    rows.push_back(is_known ? *row : ChargingRobot{.robot = robot, .since = workspace.next.tick});
    if (order.vertex) wishes.push_back({EnergyLevel(workspace, robot), rows.size() - 1, order});
  });
  std::stable_sort(wishes.begin(), wishes.end(), [](const Wish& a, const Wish& b) { return a.level < b.level; });
  for (const Wish& wish : wishes) {
    const bool is_taken = std::any_of(rows.begin(), rows.end(), [&](const ChargingRobot& other) {
      return &other != &rows[wish.row] && other.vertex && AreOnePlace(world, *other.vertex, *wish.order.vertex);
    });
    if (is_taken) continue;
    rows[wish.row].vertex = wish.order.vertex;
    rows[wish.row].at_charger = wish.order.at_charger;
  }
}

}  // namespace troupe
