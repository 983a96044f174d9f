// LocalAddress: the name of a Unix socket that leaves no file behind; it ends with its socket (an abstract name).
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <optional>
#include <string>

namespace troupe {

struct LocalAddress {
  sockaddr_un address = {};
  socklen_t length = 0;

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

// Nothing for a name that is empty or longer than 107 characters.
std::optional<LocalAddress> MakeLocalAddress(const std::string& name);

}  // namespace troupe
