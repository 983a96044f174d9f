// Process identity: the version of its program and protocol, its machine, unique ids, and names of sockets.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cstdint>
#include <optional>
#include <string>

#include "troupe/version.h"

namespace troupe {

// The version of the programs, and of the protocol between them.
// Programs work together only when this is equal: it changes whenever a message or its meaning does.
inline constexpr std::uint32_t kProtocolVersion = 24;

// The system's host name; "localhost" if it has none.
std::string HostName();

// Unique ids of processes and clients. Not for the simulation: they differ from run to run.
// 64 bits from the machine's source of randomness.
std::uint64_t MakeRandomId();

// LocalAddress: the name of a Unix socket that leaves no file behind; it ends with its socket (an abstract name).
struct LocalAddress {
  sockaddr_un address = {};
  socklen_t length = 0;

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

// Nothing for a name that is empty or longer than 107 characters.
std::optional<LocalAddress> MakeLocalAddress(const std::string& name);

}  // namespace troupe
