// The velocities of people among others: their reactions to robots, and the avoidance of all (ORCA). Private to this
// folder.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "common/crowd/orca.h"
#include "common/spatial/static_index.h"
#include "world-service/core/people_view.h"

namespace troupe {

// Changes `velocity`, that of a person alone, by its reaction to robots, and counts the ticks for which it watches one
// in `person`. Returns the point that it looks at, if there is one.
std::optional<Vec2> ReactToRobots(const PeopleView& view, PersonId id, PersonState& person, Vec2& velocity);

// Finds the velocities of people, with the memory of one thread.
class Avoidance {
 public:
  explicit Avoidance(const PeopleView& view);

  // The velocity next to the preferred one that meets no other.
  Vec2 Velocity(PersonId id, const Vec2& preferred);

 private:
  void FindOthers(PersonId id);
  void FindWalls(PersonId id);
  // The sides of a piece that the person sees.
  void AddWalls(const ConvexPiece& piece, const Disc& me);

  const PeopleView& view_;
  Orca orca_;
  std::vector<NearDisc> others_;   // people and robots
  std::vector<NearDisc> objects_;  // whose sides are walls
  std::vector<WalkerNeighbor> neighbors_;
  std::vector<WallSegment> walls_;
  std::vector<std::pair<double, std::size_t>> order_;  // of the walls, by the square of the distance
  std::vector<WallSegment> nearest_;
  NearPieces pieces_;
};

}  // namespace troupe
