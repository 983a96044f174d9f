// The bodies between antennas: those that the straight line between two of them crosses, at its heights. Private to
// this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

// An antenna of a robot, in W.
struct Antenna {
  RobotId robot;
  Vec2 at{0.0, 0.0};  // m
  double z = 0.0;     // m
};

// The lines from one antenna to several of other robots. A line ends where it enters the other robot; bodies of its own
// robot, objects that either robot holds, and bodies that rangers do not see do not count; on a vertical line none
// does.
class RadioPaths {
 public:
  // REQUIRES: the world stays as it is; `ends` outlive the paths.
  RadioPaths(const SensedWorld& world, const Antenna& from, std::span<const Antenna> ends);

  // Obstacles that line i has at the least: all, if it has none. Quick.
  RadioObstacles AtLeast(std::size_t i) const { return first_[i]; }
  RadioObstacles All(std::size_t i);

 private:
  const SensedWorld& world_;
  Antenna from_;
  std::span<const Antenna> ends_;
  std::vector<RadioObstacles> first_;  // by end
  std::vector<bool> is_clear_;         // likewise: it surely has no obstacle
  std::optional<ColumnCaster> caster_;
  std::vector<ColumnCut> cuts_;
};

}  // namespace troupe
