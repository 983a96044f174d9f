// WaitingText: the robots that a run waits for, for reports on a terminal.
#pragma once

#include <string>

#include "transport/protocol/messages.h"

namespace troupe {

// "r3, r4 (1.2 s)": up to four names, the number of the others, and the time of waiting. Empty: the run waits for none.
std::string WaitingText(const StatusMessage& status);

}  // namespace troupe
