#include "world-service/program/session_lock.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>

namespace troupe {
namespace {

// The process that listens at the address; 0: unknown.
pid_t Listener(const sockaddr_un& address, socklen_t length) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return 0;
  ucred peer = {};
  socklen_t size = sizeof peer;
  const bool found = connect(probe, reinterpret_cast<const sockaddr*>(&address), length) == 0 &&
                     getsockopt(probe, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
  close(probe);
  return found ? peer.pid : 0;
}

}  // namespace

Result<SessionLock> SessionLock::Acquire(std::uint32_t domain, const std::string& session) {
  // An abstract name ends with its socket, and leaves no file behind.
  const std::string name = "troupe-world-service/" + std::to_string(domain) + "/" + session;
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  if (name.size() + 1 > sizeof address.sun_path) return Error{{}, "the session name \"" + session + "\" is too long"};
  std::copy(name.begin(), name.end(), address.sun_path + 1);
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());

  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return Failure(std::string("cannot make a socket: ") + std::strerror(errno));
  SessionLock lock(descriptor);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), length) == 0 && listen(descriptor, 16) == 0) {
    return lock;
  }
  if (errno != EADDRINUSE) {
    return Failure("cannot lock session \"" + session + "\": " + std::strerror(errno));
  }
  const pid_t holder = Listener(address, length);
  return Failure("a world service runs in session \"" + session + "\" of domain " + std::to_string(domain) +
                 " already (" + (holder > 0 ? "pid " + std::to_string(holder) : "pid unknown") +
                 "); end it, or use another --session");
}

SessionLock::SessionLock(SessionLock&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

SessionLock::~SessionLock() {
  if (socket_ >= 0) close(socket_);
}

}  // namespace troupe
