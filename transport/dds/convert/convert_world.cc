#include "transport/dds/convert/convert_parts.h"

namespace troupe::dds {

troupe_wire_World ToWire(const WorldDescription& world, WireArena& arena) {
  troupe_wire_World wire{};
  wire.name = arena.Copy(world.name);
  wire.seed = world.seed;
  wire.interval = world.interval_ns;
  PartsToWire(world.shapes, wire.shapes, arena);
  PartsToWire(world.models, wire.models, arena);
  PartsToWire(world.robots, wire.robots, arena);
  PartsToWire(world.joints, wire.joints, arena);
  PartsToWire(world.grippers, wire.grippers, arena);
  std::uint32_t* objects = arena.Fill(wire.objects, world.objects.size());
  for (ModelId object : world.objects) *objects++ = static_cast<std::uint32_t>(object.index());
  wire.gravity = world.gravity;
  PartsToWire(world.places, wire.places, arena);
  PartsToWire(world.doors, wire.doors, arena);
  PartsToWire(world.lifts, wire.lifts, arena);
  PartsToWire(world.goal_sets, wire.goal_sets, arena);
  PartsToWire(world.people, wire.people, arena);
  PartsToWire(world.levels, wire.levels, arena);
  PartsToWire(world.lane_graphs, wire.lane_graphs, arena);
  return wire;
}

namespace {

// Equal robots mostly follow one another: each shares its list of rays with the one before.
void ShareRaySensors(std::vector<RobotDescription>& robots) {
  const auto rays_of = [](RobotDescription& robot, std::size_t sensor) {
    auto* const ranger =
        sensor < robot.sensors.size() ? std::get_if<RangerParameters>(&robot.sensors[sensor].parameters) : nullptr;
    return ranger != nullptr ? &ranger->ray_sensors : nullptr;
  };
  for (std::size_t i = 1; i < robots.size(); ++i) {
    for (std::size_t sensor = 0; sensor < robots[i].sensors.size(); ++sensor) {
      auto* const own = rays_of(robots[i], sensor);
      const auto* const other = rays_of(robots[i - 1], sensor);
      if (own != nullptr && other != nullptr && *own == *other) *own = *other;
    }
  }
}

}  // namespace

Result<WorldDescription> FromWire(const troupe_wire_World& wire) {
  WorldDescription world;
  world.name = Text(wire.name);
  world.seed = wire.seed;
  world.interval_ns = wire.interval;
  Status status;
  const auto read = [&](const auto& from, auto& to) {
    if (status.ok()) status = PartsFromWire(from, to);
  };
  read(wire.shapes, world.shapes);
  read(wire.models, world.models);
  read(wire.robots, world.robots);
  ShareRaySensors(world.robots);
  read(wire.joints, world.joints);
  read(wire.grippers, world.grippers);
  for (std::uint32_t object : Elements(wire.objects)) world.objects.emplace_back(object);
  world.gravity = wire.gravity;
  read(wire.places, world.places);
  read(wire.doors, world.doors);
  read(wire.lifts, world.lifts);
  read(wire.goal_sets, world.goal_sets);
  read(wire.people, world.people);
  read(wire.levels, world.levels);
  read(wire.lane_graphs, world.lane_graphs);
  if (status.ok()) status = Validate(world);
  if (!status.ok()) return status.error();
  return world;
}

}  // namespace troupe::dds
