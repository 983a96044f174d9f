// Doors, lifts, levels and lanes.
#include <string>
#include <vector>

#include "transport/dds/convert/convert_parts.h"

namespace troupe::dds {
namespace {

// `Sequence`: one of idlc of 32 bits.
template <typename Sequence>
void NumbersToWire(const std::vector<std::size_t>& numbers, Sequence& wire, WireArena& arena) {
  std::uint32_t* out = arena.Fill(wire, numbers.size());
  for (const std::size_t number : numbers) *out++ = static_cast<std::uint32_t>(number);
}
template <typename Sequence>
std::vector<std::size_t> NumbersFromWire(const Sequence& wire) {
  const auto numbers = Elements(wire);
  return {numbers.begin(), numbers.end()};
}

}  // namespace

troupe_wire_LaneVertex ToWire(const LaneVertex& vertex, WireArena& arena) {
  troupe_wire_LaneVertex wire{};
  wire.name = arena.Copy(vertex.name);
  wire.x = vertex.position.x();
  wire.y = vertex.position.y();
  wire.z = vertex.z;
  wire.charger = vertex.is_charger;
  wire.dock = arena.Copy(vertex.dock);
  wire.mutex = arena.Copy(vertex.mutex);
  wire.lift = vertex.lift ? static_cast<std::int32_t>(*vertex.lift) : kNoIndex;
  wire.floor = vertex.floor;
  return wire;
}
Status FromWire(const troupe_wire_LaneVertex& wire, LaneVertex& vertex) {
  vertex.name = Text(wire.name);
  vertex.position = {wire.x, wire.y};
  vertex.z = wire.z;
  vertex.is_charger = wire.charger;
  vertex.dock = Text(wire.dock);
  vertex.mutex = Text(wire.mutex);
  if (wire.lift < kNoIndex) return Error{{}, "a vertex of lanes with lift " + std::to_string(wire.lift)};
  if (wire.lift != kNoIndex) vertex.lift = static_cast<std::uint32_t>(wire.lift);
  vertex.floor = wire.floor;
  return {};
}

troupe_wire_Lane ToWire(const Lane& lane, WireArena& arena) {
  troupe_wire_Lane wire{};
  wire.start = lane.start;
  wire.end = lane.end;
  wire.bidirectional = lane.is_bidirectional;
  wire.speed_limit = lane.speed_limit;
  wire.facing = static_cast<std::uint8_t>(lane.facing);
  wire.mutex = arena.Copy(lane.mutex);
  troupe_wire_LaneDoor* doors = arena.Fill(wire.doors, lane.doors.size());
  for (const LaneDoor& door : lane.doors) *doors++ = {door.door, door.at};
  return wire;
}
Status FromWire(const troupe_wire_Lane& wire, Lane& lane) {
  lane.start = wire.start;
  lane.end = wire.end;
  lane.is_bidirectional = wire.bidirectional;
  lane.speed_limit = wire.speed_limit;
  lane.facing = static_cast<LaneFacing>(wire.facing);
  lane.mutex = Text(wire.mutex);
  for (const troupe_wire_LaneDoor& door : Elements(wire.doors)) lane.doors.push_back({door.door, door.at});
  return {};
}

troupe_wire_Door ToWire(const DoorDescription& door, WireArena& arena) {
  troupe_wire_Door wire{};
  wire.model = static_cast<std::uint32_t>(door.model.index());
  troupe_wire_DoorLeaf* leaves = arena.Fill(wire.leaves, door.leaves.size());
  for (const DoorLeaf& leaf : door.leaves) {
    *leaves++ = {static_cast<std::uint32_t>(leaf.object.index()), PoseToWire(leaf.X_WH), leaf.turn, leaf.shift};
  }
  wire.seconds = door.seconds;
  wire.reach = door.reach;
  wire.opening = door.opening;
  wire.operated = door.is_operated;
  return wire;
}
Status FromWire(const troupe_wire_Door& wire, DoorDescription& door) {
  door.model = ModelId(wire.model);
  for (const troupe_wire_DoorLeaf& leaf : Elements(wire.leaves)) {
    door.leaves.push_back({ObjectId(leaf.object), PoseFromWire(leaf.closed), leaf.turn, leaf.shift});
  }
  door.seconds = wire.seconds;
  door.reach = wire.reach;
  door.opening = wire.opening;
  door.is_operated = wire.operated;
  return {};
}

troupe_wire_Lift ToWire(const LiftDescription& lift, WireArena& arena) {
  troupe_wire_Lift wire{};
  wire.model = static_cast<std::uint32_t>(lift.model.index());
  wire.cabin = static_cast<std::uint32_t>(lift.cabin.index());
  NumbersToWire(lift.cabin_doors, wire.cabin_doors, arena);
  troupe_wire_LiftFloor* floors = arena.Fill(wire.floors, lift.floors.size());
  for (const LiftFloor& floor : lift.floors) {
    floors->name = arena.Copy(floor.name);
    floors->z = floor.z;
    NumbersToWire(floor.doors, floors->doors, arena);
    ++floors;
  }
  wire.floor = lift.floor;
  wire.speed = lift.speed;
  return wire;
}
Status FromWire(const troupe_wire_Lift& wire, LiftDescription& lift) {
  lift.model = ModelId(wire.model);
  lift.cabin = ObjectId(wire.cabin);
  lift.cabin_doors = NumbersFromWire(wire.cabin_doors);
  for (const troupe_wire_LiftFloor& floor : Elements(wire.floors)) {
    lift.floors.push_back({Text(floor.name), floor.z, NumbersFromWire(floor.doors)});
  }
  lift.floor = wire.floor;
  lift.speed = wire.speed;
  return {};
}

troupe_wire_Level ToWire(const LevelDescription& level, WireArena& arena) {
  return {arena.Copy(level.name), level.z};
}
Status FromWire(const troupe_wire_Level& wire, LevelDescription& level) {
  level = {Text(wire.name), wire.z};
  return {};
}

troupe_wire_LaneGraph ToWire(const LaneGraph& graph, WireArena& arena) {
  troupe_wire_LaneGraph wire{};
  wire.number = graph.number;
  PartsToWire(graph.vertices, wire.vertices, arena);
  PartsToWire(graph.lanes, wire.lanes, arena);
  return wire;
}
Status FromWire(const troupe_wire_LaneGraph& wire, LaneGraph& graph) {
  graph.number = wire.number;
  if (Status failed = PartsFromWire(wire.vertices, graph.vertices); !failed.ok()) return failed;
  return PartsFromWire(wire.lanes, graph.lanes);
}

}  // namespace troupe::dds
