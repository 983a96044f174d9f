// Models and places.
#include "transport/dds/convert/convert_parts.h"

namespace troupe::dds {

troupe_wire_Model ToWire(const ModelDescription& model, WireArena& arena) {
  troupe_wire_Model wire{};
  wire.name = arena.Copy(model.name);
  wire.type = arena.Copy(model.type);
  wire.parent = model.parent ? static_cast<std::int32_t>(model.parent->index()) : kNoIndex;
  wire.pose_in_parent = PoseToWire(model.X_PM);
  wire.shape = static_cast<std::uint32_t>(model.shape.index());
  wire.size_x = model.size_x;
  wire.size_y = model.size_y;
  wire.size_z = model.size_z;
  wire.color = {model.color.r, model.color.g, model.color.b, model.color.a};
  wire.obstacle_return = model.obstacle_return;
  wire.ranger_return = model.ranger_return;
  wire.gripper_return = model.gripper_return;
  wire.fiducial_return = model.fiducial_return;
  wire.fiducial_key = model.fiducial_key;
  wire.show_nose = model.show_nose;
  wire.blink_period = model.blinking.period_ns;
  wire.blink_on = model.blinking.on_ns;
  wire.switched_on = model.blinking.is_switched_on;
  wire.has_store = model.power.has_store;
  wire.endless = model.power.endless;
  wire.joules = model.power.joules;
  wire.capacity = model.power.capacity;
  wire.watts = model.power.watts;
  wire.mass = model.power.mass;
  wire.give_watts = model.power.give_watts;
  wire.take_watts = model.power.take_watts;
  wire.map_columns = model.map.columns;
  wire.map_rows = model.map.rows;
  wire.map_resolution = model.map.resolution;
  wire.removed = model.removed;
  return wire;
}
Status FromWire(const troupe_wire_Model& wire, ModelDescription& model) {
  model.name = Text(wire.name);
  model.type = Text(wire.type);
  if (wire.parent < kNoIndex) return Error{{}, "model '" + model.name + "' with parent " + std::to_string(wire.parent)};
  if (wire.parent != kNoIndex) model.parent = ModelId(static_cast<std::size_t>(wire.parent));
  model.X_PM = PoseFromWire(wire.pose_in_parent);
  model.shape = ShapeId(wire.shape);
  model.size_x = wire.size_x;
  model.size_y = wire.size_y;
  model.size_z = wire.size_z;
  model.color = {wire.color.r, wire.color.g, wire.color.b, wire.color.a};
  model.obstacle_return = wire.obstacle_return;
  model.ranger_return = wire.ranger_return;
  model.gripper_return = wire.gripper_return;
  model.fiducial_return = wire.fiducial_return;
  model.fiducial_key = wire.fiducial_key;
  model.show_nose = wire.show_nose;
  model.blinking = {wire.blink_period, wire.blink_on, wire.switched_on};
  model.power = {wire.has_store, wire.endless, wire.joules,     wire.capacity,
                 wire.watts,     wire.mass,    wire.give_watts, wire.take_watts};
  model.map = {wire.map_columns, wire.map_rows, wire.map_resolution};
  model.removed = wire.removed;
  return {};
}

troupe_wire_Place ToWire(const NamedPlace& place, WireArena& arena) {
  troupe_wire_Place wire{};
  wire.name = arena.Copy(place.name);
  wire.description = arena.Copy(place.description);
  arena.FillStrings(wire.tags, place.tags);
  wire.pose = PoseToWire(place.X_WN);
  return wire;
}
Status FromWire(const troupe_wire_Place& wire, NamedPlace& place) {
  place = {Text(wire.name), Text(wire.description), Strings(wire.tags), PoseFromWire(wire.pose)};
  return {};
}

}  // namespace troupe::dds
