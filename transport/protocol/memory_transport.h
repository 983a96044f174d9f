// MemoryTransport: messages between endpoints of one process. One thread of its own delivers all messages, in the order
// in which it was sent, so that a whole run needs no hand-over between threads.
#pragma once

#include <memory>

#include "transport/protocol/transport.h"

namespace troupe {

// Makes the transport and starts its thread, which ends with it. A session message is kept for agents that start later.
std::unique_ptr<Transport> MakeMemoryTransport();

}  // namespace troupe
