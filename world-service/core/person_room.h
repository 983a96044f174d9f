// PersonRoom: whether a person has room at a place, or on a straight way, among walls and the bodies at their present
// poses. Private to this folder.
//
// People are cylinders here, for themselves and for each other; robots and objects are their pieces. One thread, after
// all people have decided or before: it reads the state that is being made.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "world-service/core/step_workspace.h"

namespace troupe {

class PersonRoom {
 public:
  // Tight: others are inside the cylinder already, at the start.
  enum class Found : std::uint8_t { kFree, kTaken, kTight };

  explicit PersonRoom(const StepWorkspace& workspace) : workspace_(workspace) {}

  // For a person at the height of its present pose, from `from` to `to` (m, W), which may be one point.
  Found On(PersonId id, const Vec2& from, const Vec2& to);

 private:
  ZRange HeightsOf(PersonId id) const;

  const StepWorkspace& workspace_;
  NearPieces static_pieces_;  // memory of On
  std::pmr::vector<BodyId> bodies_;
};

}  // namespace troupe
