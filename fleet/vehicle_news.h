// What has happened to a vehicle between two of its memories, as sentences for people: the events of its order on a
// timeline. "order o1 accepted", "order o1 finished", "order o1 cancelled", "action p1 FAILED: no load is within
// reach", "error pathBlocked: box is in the way", "error pathBlocked cleared", "mode MANUAL".
#pragma once

#include <string>
#include <vector>

#include "fleet/vehicle.h"

namespace troupe::fleet {

// Updates, nodes that are passed and requests for messages are left out: they are many. Rejections are not in a memory
// alone (VehicleOutcome::row).
std::vector<std::string> NewsOf(const VehicleMemory& before, const VehicleMemory& now);

}  // namespace troupe::fleet
