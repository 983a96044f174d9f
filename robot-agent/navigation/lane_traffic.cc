#include "robot-agent/navigation/lane_traffic.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace troupe {
namespace {

constexpr double kStill = 1e-3;  // m/s and rad/s
constexpr double kZone = 0.6;    // m: a robot is at a vertex within it
constexpr double kSlack = 0.02;  // m, of bodies that pass each other

// On the vertex's level.
bool IsAt(const LaneVertex& vertex, const SeenRobot& robot) {
  return std::fabs(robot.z - vertex.z) < kLevelGap && (robot.position - vertex.position).norm() < kZone;
}

}  // namespace

// m: a circle about the origin that contains the body at any heading.
double RadiusOf(const WorldDescription& world, RobotId robot) {
  const ModelDescription& root = world.model(world.robot(robot).root);
  double radius = 0.5 * Vec2(root.size_x, root.size_y).norm();
  // The body may be beside the origin: the outline of its blocks says how far.
  for (const Block& block : world.shape(root.shape).blocks) {
    for (const Vec2& corner : block.outline) radius = std::max(radius, corner.norm());
  }
  return radius;
}

// From the state, which all robots of a fleet know alike: so their decisions agree without messages.
std::vector<SeenRobot> SeeOthers(const WorldDescription& world, const WorldState& state, RobotId own,
                                 const std::vector<double>& radii) {
  std::vector<SeenRobot> others;
  for (std::size_t i = 0; i < state.robots.size(); ++i) {
    if (RobotId(i) == own || !RobotExists(world, RobotId(i))) continue;
    const RobotState& robot = state.robots[i];
    const double motion = std::fabs(robot.twist.vx) + std::fabs(robot.twist.vy) + std::fabs(robot.twist.wz);
    others.push_back({RobotId(i), robot.X_WR.translation(), robot.X_WR.z, radii[i], motion > kStill});
  }
  return others;
}

// Entries are the vertices from which a lane leads into the group: there robots wait.
MutexGroup::MutexGroup(const LaneGraph& graph, std::string name) : name_(std::move(name)) {
  const auto is_inside = [&](std::size_t vertex) { return graph.vertices[vertex].mutex == name_; };
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    if (is_inside(i)) vertices_.push_back(i);
  }
  for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
    const Lane& lane = graph.lanes[i];
    const bool is_lane = lane.mutex == name_;
    // A robot on its way to a vertex of the group would not be seen otherwise.
    if (is_lane || is_inside(lane.start) || is_inside(lane.end)) lanes_.push_back(i);
    for (const auto& [here, there] : {std::pair(lane.start, lane.end), std::pair(lane.end, lane.start)}) {
      if (!is_inside(here) && (is_lane || is_inside(there))) entries_.push_back(here);
    }
  }
  std::sort(entries_.begin(), entries_.end());
  entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
}

// The ends of a lane that are outside the group are where robots wait.
bool MutexGroup::Contains(const LaneGraph& graph, const SeenRobot& robot) const {
  for (const std::size_t vertex : vertices_) {
    if (IsAt(graph.vertices[vertex], robot)) return true;
  }
  for (const std::size_t number : lanes_) {
    const LaneVertex& start = graph.vertices[graph.lanes[number].start];
    const LaneVertex& end = graph.vertices[graph.lanes[number].end];
    if (std::fabs(robot.z - start.z) >= kLevelGap) continue;
    const Vec2 way = end.position - start.position;
    const double length = way.norm();
    if (length == 0.0) continue;
    const Vec2 along = way / length;
    const Vec2 offset = robot.position - start.position;
    const double at = offset.dot(along);
    const double beside = std::fabs(along.x() * offset.y() - along.y() * offset.x());
    const double from = start.mutex == name_ ? 0.0 : std::min(kZone, 0.5 * length);
    const double to = length - (end.mutex == name_ ? 0.0 : std::min(kZone, 0.5 * length));
    if (beside < kLaneHalfWidth && at >= from && at <= to) return true;
  }
  return false;
}

// A robot that moves at an entry counts as the holder: it is driving in or has not left yet.
MutexGroup::View MutexGroup::Look(const LaneGraph& graph, const std::vector<SeenRobot>& others) const {
  View view;
  for (const SeenRobot& robot : others) {
    const bool is_at_entry = std::any_of(entries_.begin(), entries_.end(),
                                         [&](std::size_t entry) { return IsAt(graph.vertices[entry], robot); });
    if (Contains(graph, robot) || (is_at_entry && robot.moves)) {
      if (!view.holder) view.holder = robot.id;
    } else if (is_at_entry) {
      view.standing.push_back(robot.id);
    }
  }
  return view;
}

// A robot waits a turn for each robot that stood at the entries before it, and a shorter time for each smaller id, so
// that two robots do not enter together.
bool MutexTurn::MayEnter(const MutexGroup::View& view, RobotId own, double time) {
  if (!has_begun_) first_ = view.standing;
  has_begun_ = true;
  std::erase_if(first_,
                [&](RobotId robot) { return !std::binary_search(view.standing.begin(), view.standing.end(), robot); });
  if (view.holder) {
    free_since_.reset();
    return false;
  }
  if (!free_since_) free_since_ = time;
  const auto smaller = std::lower_bound(first_.begin(), first_.end(), own) - first_.begin();
  const double turns = kTurnSeconds * static_cast<double>(first_.size()) + kTieSeconds * static_cast<double>(smaller);
  return time - *free_since_ >= turns;
}

// Robots whose bodies overlap the strip of the way. `room` is m between the bodies.
std::optional<RobotAhead> FindRobotAhead(const std::vector<SeenRobot>& others, const Vec2& position, double z,
                                         const Vec2& direction, double way, double radius, double half_width) {
  std::optional<RobotAhead> nearest;
  for (const SeenRobot& other : others) {
    if (std::fabs(other.z - z) >= kLevelGap) continue;
    const Vec2 offset = other.position - position;
    const double along = offset.dot(direction);
    const double beside = std::fabs(direction.x() * offset.y() - direction.y() * offset.x());
    if (along <= 0.0 || beside >= half_width + other.radius - kSlack) continue;
    const double room = std::max(along - radius - other.radius, 0.0);
    if (room > way || (nearest && room >= nearest->room)) continue;
    nearest = {other, room};
  }
  return nearest;
}

bool IsTaken(const LaneVertex& vertex, const std::vector<SeenRobot>& others, double radius) {
  return std::any_of(others.begin(), others.end(), [&](const SeenRobot& other) {
    return std::fabs(other.z - vertex.z) < kLevelGap &&
           (other.position - vertex.position).norm() < radius + other.radius;
  });
}

// For giving way: lanes that can be driven now to a vertex that is free now.
std::vector<Leg> FreeLegs(const LaneGraph& graph, std::size_t from, const std::vector<SeenRobot>& others, double radius,
                          double half_width) {
  std::vector<Leg> legs;
  const LaneVertex& start = graph.vertices[from];
  for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
    const Lane& lane = graph.lanes[i];
    std::optional<std::size_t> to;
    if (lane.start == from) to = lane.end;
    if (lane.end == from && lane.is_bidirectional) to = lane.start;
    if (!to || graph.vertices[*to].lift || IsTaken(graph.vertices[*to], others, radius)) continue;
    const double length = graph.Way(from, *to).norm();
    if (length == 0.0) continue;
    const Vec2 along = graph.Way(from, *to) / length;
    if (FindRobotAhead(others, start.position, start.z, along, length, radius, half_width)) continue;
    legs.push_back({from, *to, i});
  }
  return legs;
}

}  // namespace troupe
