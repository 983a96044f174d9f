// Lanes of a building on which robots may be stuck at open doors: a check of the plan before the run.
//
// Plans are drawn for real doors, whose leaves are beside the wall when they are open; simulated leaves turn by the
// angle of the plan and may end up on the lane. The fault shows only as a robot that waits for ever, hence the warning.
// Geometry in m, frame W; cost: lanes times leaves.
#pragma once

#include <string>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

// One message for each lane and each leaf of a door that stands closer to the lane while it is open, for good if the
// door is not operated, than half the width of the narrowest robot: "lane from 'a' to 'b' is 0.12 m from the open
// leaf 'door.left' ...". Without robots for leaves across lanes only. After the twentieth only their number.
std::vector<std::string> FindNarrowLanes(const WorldDescription& world);

}  // namespace troupe
