// The words for the states of a run, in the output of tools and the messages of the viewer.
#pragma once

#include "transport/protocol/messages.h"

namespace troupe {

// "starting", "playing", "paused", "over".
const char* ToString(RunState state);

}  // namespace troupe
