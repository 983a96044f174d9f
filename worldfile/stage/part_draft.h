// PartDraft: a door, a lift or a body as a reader of another format knows it, typed, in m and rad. A node of a tree
// (world_tree.h) has it in place of properties. A property of the node, which a scenario may set, counts before the
// draft, and has the units of the file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "troupe/enum_names.h"
#include "troupe/pose.h"
#include "troupe/world_description.h"

namespace troupe {

enum class DoorKind : std::uint8_t { kHinged, kDoubleHinged, kSliding, kDoubleSliding };
// As building files and world files name them.
constexpr auto NamesOf(DoorKind) {
  return std::array{"hinged", "double_hinged", "sliding", "double_sliding"};
}

enum class DoorSide : std::uint8_t { kRight, kLeft };
constexpr auto NamesOf(DoorSide) {
  return std::array{"right", "left"};
}

// The doorway is from the left to the right, x along it, y to the back.
struct DoorDraft {
  DoorKind kind = DoorKind::kHinged;
  bool at_left = false;               // the hinge of a single leaf, or to which it slides
  double swing = 1.5707963267948966;  // rad, by which hinged leaves turn, towards y
  double ratio = 1.0;                 // widths of the right and the left leaf
  double opening = 0.0;               // at the start: from 0, closed, to 1
  bool is_operated = true;            // requests have an effect
  double speed = 0.0;                 // m/s or rad/s, of its widest leaf; 0: the default of doors
};

struct LiftDraft {
  struct Floor {
    std::string name;
    double z = 0.0;                  // m, of the cabin's floor, in W
    std::vector<std::string> doors;  // models that open there
  };
  std::vector<Floor> floors;
  std::vector<std::string> cabin_doors;  // models that move with the cabin
  double speed = 0.0;                    // m/s; 0: the default of lifts
};

// A body, as a reader of SDF or URDF knows it.
struct BodyDraft {
  // A frame of the file on a model of a robot, tilted by roll about x, then by pitch about y.
  struct Frame {
    std::string name;
    std::string part;  // the name below the robot's; empty: the robot
    Pose X_MF = {};
    double roll = 0.0;
    double pitch = 0.0;
  };
  std::vector<Block> blocks;  // in the model's frame, normalized
  std::vector<Frame> frames;  // of a robot
};

using PartDraft = std::variant<DoorDraft, LiftDraft, BodyDraft>;

}  // namespace troupe
