// Events as text for people, and in JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "troupe/event.h"
#include "troupe/world_description.h"

namespace troupe {

// One line, for instance "tick 12: r0 stalled at table.leg". REQUIRES: the event's ids are of this world.
std::string EventText(const WorldDescription& world, const Event& event);

// {"event": "stall_began", "robot": "r0", "other": "wall"}: the type of the event and the names of its participants, as
// far as it has them. Without its tick and detail. REQUIRES: the event's ids are of this world.
nlohmann::json EventJson(const WorldDescription& world, const Event& event);

// A JSON object as text: {"detail": "", "event": "stall_began", "other": "wall", "robot": "r0", "tick": 7}.
// REQUIRES: the event's ids are of this world.
std::string EventLine(const WorldDescription& world, const Event& event);

}  // namespace troupe
