// The moves of a tick: people move one after another, as they have decided. Private to this folder.
#pragma once

#include <memory_resource>
#include <vector>

#include "world-service/core/people_view.h"

namespace troupe {

class PeopleMover {
 public:
  PeopleMover(StepWorkspace& workspace, const PeopleView& view) : workspace_(workspace), view_(view) {}

  // Moves a person to its plan: with its velocity, as far as there is room.
  void Move(PersonId id, const PersonState& plan);

 private:
  enum class Room : std::uint8_t { kFree, kTaken, kTight };

  // Whether the person's cylinder is free from `from` to `to`. Tight: others are inside it already, at `from`.
  Room RoomOn(PersonId id, const Vec2& from, const Vec2& to);
  // True at rest.
  bool IsFree(PersonId id, const Pose& X_WP, const Vec2& velocity) const;

  StepWorkspace& workspace_;
  const PeopleView& view_;
  NearPieces static_pieces_;  // memory of RoomOn
  std::pmr::vector<BodyId> bodies_;
};

}  // namespace troupe
