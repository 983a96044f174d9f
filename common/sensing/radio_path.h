// The bodies between antennas: those that the straight line between two of them crosses, at its heights. Private to
// this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/sensing/sensor.h"
#include "common/spatial/column_cast.h"
#include "troupe/vec2.h"

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

// A part of the line between two antennas: m from the one that receives, along the line's foot.
struct LinePart {
  double enter;
  double leave;
};

// The part of the line that is in an obstacle.
struct ObstacleOnLine {
  LinePart part;
  std::optional<BodyId> body;  // nothing: static
};

// A message on its way from an antenna, as strong as without obstacles.
struct RadioSignal {
  Antenna from;
  const RadioParameters* sender = nullptr;  // never null
  double clear = 0.0;                       // dBm
  double weakest = 0.0;                     // dBm, of messages that are received

  double LossBy(const RadioObstacles& obstacles) const {
    return sender->wall_loss * static_cast<double>(obstacles.walls) +
           sender->body_loss * static_cast<double>(obstacles.bodies);
  }
  bool Passes(const RadioObstacles& obstacles) const {
    const double loss = LossBy(obstacles);
    return loss == 0.0 || clear - loss >= weakest;
  }
};

// The lines from one antenna to the senders of signals on other robots. A line ends where it enters the other robot;
// bodies of its own robot, objects that either robot holds, and bodies that rangers do not see do not count; on a
// vertical line none does.
class RadioPaths {
 public:
  // REQUIRES: the world stays as it is; `signals` outlive the paths.
  RadioPaths(const SensedWorld& world, const Antenna& to, std::span<const RadioSignal> signals);

  // The strength of signal i behind all its obstacles, dBm; nothing if it is too weak.
  std::optional<double> StrengthOf(std::size_t i);

 private:
  RadioObstacles CountObstacles(const Antenna& from);

  const SensedWorld& world_;
  Antenna to_;
  std::span<const RadioSignal> signals_;
  std::vector<RadioObstacles> first_;  // by signal: obstacles that it has at the least; all, if it has none
  std::vector<bool> is_clear_;         // likewise: it surely has no obstacle
  std::optional<ColumnCaster> caster_;
  // Of one line; kept for their room.
  std::vector<ColumnCut> cuts_;
  std::vector<ObstacleOnLine> obstacles_;
  std::vector<LinePart> walls_;
  std::vector<BodyId> bodies_;
};

}  // namespace troupe
