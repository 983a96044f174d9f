// Events as text for people.
#pragma once

#include <string>

#include "troupe/event.h"
#include "troupe/world_description.h"

namespace troupe {

// One line, for instance "tick 12: r0 stalled at table.leg". REQUIRES: the event's ids are of this world.
std::string EventText(const WorldDescription& world, const Event& event);

}  // namespace troupe
