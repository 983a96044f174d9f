// The text of an event on the topic /events.
#pragma once

#include <string>

#include "troupe/event.h"
#include "troupe/world_description.h"

namespace troupe {

// A JSON object: {"detail": "", "event": "stall_began", "other": "wall", "robot": "r0", "tick": 7}.
// REQUIRES: the event's ids are of this world.
std::string EventLine(const WorldDescription& world, const Event& event);

}  // namespace troupe
