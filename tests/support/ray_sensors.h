// The ray sensors of a sensor that is a ranger.
#pragma once

#include <vector>

#include "troupe/world_description.h"

namespace troupe {

inline std::vector<RaySensorDescription>& RaySensors(SensorDescription& ranger) {
  return std::get<RangerParameters>(ranger.parameters).ray_sensors;
}
inline const std::vector<RaySensorDescription>& RaySensors(const SensorDescription& ranger) {
  return std::get<RangerParameters>(ranger.parameters).ray_sensors;
}

}  // namespace troupe
