// MappedRoute: a map that a robot makes with its ranger, and the way on it: to a point, or to what it has not seen yet.
#pragma once

#include <optional>
#include <vector>

#include "robot-agent/navigation/evidence_grid.h"
#include "robot-agent/navigation/rays.h"
#include "troupe/controller.h"

namespace troupe {

class MappedRoute {
 public:
  struct Settings {
    double side = 40.0;      // m, of the square that is mapped, around the robot's place at its first tick
    double cell = 0.2;       // m
    double clearance = 0.4;  // m, from the robot's origin to an obstacle that it passes
  };

  // REQUIRES: sensor `ranger` is a ranger; the bounds of EvidenceGrid.
  MappedRoute(const RobotInfo& info, std::size_t ranger, const Settings& settings);

  // Adds the reading of the ranger, if it is a new one. Call it each tick.
  void Observe(const Observation& observation);

  // The point (m, E) to drive to next on the way to within `reach` m of `goal`; nothing if no way is known.
  std::optional<Vec2> NextPoint(const Observation& observation, const Vec2& goal, double reach);
  // The same on the way to the nearest place beside unknown ones; nothing if all that can be reached is known.
  std::optional<Vec2> NextUnknown(const Observation& observation);

  // m^2, free and occupied. 0 before the first reading.
  double KnownArea() const;

 private:
  // The next point of the way that is not near yet, or its last one; drops those before.
  std::optional<Vec2> FollowPath(const Observation& observation);
  bool IsPlanDue(const Observation& observation) const;

  Settings settings_;
  std::size_t ranger_;
  std::vector<PlacedRay> rays_;
  std::optional<EvidenceGrid> grid_;  // from the first reading on
  std::vector<Vec2> path_;            // m, E
  std::optional<Vec2> goal_;          // of the path; nothing: the unknown
  double planned_at_ = -1.0;          // s, simulated; below 0: never
};

}  // namespace troupe
