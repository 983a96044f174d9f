// The converters of the parts of a world description; their files have their names.
#pragma once

#include <cstdint>

#include "transport/dds/convert/convert.h"

namespace troupe::dds {

inline constexpr std::int32_t kNoIndex = -1;  // on the wire, of an id that is none

// convert_shape.cc
troupe_wire_Shape ToWire(const Shape& shape, WireArena& arena);
Status FromWire(const troupe_wire_Shape& wire, Shape& shape);

// convert_model.cc
troupe_wire_Model ToWire(const ModelDescription& model, WireArena& arena);
Status FromWire(const troupe_wire_Model& wire, ModelDescription& model);
troupe_wire_Place ToWire(const NamedPlace& place, WireArena& arena);
Status FromWire(const troupe_wire_Place& wire, NamedPlace& place);

// convert_robot.cc
troupe_wire_Sensor ToWire(const SensorDescription& sensor, WireArena& arena);
Status FromWire(const troupe_wire_Sensor& wire, SensorDescription& sensor);
troupe_wire_Robot ToWire(const RobotDescription& robot, WireArena& arena);
Status FromWire(const troupe_wire_Robot& wire, RobotDescription& robot);
troupe_wire_Joint ToWire(const JointDescription& joint, WireArena& arena);
Status FromWire(const troupe_wire_Joint& wire, JointDescription& joint);
troupe_wire_Gripper ToWire(const GripperDescription& gripper, WireArena& arena);
Status FromWire(const troupe_wire_Gripper& wire, GripperDescription& gripper);

// convert_site.cc
troupe_wire_Door ToWire(const DoorDescription& door, WireArena& arena);
Status FromWire(const troupe_wire_Door& wire, DoorDescription& door);
troupe_wire_Lift ToWire(const LiftDescription& lift, WireArena& arena);
Status FromWire(const troupe_wire_Lift& wire, LiftDescription& lift);
troupe_wire_Level ToWire(const LevelDescription& level, WireArena& arena);
Status FromWire(const troupe_wire_Level& wire, LevelDescription& level);
troupe_wire_LaneVertex ToWire(const LaneVertex& vertex, WireArena& arena);
Status FromWire(const troupe_wire_LaneVertex& wire, LaneVertex& vertex);
troupe_wire_Lane ToWire(const Lane& lane, WireArena& arena);
Status FromWire(const troupe_wire_Lane& wire, Lane& lane);
troupe_wire_LaneGraph ToWire(const LaneGraph& graph, WireArena& arena);
Status FromWire(const troupe_wire_LaneGraph& wire, LaneGraph& graph);

// convert_people.cc
troupe_wire_GoalSet ToWire(const GoalSet& set, WireArena& arena);
Status FromWire(const troupe_wire_GoalSet& wire, GoalSet& set);
troupe_wire_Person ToWire(const PersonDescription& person, WireArena& arena);
Status FromWire(const troupe_wire_Person& wire, PersonDescription& person);

// A sequence of parts.
template <typename Part, typename Sequence>
void PartsToWire(const std::vector<Part>& parts, Sequence& wire, WireArena& arena) {
  auto* out = arena.Fill(wire, parts.size());
  for (const Part& part : parts) *out++ = ToWire(part, arena);
}
// Appends them.
template <typename Sequence, typename Part>
Status PartsFromWire(const Sequence& wire, std::vector<Part>& parts) {
  for (const auto& part : Elements(wire)) {
    if (Status failed = FromWire(part, parts.emplace_back()); !failed.ok()) return failed;
  }
  return {};
}

}  // namespace troupe::dds
