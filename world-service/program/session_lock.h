// SessionLock: at most one world service for each session and domain on a machine. Ends with the process, however that
// ends. Services on other machines are found by the transport.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/result.h"

namespace troupe {

class SessionLock {
 public:
  // The error names the process that has it.
  static Result<SessionLock> Acquire(std::uint32_t domain, const std::string& session);

  SessionLock(SessionLock&& other) noexcept;
  SessionLock& operator=(SessionLock&&) = delete;
  ~SessionLock();

 private:
  explicit SessionLock(int socket) : socket_(socket) {}

  int socket_;
};

}  // namespace troupe
