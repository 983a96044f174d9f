// Functions of states: the check of one that a peer sent, the hash, and the poses of models.
//
// A state is a set of tables, one row per robot, joint, object, ... in the order of the world description; all of these
// functions go through the list of tables (ForEachTable), so that a new table cannot be forgotten. Cost: linear in the
// rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// The rows of a state whose number follows from the whole world.
struct DeviceCounts {
  std::size_t stores = 0;
  std::size_t imus = 0;
  std::size_t lights = 0;
  std::size_t cameras = 0;
};
DeviceCounts CountDevices(const WorldDescription& world);

// Success if the state belongs to the world: as many robots, joints, grippers, objects and devices, finite numbers,
// known ids. REQUIRES: `devices` is CountDevices(world)
Status CheckState(const WorldDescription& world, const DeviceCounts& devices, const WorldState& state);
Status CheckState(const WorldDescription& world, const WorldState& state);

// True if each table has as many rows in both, but for the radio messages on their way.
bool HaveSameRows(const WorldState& a, const WorldState& b);

// The state hash: 64 bits that differ when any bit of a state does (up to collisions). Two runs are the same when their
// hashes are the same at every tick.
std::uint64_t StateHash(const WorldState& state);

// The ticks of a time, to the nearest. REQUIRES: seconds >= 0
Tick TicksIn(const WorldDescription& world, double seconds);

// The model that holds or supports an object; nothing on the ground.
std::optional<ModelId> CarrierOf(const WorldDescription& world, const ObjectState& object);

// The poses of the models of a state: forward kinematics of robots, joints and objects.

// The motion of the joint's model at position `q` (m or rad): X_PM(q) = X_PM * JointMotion(q).
Pose JointMotion(const JointDescription& joint, double q);

// Poses of all models in a state, frame W, in id order. REQUIRES: the state belongs to the world.
std::vector<Pose> ModelPoses(const WorldDescription& world, const WorldState& state);

}  // namespace troupe
