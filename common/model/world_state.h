// WorldState: everything about a world that changes, at one tick. Copyable and hashable; (description, state) is all
// that a step needs, and all that a replica or a latecomer needs.
#pragma once

#include <vector>

#include "common/base/ids.h"
#include "common/geometry/pose.h"
#include "common/model/world_description.h"

namespace troupe {

struct RobotState {
  Pose X_WR;             // of the robot's root model
  Twist twist;           // executed during the tick that ended here, in R; zero after a stall
  bool stalled = false;  // the last commanded motion was cut short by a contact
  bool operator==(const RobotState&) const = default;
};

struct JointState {
  double position = 0.0;  // m or rad
  double velocity = 0.0;  // m/s or rad/s, executed during the tick that ended here; zero after a contact
  bool blocked = false;   // the last commanded motion was cut short by a contact
  bool operator==(const JointState&) const = default;
};

struct GripperState {
  std::optional<ModelId> left_contact = {};   // what the left pad was stopped by when it last closed
  std::optional<ModelId> right_contact = {};  // likewise
  // The object between the pads. The gripper holds it if the object's holder is this gripper; otherwise another
  // gripper does, and this one takes it over when that one opens.
  std::optional<ObjectId> clamped = {};
  bool operator==(const GripperState&) const = default;
};

enum class ObjectMode : std::uint8_t {
  kPlaced = 0,   // where the file put it, or where it was let go without gravity; it stays there, also in the air
  kResting = 1,  // on what carries it
  kFalling = 2,
  kHeld = 3,
};

struct ObjectState {
  Pose X_WO = {};  // of the object's root model
  ObjectMode mode = ObjectMode::kPlaced;
  double fall_speed = 0.0;               // m/s, downwards
  std::optional<GripperId> holder = {};  // in mode kHeld
  // In mode kResting: the model under the object's centre, with which it moves; nothing on the ground, or where the
  // centre is over nothing that carries it.
  std::optional<ModelId> support = {};
  bool operator==(const ObjectState&) const = default;
};

struct WorldState {
  Tick tick = 0;
  std::vector<RobotState> robots;      // by RobotId
  std::vector<JointState> joints;      // by JointId
  std::vector<GripperState> grippers;  // by GripperId
  std::vector<ObjectState> objects;    // by ObjectId
  bool operator==(const WorldState&) const = default;
};

// The world as loaded: tick 0, everything at rest. Every object is kPlaced; the first step finds what it stands on.
WorldState InitialState(const WorldDescription& world);

}  // namespace troupe
