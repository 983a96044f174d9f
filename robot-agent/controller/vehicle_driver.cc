#include "robot-agent/controller/vehicle_driver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robot-agent/controller/path_follower.h"
#include "robot-agent/navigation/steering.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kArrived = 0.01;      // m, along the path to a node at which it stops
constexpr double kLeastAhead = 0.15;   // m, to the point that it drives to
constexpr double kAheadSeconds = 0.5;  // s, that it drives to that point
constexpr double kCorner = 0.3;        // rad: it stops at a greater one
constexpr double kTurnFrom = 0.35;     // rad: it turns in place towards a point farther to a side,
constexpr double kTurnTo = 0.02;       // until it faces it
constexpr double kSlightest = 0.002;   // rad: no turn
constexpr double kNearNode = 1.0;      // m: the line of an edge begins at its node, if that is so near
constexpr double kLookOnCurve = 0.8;   // m, straight ahead on a curve
constexpr double kSeen = 8.0;          // m of the base, along which it looks for doors and lifts
constexpr double kStopMargin = 0.02;   // m, beyond the place where it stops

double AngleBetween(const Vec2& a, const Vec2& b) {
  return std::fabs(Atan2(Cross(a, b), a.dot(b)));
}

// An action for which the vehicle stands waits at the node or the edge.
bool HasStop(const std::vector<fleet::Action>& actions) {
  return std::any_of(actions.begin(), actions.end(),
                     [](const fleet::Action& action) { return fleet::StopsDriving(action.blocking_type); });
}

const fleet::Edge* EdgeBefore(const fleet::VehicleMemory& memory, std::size_t node) {
  return node < memory.edges.size() ? &memory.edges[node] : nullptr;
}

}  // namespace

VehicleDriver::VehicleDriver(const RobotInfo& info, fleet::VehicleSettings settings)
    : id_(info.id), drive_(info.robot->drive), settings_(std::move(settings)), graphs_(info.lane_graphs) {}

void VehicleDriver::Forget() {
  target_.reset();
  from_.reset();
  is_turning_ = false;
}

// Of the order, or of a vertex of the lanes with the name of the node.
std::optional<Vec2> VehicleDriver::PositionOf(const fleet::Node& node) const {
  if (node.position) return Vec2(node.position->x, node.position->y);
  for (const LaneGraph& graph : graphs_) {
    for (const LaneVertex& vertex : graph.vertices) {
      if (vertex.name == node.id) return vertex.position;
    }
  }
  return std::nullopt;
}

bool VehicleDriver::IsBackward(const fleet::Edge* edge, const Vec2& direction) const {
  if (edge == nullptr || !edge->orientation || drive_.type == DriveType::kOmni || drive_.velocity.x.min >= 0.0) {
    return false;
  }
  const bool is_global = edge->orientation_type == fleet::OrientationType::kGlobal;
  const double course = is_global ? Atan2(direction.y(), direction.x()) : 0.0;
  return std::fabs(WrapAngle(*edge->orientation - course)) > kPi / 2.0;
}

void VehicleDriver::Begin(const fleet::VehicleMemory& memory, const fleet::Node& node, const Pose& X_WR) {
  const Vec2 at = X_WR.translation();
  const Vec2 end = *PositionOf(node);
  const bool continues = target_ && target_order_ == memory.order_id;
  const std::optional<Vec2> before = continues && !path_.empty() ? std::optional(path_.end()) : std::nullopt;
  if (target_ != node.sequence_id) from_ = before;
  const Vec2 start = from_ && (*from_ - at).norm() < kNearNode ? *from_ : at;
  const fleet::Edge* const edge = EdgeBefore(memory, 0);
  std::vector<Vec2> points = {start, end};
  if (edge != nullptr && edge->trajectory) {
    points = PointsOf(*edge->trajectory);
    points.push_back(end);
  }
  path_ = VehiclePath(points);
  has_edge_ = edge != nullptr;
  is_backward_ = IsBackward(edge, path_.DirectionAt(0.0));
  is_turning_ = false;
  along_ = 0.0;
  target_ = node.sequence_id;
  target_order_ = memory.order_id;
}

bool VehicleDriver::StopsAt(const fleet::VehicleMemory& memory, std::size_t number) const {
  if (number + 1 >= memory.nodes.size() || !memory.nodes[number + 1].released) return true;
  const fleet::Node& node = memory.nodes[number];
  if (HasStop(node.actions) || (node.position && node.position->theta)) return true;
  const fleet::Edge* const next = EdgeBefore(memory, number + 1);
  return next == nullptr || HasStop(next->actions) || next->orientation.has_value() || next->trajectory.has_value();
}

double VehicleDriver::WayBehind(const fleet::VehicleMemory& memory) const {
  double way = 0.0;
  Vec2 direction = path_.DirectionAt(path_.length());
  Vec2 at = path_.end();
  for (std::size_t i = 0; !StopsAt(memory, i); ++i) {
    const std::optional<Vec2> next = PositionOf(memory.nodes[i + 1]);
    if (!next) break;
    const Vec2 leg = *next - at;
    const double length = leg.norm();
    if (length < kArrived || AngleBetween(direction, leg) > kCorner) break;
    way += length;
    direction = leg / length;
    at = *next;
  }
  return way;
}

double VehicleDriver::SpeedOf(const fleet::Edge* edge, bool is_backward) const {
  double most = std::min(settings_.speed, is_backward ? -drive_.velocity.x.min : drive_.velocity.x.max);
  if (edge != nullptr && edge->maximum_speed) most = std::min(most, *edge->maximum_speed);
  return std::max(most, 0.0);
}

double VehicleDriver::SpeedOf(const fleet::VehicleMemory& memory) const {
  return SpeedOf(EdgeBefore(memory, 0), is_backward_);
}

double VehicleDriver::TurnRateOf(const fleet::Edge* edge) const {
  double most = std::min(settings_.turn_rate, drive_.velocity.heading.max);
  if (edge != nullptr && edge->maximum_rotation_speed) most = std::min(most, *edge->maximum_rotation_speed);
  return most;
}

double VehicleDriver::TurnBy(double angle, double most, double interval) const {
  if (std::fabs(angle) < kSlightest) return 0.0;
  return std::copysign(SpeedFor(std::fabs(angle), most, -drive_.acceleration.heading.min, interval), angle);
}

// Of an omni drive on its way.
std::optional<double> VehicleDriver::HeadingAt(const fleet::Edge* edge, const Vec2& direction) const {
  if (direction == Vec2(Vec2::Zero())) return std::nullopt;
  const double course = Atan2(direction.y(), direction.x());
  if (edge == nullptr || !edge->orientation) return course;
  if (edge->orientation_type == fleet::OrientationType::kGlobal) return *edge->orientation;
  return WrapAngle(course + *edge->orientation);
}

// Of a drive that cannot move to a side.
Command VehicleDriver::CommandOf(double speed, double curvature, double turn) const {
  Command command;
  if (drive_.type == DriveType::kCar) {
    command.speed = speed;
    command.steering = Atan2(curvature * drive_.wheelbase, 1.0);
  } else {
    command.twist = {speed, 0.0, speed == 0.0 ? turn : speed * curvature};
  }
  return command;
}

// The motion towards the point ahead at no more than `speed`.
Command VehicleDriver::Follow(const fleet::VehicleMemory& memory, const Observation& observation, double speed) {
  const Pose& X_WR = observation.pose_estimate;
  const fleet::Edge* const edge = EdgeBefore(memory, 0);
  const double ahead = std::max(kLeastAhead, kAheadSeconds * std::fabs(speed));
  const Vec2 p_R = Transform2(X_WR).InverseTransform(path_.At(along_ + ahead));
  const double distance = std::max(p_R.norm(), 1e-6);
  const double turn_rate = TurnRateOf(edge);
  if (drive_.type == DriveType::kOmni) {
    const Vec2 velocity = speed / distance * p_R;
    const std::optional<double> heading = HeadingAt(edge, path_.DirectionAt(along_));
    const bool may_turn = edge == nullptr || edge->rotation_allowed.value_or(true);
    const double turn =
        heading && may_turn ? TurnBy(WrapAngle(*heading - X_WR.heading), turn_rate, observation.interval) : 0.0;
    return {.twist = {velocity.x(), velocity.y(), turn}};
  }
  const double side = is_backward_ ? -1.0 : 1.0;
  const double bearing = Atan2(side * p_R.y(), side * p_R.x());
  if (drive_.type != DriveType::kCar) {
    is_turning_ = std::fabs(bearing) > (is_turning_ ? kTurnTo : kTurnFrom);
    if (is_turning_) return CommandOf(0.0, 0.0, TurnBy(bearing, turn_rate, observation.interval));
  }
  const double curvature = 2.0 * p_R.y() / (distance * distance);
  if (curvature != 0.0) speed = std::min(speed, turn_rate / std::fabs(curvature));
  return CommandOf(side * speed, curvature, 0.0);
}

// Looks with the vehicle's body as far as it has to brake, but not beyond the place where it stops.
void VehicleDriver::StopBefore(const fleet::VehicleMemory& memory, const Observation& observation,
                               const Surroundings& around, double to_stop, Motion& motion, double& speed) const {
  const Pose& X_WR = around.PoseOf(id_);
  Vec2 direction = path_.At(along_ + kLeastAhead) - observation.pose_estimate.translation();
  if (drive_.type != DriveType::kOmni) {
    const SinCosResult course = SinCos(X_WR.heading);
    direction = (is_backward_ ? -1.0 : 1.0) * Vec2(course.cos, course.sin);
  }
  if (direction == Vec2(Vec2::Zero())) return;
  const double braking = std::max(-drive_.acceleration.x.min, 1e-3);
  double way = speed * speed / (2.0 * braking) + settings_.gap + 2.0 * speed * observation.interval + kStopMargin;
  way = std::min(way, to_stop + kStopMargin);
  const fleet::Edge* const edge = EdgeBefore(memory, 0);
  if (edge != nullptr && edge->trajectory) way = std::min(way, kLookOnCurve);
  const std::optional<ContactAhead> contact = FindContactAhead(around, id_, X_WR, direction.normalized(), way);
  if (!contact) return;
  const double room = contact->room - settings_.gap;
  if (room < kArrived) {
    motion.obstacle = contact->model;
    speed = 0.0;
  } else {
    speed = std::min(speed, SpeedFor(room, speed, braking, observation.interval));
  }
}

std::optional<VehicleWay> VehicleDriver::Look(const fleet::VehicleMemory& memory, const Observation& observation) {
  const fleet::Node& node = memory.nodes.front();
  if (!PositionOf(node)) return std::nullopt;
  const Pose& X_WR = observation.pose_estimate;
  if (target_ != node.sequence_id || target_order_ != memory.order_id) Begin(memory, node, X_WR);
  const Vec2 at = X_WR.translation();
  along_ = path_.Nearest(at, along_, along_ + kNearNode);

  VehicleWay way;
  way.points.push_back({at});
  std::vector<Vec2> rest;
  path_.AddRest(along_, rest);
  const auto trajectory_to = [&](std::size_t index) -> const fleet::Trajectory* {
    const fleet::Edge* const edge = EdgeBefore(memory, index);
    return edge != nullptr && edge->trajectory ? &*edge->trajectory : nullptr;
  };
  for (const Vec2& place : rest) way.points.push_back({.place = place, .is_traced = trajectory_to(0) != nullptr});
  double length = path_.length() - along_;
  for (std::size_t i = 0; i < memory.nodes.size() && memory.nodes[i].released && length < kSeen; ++i) {
    const std::optional<Vec2> place = PositionOf(memory.nodes[i]);
    if (!place) break;
    if (i > 0) {
      const fleet::Trajectory* const trajectory = trajectory_to(i);
      std::vector<Vec2> line = trajectory != nullptr ? PointsOf(*trajectory) : std::vector<Vec2>();
      line.push_back(*place);
      for (const Vec2& point : line) {
        if (line.size() > 1 && point == way.points.back().place) continue;
        length += (point - way.points.back().place).norm();
        way.points.push_back({.place = point, .is_traced = trajectory != nullptr});
      }
    }
    way.points.back().is_node = true;
    if (memory.nodes[i].position) way.points.back().map = memory.nodes[i].position->map_id;
  }
  return way;
}

VehicleDriver::Motion VehicleDriver::Drive(const fleet::VehicleMemory& memory, const Observation& observation,
                                           const Surroundings& around, const std::optional<double>& most,
                                           double fastest) {
  Motion motion;
  const fleet::Node& node = memory.nodes.front();
  const Pose& X_WR = observation.pose_estimate;
  const Vec2 at = X_WR.translation();
  motion.driven = along_;
  const double rest = path_.length() - along_;
  const double behind = WayBehind(memory);
  const double to_stop = rest + behind;
  motion.room = to_stop;
  const fleet::Edge* const edge = EdgeBefore(memory, 0);

  if (behind > 0.0) {
    motion.has_reached = rest <= std::max(kArrived, 0.5 * std::fabs(observation.twist.vx) * observation.interval);
  } else if (rest <= kArrived) {
    const double deviation =
        node.position && node.position->allowed_deviation_xy ? node.position->allowed_deviation_xy->b : 0.0;
    const bool is_near = (path_.end() - at).norm() <= std::max(deviation, settings_.tolerance);
    if (!is_near && drive_.type != DriveType::kCar) {
      // Off the line, as after a push: straight to the node.
      from_.reset();
      path_ = VehiclePath({at, path_.end()});
      along_ = 0.0;
      return motion;
    }
    const std::optional<double> theta = node.position ? node.position->theta : std::nullopt;
    const double left = theta && drive_.type != DriveType::kCar ? WrapAngle(*theta - X_WR.heading) : 0.0;
    const double allowed = std::max(node.position ? node.position->allowed_deviation_theta.value_or(0.0) : 0.0,
                                    settings_.heading_tolerance);
    if (std::fabs(left) <= allowed) {
      motion.has_reached = true;
    } else {
      motion.command.twist.wz = TurnBy(left, TurnRateOf(edge), observation.interval);
    }
    return motion;
  }
  const double room = std::min(behind > 0.0 ? to_stop : rest, most.value_or(to_stop));
  double speed = room <= kArrived && most ? 0.0
                                          : SpeedFor(room, std::min(SpeedOf(edge, is_backward_), fastest),
                                                     -drive_.acceleration.x.min, observation.interval);
  StopBefore(memory, observation, around, room, motion, speed);
  motion.command = Follow(memory, observation, speed);
  if (is_turning_) motion.obstacle.reset();  // it will look another way
  return motion;
}

}  // namespace troupe
