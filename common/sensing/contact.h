// Sensors of touch: contact sensors, bumpers, and the bodies that touch an outline.
//
// Bodies never overlap: a step ends each motion before a contact (world-service/core). So "touches" means a distance
// within kContactReach, which every motion that was stopped ends with. A robot's own parts and the objects that it
// holds never count.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/sensing/sensor.h"
#include "common/spatial/convex_piece.h"
#include "troupe/z_range.h"

namespace troupe {

// The contact sensor: all parts of a robot that touch another body sideways, within a millimetre.
// REQUIRES: the description has ContactParameters.
std::unique_ptr<const Sensor> MakeContactSensor(const SensorMount& mount);

// The bumper: strips on a robot, each pressed while a body that collides touches it (within a millimetre) at its
// heights. A robot stops at its first contact, so a bumper on its outline is pressed exactly by its contacts there. The
// last two millimetres of a strip at either end feel nothing: neighbours share a corner.
// REQUIRES: the description has BumperParameters.
std::unique_ptr<const Sensor> MakeBumper(const SensorMount& mount);

// The bodies that touch an outline, for bumpers and contact sensors.

// A body at most so far away is in contact: a motion ends within a millimetre of the first contact.
inline constexpr double kContactReach = 1e-3;  // m

struct Touch {
  ModelId other;
  NearestPoints points;  // a: of the outline
  ZRange z;              // m, in W: where both are
};

// The pieces of other bodies than the robot and the objects that it holds, which collide (obstacle_return), are within
// kContactReach of the convex outline (frame W) and share a length of the heights `z` with it, or its one height if `z`
// is empty.
std::vector<Touch> FindTouches(const SensedWorld& world, RobotId robot, std::span<const Vec2> outline, const ZRange& z);

}  // namespace troupe
