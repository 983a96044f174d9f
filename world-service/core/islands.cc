#include "world-service/core/islands.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/spatial/grid.h"

namespace troupe {
namespace {

// Far more than rounding, and than the distance at which bodies count as touching.
constexpr double kMargin = 1e-4;   // m
constexpr double kMinCell = 0.01;  // m

// How far a robot's motions of this tick can move its parts, beyond what turns about its origin can.
// Turning of the base needs no part of it: the disc around the origin stays the same. The chord of an arc is no longer
// than the arc, so that speed times duration is a bound for the base.
double TravelOf(const Scene& scene, RobotId robot, const Proposal* proposal, double radius) {
  if (proposal == nullptr) return 0.0;
  const double seconds = scene.world().interval_seconds();
  double travel =
      std::sqrt(proposal->twist.vx * proposal->twist.vx + proposal->twist.vy * proposal->twist.vy) * seconds;
  // A payload may be farther from a joint than from the robot's origin: at most twice as far as from the joint.
  const std::span<const JointId> joints = scene.joints_of(robot);
  for (std::size_t i = 0; i < std::min(joints.size(), proposal->joint_velocities.size()); ++i) {
    travel += std::abs(proposal->joint_velocities[i]) * seconds * std::max(1.0, 2.0 * radius);
  }
  return travel;
}

}  // namespace

template <typename Id>
template <typename IdOf, typename IslandOf>
void Islands::Lists<Id>::Fill(std::size_t islands, std::size_t count, IdOf id_of, IslandOf island_of) {
  // A counting sort in two passes: first the sizes, one place further on, then the sums; the second pass moves each
  // start to the start of the next list, so that at the end first_[island] is where it belongs. It keeps the order of
  // ids within an island.
  first_.assign(islands + 2, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (const std::uint32_t island = island_of(id_of(i)); island != kNone) ++first_[island + 2];
  }
  for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
  ids_.resize(first_.back());
  for (std::size_t i = 0; i < count; ++i) {
    if (const std::uint32_t island = island_of(id_of(i)); island != kNone) ids_[first_[island + 1]++] = id_of(i);
  }
}

std::uint32_t Islands::Root(std::uint32_t body) {
  // Path halving: each step moves a body up to its grandparent.
  while (parent_[body] != body) body = parent_[body] = parent_[parent_[body]];
  return body;
}

void Islands::Join(std::uint32_t a, std::uint32_t b) {
  a = Root(a);
  b = Root(b);
  // The root is the lowest number of its group: robots come before objects, so that a group with a robot has a robot as
  // its root, and islands are numbered in the order of robots whatever the order of joins.
  parent_[std::max(a, b)] = std::min(a, b);
}

// Robots and the objects that they hold or wait for, and objects and the bodies under them.
void Islands::JoinAttached(const Scene& scene, const WorldState& state) {
  const auto index_of = [&](auto id) { return static_cast<std::uint32_t>(scene.body_of(id).index()); };
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    const ObjectState& object = state.objects[i];
    if (object.holder) Join(index_of(ObjectId(i)), index_of(scene.world().gripper(*object.holder).robot));
    if (!object.support) continue;
    if (const std::optional<BodyId> below = scene.body_of(*object.support); below && below->index() < parent_.size()) {
      Join(index_of(ObjectId(i)), static_cast<std::uint32_t>(below->index()));
    }
  }
  // A gripper that waits for an object which another one holds gets it when that one opens, perhaps in this tick.
  for (std::size_t i = 0; i < state.grippers.size(); ++i) {
    const std::optional<ObjectId>& clamped = state.grippers[i].clamped;
    if (clamped) Join(index_of(*clamped), index_of(scene.world().grippers[i].robot));
  }
}

void Islands::MeasureReaches(const Scene& scene, const WorldState& state, std::span<const Proposal* const> by_robot) {
  // Bodies are numbered as in BodyId: robots, then objects.
  const std::size_t robots = state.robots.size();
  reaches_.resize(parent_.size());
  for (std::size_t i = 0; i < robots; ++i) {
    reaches_[i] = {state.robots[i].X_WR.translation(), scene.body(BodyId(i)).radius};
  }
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    reaches_[robots + i] = {state.objects[i].X_WO.translation(), scene.body(BodyId(robots + i)).radius + kMargin};
  }
  // Any robot may carry any object that is attached to its group: one may hand it over to another in this tick.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> carriers;  // (group, robot)
  for (std::uint32_t i = 0; i < robots && !state.objects.empty(); ++i) carriers.emplace_back(Root(i), i);
  std::sort(carriers.begin(), carriers.end());
  for (std::size_t object = robots; object < reaches_.size(); ++object) {
    const std::uint32_t root = Root(static_cast<std::uint32_t>(object));
    if (root >= robots) continue;  // no robot is in its group: robots have the lowest numbers
    auto carrier = std::lower_bound(carriers.begin(), carriers.end(), std::pair(root, std::uint32_t{0}));
    for (; carrier != carriers.end() && carrier->first == root; ++carrier) {
      Reach& reach = reaches_[carrier->second];
      const double distance = (reaches_[object].center - reach.center).norm();
      reach.radius = std::max(reach.radius, distance + reaches_[object].radius);
    }
  }
  for (std::size_t i = 0; i < robots; ++i) {
    reaches_[i].radius += TravelOf(scene, RobotId(i), by_robot[i], reaches_[i].radius) + kMargin;
  }
}

void Islands::JoinOverlapping() {
  Rectangle bounds = Rectangle::Nothing();
  double sum = 0.0;
  for (const Reach& reach : reaches_) {
    bounds.Extend(reach.center);
    sum += reach.radius;
  }
  const auto bodies = static_cast<double>(reaches_.size());
  // Cells as wide as an average disc: then most discs are in few cells, and few discs in each cell. The third number
  // bounds the count of cells for a sparse world.
  const Grid grid(bounds.Inflated(kMinCell), std::max(2.0 * sum / bodies, kMinCell), 2.0 * bodies + 16.0);
  const auto for_each_cell = [&](std::size_t body, const auto& visit) {
    const CellRange range = grid.CellsOf(Rectangle{reaches_[body].center.x(), reaches_[body].center.y(),
                                                   reaches_[body].center.x(), reaches_[body].center.y()}
                                             .Inflated(reaches_[body].radius));
    for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
      for (std::int32_t column = range.min_column; column <= range.max_column; ++column)
        visit(grid.CellAt(column, row));
    }
  };
  cell_first_.assign(grid.cell_count() + 2, 0);
  for (std::size_t i = 0; i < reaches_.size(); ++i)
    for_each_cell(i, [&](std::size_t cell) { ++cell_first_[cell + 2]; });
  for (std::size_t i = 2; i < cell_first_.size(); ++i) cell_first_[i] += cell_first_[i - 1];
  cell_bodies_.resize(cell_first_.back());
  for (std::size_t i = 0; i < reaches_.size(); ++i) {
    for_each_cell(i, [&](std::size_t cell) { cell_bodies_[cell_first_[cell + 1]++] = static_cast<std::uint32_t>(i); });
  }
  for (std::size_t cell = 0; cell < grid.cell_count(); ++cell) {
    for (std::uint32_t i = cell_first_[cell]; i < cell_first_[cell + 1]; ++i) {
      const Reach& a = reaches_[cell_bodies_[i]];
      // Two discs that overlap have a cell in common; a pair in several cells is compared in each, which changes
      // nothing.
      for (std::uint32_t j = i + 1; j < cell_first_[cell + 1]; ++j) {
        const Reach& b = reaches_[cell_bodies_[j]];
        const double distance = a.radius + b.radius;
        if ((a.center - b.center).squaredNorm() <= distance * distance) Join(cell_bodies_[i], cell_bodies_[j]);
      }
    }
  }
}

void Islands::Number(const Scene& scene, const WorldState& state) {
  const std::size_t robots = state.robots.size();
  island_.assign(reaches_.size(), kNone);
  std::uint32_t islands = 0;
  for (std::size_t i = 0; i < reaches_.size(); ++i) {
    const std::uint32_t root = Root(static_cast<std::uint32_t>(i));  // the lowest number of the group
    if (root >= robots) continue;
    if (island_[root] == kNone) island_[root] = islands++;
    island_[i] = island_[root];
  }
  // The order of Step: it begins with another robot in each tick.
  const Tick next = state.tick + 1;
  robots_.Fill(
      islands, robots, [&](std::size_t k) { return RobotId((next + k) % robots); },
      [&](RobotId robot) { return island_[robot.index()]; });
  objects_.Fill(
      islands, state.objects.size(), [](std::size_t i) { return ObjectId(i); },
      [&](ObjectId object) { return island_[robots + object.index()]; });
  grippers_.Fill(
      islands, state.grippers.size(), [](std::size_t i) { return GripperId(i); },
      [&](GripperId gripper) { return island_[scene.world().gripper(gripper).robot.index()]; });
  order_.resize(islands);
  for (std::uint32_t i = 0; i < islands; ++i) order_[i] = i;
  // Large islands first: threads that claim islands one by one finish at about the same time. The order of work changes
  // no result.
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return robots_.Of(a).size() > robots_.Of(b).size(); });
}

void Islands::Find(const Scene& scene, const WorldState& state, std::span<const Proposal* const> by_robot) {
  parent_.resize(state.robots.size() + state.objects.size());  // people move after the islands
  for (std::size_t i = 0; i < parent_.size(); ++i) parent_[i] = static_cast<std::uint32_t>(i);
  JoinAttached(scene, state);
  MeasureReaches(scene, state, by_robot);
  JoinOverlapping();
  Number(scene, state);
}

}  // namespace troupe
