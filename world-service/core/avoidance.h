// Avoidance: the second half of a person's decision, after WalkAlone (preferred_velocity.h) has found the velocity that
// it would have alone. Private to this folder.
//
// First its reaction to robots changes that velocity (ReactToRobots). Then it chooses a direction and a speed among the
// others (common/crowd/steering.h), and ORCA (common/crowd/orca.h) finds the nearest velocity that leads to no
// collision within a horizon of time: with other people and robots, which are discs, and with walls and objects, whose
// sides are segments. Two people share the avoidance: by halves where they meet from opposite sides; else the one
// behind does more, up to all of it, and makes room for one before it that presses on. These rules settle who goes
// first where ORCA alone would have both stand. A robot does not avoid, and a person does all of it.
//
// Everything is read from a PeopleView, which no thread changes while people decide. So each thread has an Avoidance of
// its own, and the velocity of a person does not depend on the thread that finds it. Nearest things are ordered by
// distance and then by number: the result does not depend on the order in which a grid lists them.
//
// A person looks at its 12 nearest people and robots only, so that the time for a decision is bounded in a dense crowd.
// Distances in m, in frame W, in the plane; things at other heights than the person's are left out.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "common/crowd/orca.h"
#include "common/crowd/steering.h"
#include "common/spatial/static_index.h"
#include "world-service/core/people_view.h"

namespace troupe {

// Changes `velocity`, that of a person alone, by its reaction to robots, and counts the ticks for which it watches one
// in `person`. Returns the point that it looks at, if there is one.
// Curious people walk up to the nearest robot and stand before it until they have watched it for 10 s; scared people
// are pushed away from it, the more the nearer it is. Regular and careless people do not react here: the difference
// between them is in Avoidance. The count of ticks begins again at 0 when no robot is within 6 m any more, so that the
// next robot is watched, too.
std::optional<Vec2> ReactToRobots(const PeopleView& view, PersonId id, PersonState& person, Vec2& velocity);

// Finds the velocities of people, with the memory of one thread.
class Avoidance {
 public:
  // REQUIRES: `view` outlives this.
  explicit Avoidance(const PeopleView& view);

  // The velocity next to the preferred one that meets no other. `steers`: first the preferred velocity becomes that of
  // a walker among others (common/crowd/steering.h), and it knows who goes first.
  Vec2 Velocity(PersonId id, const Vec2& preferred, bool steers);

 private:
  void FindOthers(PersonId id, bool steers);
  void FindWalls(PersonId id);
  // The sides of a piece that the person sees.
  void AddWalls(const ConvexPiece& piece, const Disc& me);

  const PeopleView& view_;
  Orca orca_;
  Orca bound_orca_;  // without steering
  Steering steering_;
  // Lists of the last call of Velocity, kept for their memory: a tick calls it for each person.
  std::vector<NearDisc> others_;   // people and robots
  std::vector<NearDisc> objects_;  // whose sides are walls
  std::vector<WalkerNeighbor> neighbors_;
  std::vector<WallSegment> walls_;
  std::vector<std::pair<double, std::size_t>> order_;  // of the walls, by the square of the distance
  std::vector<WallSegment> nearest_;
  NearPieces pieces_;
};

}  // namespace troupe
