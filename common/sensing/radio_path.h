// The bodies between two antennas: those that the straight line between them crosses, at its heights. Private to this
// folder.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/vec2.h"
#include "common/sensing/sensor.h"
#include "common/spatial/column_cast.h"

namespace troupe {

struct RadioObstacles {
  // Stretches of the line inside of static bodies. Those with less than kWallGap between them are one wall, so that
  // the pixels of a slanted wall count once.
  std::size_t walls = 0;
  std::size_t bodies = 0;  // robots and objects
};
inline constexpr double kWallGap = 0.05;  // m

// A point in W.
struct AntennaPlace {
  Vec2 at{0.0, 0.0};  // m
  double z = 0.0;     // m
};

// The lines from one antenna.
class RadioPaths {
 public:
  // `robot`: that has the antenna. `reach`: m, of the longest line. REQUIRES: the world stays as it is.
  RadioPaths(const SensedWorld& world, RobotId robot, const AntennaPlace& from, double reach);

  // To an antenna of another robot. Bodies of the two robots, objects that they hold, and bodies that rangers do not
  // see do not count; on a vertical line none does.
  RadioObstacles To(RobotId robot, const AntennaPlace& to);

 private:
  const SensedWorld& world_;
  AntennaPlace from_;
  ColumnCaster caster_;
  std::vector<ColumnCut> cuts_;
};

}  // namespace troupe
