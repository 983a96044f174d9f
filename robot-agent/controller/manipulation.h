// The joints and grippers of a robot in a controller's observations and commands. Part of controller.h.
//
// Joints have their indices in RobotInfo::joints, grippers in RobotInfo::grippers.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/ids.h"
#include "common/model/world_description.h"

namespace troupe {

// A model of the world that a sensor or gripper recognizes. The name lives as long as the controller.
struct SeenModel {
  ModelId id;
  std::string_view name = {};
  bool operator==(const SeenModel&) const = default;
};

struct JointReading {
  double position = 0.0;  // m or rad
  double velocity = 0.0;  // m/s or rad/s, executed during the last tick
  bool blocked = false;   // a contact ended the last tick's motion
  bool moving = false;    // on its way to its target; false at the target, or blocked
};

enum class FingerState : std::uint8_t {
  kOpen,  // all the way
  kClosing,
  kClosed,  // they cannot close further: on an object, on another contact, or on each other; or they stay half open
  kOpening,
};

enum class FingerCommand : std::uint8_t {
  kOpen,
  kClose,
  kStay,  // at their positions, with the object that they hold
};

struct GripperReading {
  FingerState fingers = FingerState::kOpen;
  bool lift_moving = false;                    // on its way to its target height; false at the target, or blocked
  double lift_position = 0.0;                  // m
  double lift_percent = 0.0;                   // of the way from its minimum to its maximum
  std::optional<SeenModel> left_contact = {};  // the model that stopped the pad when it last closed
  std::optional<SeenModel> right_contact = {};
  std::optional<SeenModel> held = {};     // the object that it holds
  std::optional<SeenModel> clamped = {};  // the object between its pads, also while another gripper still holds it
  // By break beam: the object that breaks it. Only where the controller subscribes to GripperInfo::beams, or with
  // autosnatch.
  std::vector<std::optional<SeenModel>> beams = {};
};

// A part without a value keeps its last command.
struct GripperCommand {
  std::size_t gripper = 0;
  std::optional<FingerCommand> fingers = {};
  std::optional<double> lift = {};  // percent, 0 to 100
  // In place of `fingers`: the opening, percent, 0 (kClose) to 100 (kOpen). Fingers that touch an object on the way
  // hold it.
  std::optional<double> opening = {};
};

// One of the two; valid until the next command to the same joint. Only a GripperCommand moves fingers; for a lift the
// last command of either kind is valid.
struct JointCommand {
  std::size_t joint = 0;
  std::optional<double> position = {};  // m or rad, within the joint's limits: moves there and stays
  std::optional<double> velocity = {};  // m/s or rad/s, up to the joint's limit. Bounded by the joint's speed.
};

// A gripper of the robot. The description lives as long as the controller; its ids are of the world.
struct GripperInfo {
  const GripperDescription* description = nullptr;  // never null
  std::size_t left = 0;                             // in RobotInfo::joints
  std::size_t right = 0;
  std::optional<std::size_t> lift = {};
  std::optional<std::size_t> beams = {};  // its break beams, in RobotInfo::sensors
};

}  // namespace troupe
