#include "common/spatial/check_order.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/geometry/limits.h"
#include "common/model/device_limits.h"
#include "common/model/lane_rules.h"
#include "troupe/deterministic_math.h"
#include "troupe/interval.h"

namespace troupe {
namespace {

std::string NameOf(const ModelDescription& model) {
  return "'" + model.name + "'";
}

// Whether the world has what an order concerns; `robot` is nothing for an order of the building.
class OrderCheck {
 public:
  OrderCheck(const Scene& scene, std::optional<RobotId> robot) : scene_(scene), world_(scene.world()), robot_(robot) {}

  Status operator()(const LightOrder& order) const {
    if (!robot_) return NeedsRobot("a light");
    const std::size_t lights = scene_.lights_of(*robot_).size();
    if (order.light < lights) return {};
    return BadInput("found light " + std::to_string(order.light) + ", expected one of the robot's " +
                    std::to_string(lights));
  }
  Status operator()(const CameraOrder& order) const {
    if (!robot_) return NeedsRobot("a camera");
    const CameraParameters* const camera = FindCamera(world_.robot(*robot_), order.sensor);
    if (camera == nullptr) {
      return BadInput("found sensor " + std::to_string(order.sensor) + ", expected a camera of the robot");
    }
    const Interval limits = camera->TiltLimits();
    if (order.pan >= -kPi && order.pan <= kPi && order.tilt >= limits.min && order.tilt <= limits.max) return {};
    return BadInput("found the pan " + std::to_string(order.pan) + " and tilt " + std::to_string(order.tilt) +
                    " of a camera, expected -pi to pi and " + std::to_string(limits.min) + " to " +
                    std::to_string(limits.max));
  }
  Status operator()(const DoorOrder& order) const {
    if (order.door >= world_.doors.size()) {
      return BadInput("found door " + std::to_string(order.door) + ", expected one of the world's " +
                      std::to_string(world_.doors.size()));
    }
    const DoorDescription& door = world_.doors[order.door];
    // A robot may ask for it, as it may for a door that is locked: the door stays as it is.
    if (!robot_ && !door.is_operated) {
      return BadInput("door " + NameOf(world_.model(door.model)) + " is not operated: it stays as it is");
    }
    if (order.opening >= 0.0 && order.opening <= 1.0) return {};
    return BadInput("found the opening " + std::to_string(order.opening) + " of a door, expected 0 to 1");
  }
  // The floor of an order that only ends a session does not count.
  Status operator()(const LiftOrder& order) const {
    if (order.lift < world_.lifts.size() && (order.ends || order.floor < world_.lifts[order.lift].floors.size())) {
      return {};
    }
    return BadInput("found a call of lift " + std::to_string(order.lift) + " to floor " + std::to_string(order.floor) +
                    ", expected those of the world");
  }
  // The vertices are of one graph.
  Status operator()(const TrafficOrder& order) const {
    if (!robot_) return NeedsRobot("traffic");
    if (!std::isfinite(order.driven)) return BadInput("found traffic without a number of metres");
    const std::optional<GraphPlace> at = FindVertex(world_.lane_graphs, order.at);
    const std::optional<GraphPlace> goal = order.goal ? FindVertex(world_.lane_graphs, *order.goal) : at;
    if (at && goal && at->graph == goal->graph) return {};
    return BadInput("found traffic at vertex " + std::to_string(order.at) +
                    ", expected vertices of one graph of lanes");
  }
  Status operator()(const ChargeOrder& order) const {
    if (!robot_) return NeedsRobot("a charger");
    const std::size_t vertices = CountVertices(world_.lane_graphs);
    if (!order.vertex || *order.vertex < vertices) return {};
    return BadInput("found a charger at vertex " + std::to_string(*order.vertex) + ", expected one of " +
                    std::to_string(vertices) + " vertices of lanes");
  }
  Status operator()(const JobOrder&) const {
    if (!robot_) return NeedsRobot("goods");
    return {};
  }
  Status operator()(const LaneOrder& order) const {
    const std::size_t lanes = CountLanes(world_.lane_graphs);
    if (order.lane >= lanes) {
      return BadInput("found lane " + std::to_string(order.lane) + ", expected one of the world's " +
                      std::to_string(lanes));
    }
    if (std::isfinite(order.speed_limit)) return {};
    return BadInput("found a lane without a number as its speed limit");
  }
  Status operator()(const ZoneOrder& order) const {
    if (order.zone < world_.zones.size()) return {};
    return BadInput("found zone " + std::to_string(order.zone) + ", expected one of the world's " +
                    std::to_string(world_.zones.size()));
  }
  Status operator()(const WaitOrder& order) const {
    if (!robot_) return NeedsRobot("a wait");
    if (order.thing && order.thing->index() >= world_.models.size()) {
      return BadInput("found a wait for model " + std::to_string(order.thing->index()) +
                      ", expected one of the world's " + std::to_string(world_.models.size()));
    }
    const std::size_t lanes = CountLanes(world_.lane_graphs);
    if (!order.lane || *order.lane < lanes) return {};
    return BadInput("found a wait at lane " + std::to_string(*order.lane) + ", expected one of the world's " +
                    std::to_string(lanes));
  }
  Status operator()(const LoadOrder& order) const {
    if (!robot_) return NeedsRobot("a load");
    const bool is_object = order.object.index() < world_.models.size() && scene_.object_of(order.object).has_value() &&
                           !world_.model(order.object).parent;
    if (!is_object) {
      return BadInput("found a load that is model " + std::to_string(order.object.index()) + ", expected an object");
    }
    if (std::abs(order.x) <= kMaxMagnitude && std::abs(order.y) <= kMaxMagnitude) return {};
    return BadInput("found a place for a load beyond 1000 km");
  }
  Status operator()(const TwistOrder& order) const {
    if (!robot_) return NeedsRobot("a twist");
    // A twist that a tool sets is a jump: only the bounds of the velocity count, not the bounds of the acceleration.
    constexpr double kLongEnough = 1e9;  // s, for any acceleration
    const RobotDescription& robot = world_.robot(*robot_);
    if (IsFinite(order.twist) && troupe::WithinLimits(robot.drive, {}, order.twist, kLongEnough)) return {};
    return BadInput("found a twist that the drive of '" + robot.name + "' cannot have, expected one within its limits");
  }

 private:
  static Status NeedsRobot(const char* what) {
    return BadInput(std::string("found an order for ") + what + " of no robot");
  }

  const Scene& scene_;
  const WorldDescription& world_;
  const std::optional<RobotId> robot_;
};

bool HasRobot(const WorldDescription& world, RobotId robot) {
  return robot.index() < world.robots.size() && RobotExists(world, robot);
}

}  // namespace

std::vector<Order> ByKind(std::vector<Order> orders) {
  std::stable_sort(orders.begin(), orders.end(), [](const Order& a, const Order& b) { return a.index() < b.index(); });
  return orders;
}

std::vector<Input> ByKind(std::vector<Input> inputs) {
  std::stable_sort(inputs.begin(), inputs.end(),
                   [](const Input& a, const Input& b) { return a.order.index() < b.order.index(); });
  return inputs;
}

Order WithinLimits(const WorldDescription& world, RobotId robot, Order order) {
  if (auto* const turn = std::get_if<CameraOrder>(&order)) {
    const CameraParameters* const camera = FindCamera(world.robot(robot), turn->sensor);
    if (camera != nullptr && std::isfinite(turn->pan) && std::isfinite(turn->tilt)) {
      const Interval limits = camera->TiltLimits();
      turn->pan = WrapAngle(turn->pan);
      turn->tilt = std::clamp(turn->tilt, limits.min, limits.max);
    }
  }
  return order;
}

Status CheckOrder(const Scene& scene, RobotId robot, const Order& order) {
  if (std::holds_alternative<TwistOrder>(order)) return BadInput("found a twist, expected an order that a robot gives");
  if (std::holds_alternative<LaneOrder>(order) || std::holds_alternative<ZoneOrder>(order)) {
    return BadInput("found a rule of a lane or a zone, expected an order that a robot gives");
  }
  return std::visit(OrderCheck(scene, robot), order);
}

Status CheckInput(const Scene& scene, const Input& input) {
  const WorldDescription& world = scene.world();
  if (std::holds_alternative<TrafficOrder>(input.order)) return BadInput("found traffic, expected an order of a tool");
  if (std::holds_alternative<ChargeOrder>(input.order) || std::holds_alternative<JobOrder>(input.order) ||
      std::holds_alternative<LoadOrder>(input.order)) {
    return BadInput("found a demand of a robot, expected an order of a tool");
  }
  if (std::holds_alternative<WaitOrder>(input.order)) return BadInput("found a wait, expected an order of a tool");
  if (input.robot && !HasRobot(world, *input.robot)) {
    return BadInput("found an order for a robot that the world does not have");
  }
  Status problem = std::visit(OrderCheck(scene, input.robot), input.order);
  if (problem.ok() || !input.robot) return problem;
  return BadInput("robot " + world.robot(*input.robot).name + ": " + problem.error().message);
}

}  // namespace troupe
