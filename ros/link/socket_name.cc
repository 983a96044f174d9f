#include "ros/link/socket_name.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "common/base/local_address.h"

namespace troupe::ros {
namespace {

Error BadName(const std::string& name) {
  return {{}, "found '" + name + "', expected the name of a socket"};
}

Error SocketFailure(const std::string& doing, const std::string& name) {
  return Failure("cannot " + doing + " '" + name + "': " + std::strerror(errno));
}

int MakeSocket() {
  return socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

bool IsOfThisUser(int connection) {
  ucred peer = {};
  socklen_t size = sizeof peer;
  return getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.uid == geteuid();
}

}  // namespace

Result<int> Bind(const std::string& name) {
  const std::optional<LocalAddress> address = MakeLocalAddress(name);
  if (!address) return BadName(name);
  const int descriptor = MakeSocket();
  if (descriptor >= 0 && bind(descriptor, address->get(), address->length) == 0) return descriptor;
  const Error failure = SocketFailure("bind socket", name);
  if (descriptor >= 0) close(descriptor);
  return failure;
}

Result<int> Connect(const std::string& name) {
  const std::optional<LocalAddress> address = MakeLocalAddress(name);
  if (!address) return BadName(name);
  const int descriptor = MakeSocket();
  if (descriptor >= 0 && connect(descriptor, address->get(), address->length) == 0) {
    if (IsOfThisUser(descriptor)) return descriptor;
    close(descriptor);
    return Failure("socket '" + name + "' belongs to another user");
  }
  const Error failure = SocketFailure("connect to socket", name);
  if (descriptor >= 0) close(descriptor);
  return failure;
}

int Accept(int listening) {
  const int connection = accept4(listening, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (connection >= 0 && !IsOfThisUser(connection)) {
    close(connection);
    return -1;
  }
  return connection;
}

}  // namespace troupe::ros
