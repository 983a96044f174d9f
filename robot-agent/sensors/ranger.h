// Rangers: laser scanners and sonar rings.
#pragma once

#include "common/model/world_description.h"
#include "common/spatial/ray_cast.h"
#include "robot-agent/controller/controller.h"

namespace troupe {

// The bearing of each ray of a sensor relative to the sensor's heading, rad.
std::vector<double> Bearings(const RaySensorDescription& sensor);

// What `ranger` of `robot` measures in the state that `bodies` holds at `tick`. Each range lies in the sensor's
// [range.min, range.max]; noise is a function of (seed, robot, ranger, sensor, tick, ray).
void MeasureRanger(const Scene& scene, const BodyIndex& bodies, RobotId robot, std::size_t ranger, Tick tick,
                   RangerReading& reading);

}  // namespace troupe
