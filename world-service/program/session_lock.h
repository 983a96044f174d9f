// SessionLock: at most one world service for each session and domain on a host. The lock ends with the process,
// by whatever cause. The transport detects services on other hosts.
#pragma once

#include <cstdint>
#include <string>

#include "troupe/result.h"

namespace troupe {

class SessionLock {
 public:
  // The error names the process that owns the lock.
  static Result<SessionLock> Acquire(std::uint32_t domain, const std::string& session);

  SessionLock(SessionLock&& other) noexcept;
  SessionLock& operator=(SessionLock&&) = delete;
  ~SessionLock();

 private:
  explicit SessionLock(int socket) : socket_(socket) {}

  int socket_;
};

}  // namespace troupe
