#include "transport/dds/convert/convert.h"
#include "transport/dds/convert/order_columns.h"

namespace troupe::dds {

troupe_wire_InputColumns ToWire(const std::vector<Input>& inputs, WireArena& arena) {
  troupe_wire_InputColumns wire{};
  if (inputs.empty()) return wire;
  const auto for_each = [&](const auto& use) {
    for (const Input& input : inputs) use(input.robot.value_or(RobotId()), input.order);
  };
  OrdersToColumns<LightOrder>(for_each, wire.lights, arena);
  OrdersToColumns<CameraOrder>(for_each, wire.cameras, arena);
  OrdersToColumns<DoorOrder>(for_each, wire.doors, arena);
  OrdersToColumns<LiftOrder>(for_each, wire.lifts, arena);
  OrdersToColumns<TwistOrder>(for_each, wire.twists, arena);
  OrdersToColumns<LaneOrder>(for_each, wire.lanes, arena);
  OrdersToColumns<ZoneOrder>(for_each, wire.zones, arena);
  return wire;
}

Status FromWire(const troupe_wire_InputColumns& wire, std::vector<Input>& inputs) {
  inputs.clear();
  const auto add = [&](RobotId robot, const Order& order) {
    inputs.push_back({robot == RobotId() ? std::nullopt : std::optional(robot), order});
    return true;
  };
  Status problem = OrdersFromColumns<LightOrder>("inputs of lights", wire.lights, add);
  if (problem.ok()) problem = OrdersFromColumns<CameraOrder>("inputs of cameras", wire.cameras, add);
  if (problem.ok()) problem = OrdersFromColumns<DoorOrder>("inputs of doors", wire.doors, add);
  if (problem.ok()) problem = OrdersFromColumns<LiftOrder>("inputs of lifts", wire.lifts, add);
  if (problem.ok()) problem = OrdersFromColumns<TwistOrder>("inputs of twists", wire.twists, add);
  if (problem.ok()) problem = OrdersFromColumns<LaneOrder>("inputs of lanes", wire.lanes, add);
  if (problem.ok()) problem = OrdersFromColumns<ZoneOrder>("inputs of zones", wire.zones, add);
  return problem;
}

}  // namespace troupe::dds
