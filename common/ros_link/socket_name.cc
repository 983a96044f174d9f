#include "common/ros_link/socket_name.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace troupe::ros {
namespace {

struct Address {
  sockaddr_un address = {};
  socklen_t length = 0;

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

Result<Address> AddressOf(const std::string& name) {
  Address result;
  result.address.sun_family = AF_UNIX;
  if (name.empty() || name.size() + 1 > sizeof result.address.sun_path) {
    return Error{{}, "found '" + name + "', expected the name of a socket"};
  }
  // An abstract name ends with its socket.
  std::copy(name.begin(), name.end(), result.address.sun_path + 1);
  result.length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return result;
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

Result<int> Listen(const std::string& name) {
  const Result<Address> address = AddressOf(name);
  if (!address.ok()) return address.error();
  const int descriptor = MakeSocket();
  if (descriptor >= 0 && bind(descriptor, address.value().get(), address.value().length) == 0 &&
      listen(descriptor, SOMAXCONN) == 0) {
    return descriptor;
  }
  const Error failure = SocketFailure("listen at socket", name);
  if (descriptor >= 0) close(descriptor);
  return failure;
}

Result<int> Connect(const std::string& name) {
  const Result<Address> address = AddressOf(name);
  if (!address.ok()) return address.error();
  const int descriptor = MakeSocket();
  if (descriptor >= 0 && connect(descriptor, address.value().get(), address.value().length) == 0) {
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
