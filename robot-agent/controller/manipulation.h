// What a controller sees of its robot's joints and grippers, and what it asks of them. Part of controller.h.
//
// Joints are counted by RobotInfo::joints, grippers by RobotInfo::grippers.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/ids.h"
#include "common/model/world_description.h"

namespace troupe {

// A model of the world, as a sensor tells it. The name lives as long as the controller.
struct SeenModel {
  ModelId id;
  std::string_view name = {};
  bool operator==(const SeenModel&) const = default;
};

struct JointReading {
  double position = 0.0;  // m or rad
  double velocity = 0.0;  // m/s or rad/s, executed during the last tick
  bool blocked = false;   // the last tick's motion was cut short by a contact
  bool moving = false;    // on its way to what was asked for; false when it is there, or blocked
};

enum class FingerState : std::uint8_t {
  kOpen,  // all the way
  kClosing,
  kClosed,  // they can close no more: on an object, on something else, or on each other; or they were left half open
  kOpening,
};

enum class FingerCommand : std::uint8_t {
  kOpen,
  kClose,
  kStay,  // where they are, with what they hold
};

struct GripperReading {
  FingerState fingers = FingerState::kOpen;
  bool lift_moving = false;                    // on its way to the height asked for; false when it is there, or blocked
  double lift_position = 0.0;                  // m
  double lift_percent = 0.0;                   // of the way from its minimum to its maximum
  std::optional<SeenModel> left_contact = {};  // what the pad was stopped by when it last closed
  std::optional<SeenModel> right_contact = {};
  std::optional<SeenModel> held = {};     // the object that it holds
  std::optional<SeenModel> clamped = {};  // the object between its pads, also when another gripper still holds that
  // By beam: the object that breaks it. Only where subscribed, or with autosnatch.
  std::vector<std::optional<SeenModel>> beams = {};
};

// What is left out stays as it was last commanded.
struct GripperCommand {
  std::size_t gripper = 0;
  std::optional<FingerCommand> fingers = {};
  std::optional<double> lift = {};  // percent, 0 to 100
  // In place of `fingers`: how far they are to be open, percent, 0 (kClose) to 100 (kOpen). Fingers that meet an object
  // on the way hold it.
  std::optional<double> opening = {};
};

// One of the two; it holds until the next command to the same joint. Fingers are moved by GripperCommand only; a lift
// by either, whichever came last.
struct JointCommand {
  std::size_t joint = 0;
  std::optional<double> position = {};  // m or rad, within the joint's limits: goes there and stays
  std::optional<double> velocity = {};  // m/s or rad/s: goes on until the limit. Bounded by the joint's speed.
};

// A gripper of the robot. The description lives as long as the controller; its ids are of the world.
struct GripperInfo {
  const GripperDescription* description = nullptr;  // never null
  std::size_t left = 0;                             // in RobotInfo::joints
  std::size_t right = 0;
  std::optional<std::size_t> lift = {};
};

}  // namespace troupe
