#include "world-service/program/session_lock.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "common/base/local_address.h"

namespace troupe {
namespace {

// The process that listens at the address; 0: unknown.
pid_t Listener(const LocalAddress& address) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return 0;
  ucred peer = {};
  socklen_t size = sizeof peer;
  const bool found = connect(probe, address.get(), address.length) == 0 &&
                     getsockopt(probe, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
  close(probe);
  return found ? peer.pid : 0;
}

}  // namespace

Result<SessionLock> SessionLock::Acquire(std::uint32_t domain, const std::string& session) {
  const std::optional<LocalAddress> address =
      MakeLocalAddress("troupe-world-service/" + std::to_string(domain) + "/" + session);
  if (!address) return Error{{}, "the session name \"" + session + "\" is too long"};

  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return Failure(std::string("cannot make a socket: ") + std::strerror(errno));
  SessionLock lock(descriptor);
  if (bind(descriptor, address->get(), address->length) == 0 && listen(descriptor, 16) == 0) {
    return lock;
  }
  if (errno != EADDRINUSE) {
    return Failure("cannot lock session \"" + session + "\": " + std::strerror(errno));
  }
  const pid_t holder = Listener(*address);
  return Failure("a world service runs in session \"" + session + "\" of domain " + std::to_string(domain) +
                 " already (" + (holder > 0 ? "pid " + std::to_string(holder) : "pid unknown") +
                 "); end it, or use another --session");
}

SessionLock::SessionLock(SessionLock&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

SessionLock::~SessionLock() {
  if (socket_ >= 0) close(socket_);
}

}  // namespace troupe
