// Calls in a process without memory: destructors and other functions that cannot fail must work there.
#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>

namespace troupe::test {

// Makes the stack as large as later calls need it: without memory it cannot grow.
[[gnu::noinline]] inline void GrowStack() {
  volatile char stack[256 * 1024];
  for (std::size_t i = 0; i < sizeof stack; i += 1024) stack[i] = 0;
}

// An optimiser may leave out an allocation whose result is not stored.
inline bool IsAllocated(std::size_t size) {
  void* volatile piece = std::malloc(size);
  return piece != nullptr;
}

// No allocation of this process succeeds any more, of whatever size.
inline void UseUpMemory() {
  GrowStack();
  const rlimit none = {0, 0};
  setrlimit(RLIMIT_AS, &none);
  constexpr std::size_t kMaxOfOneSize = 2048;  // bytes; the allocator keeps free pieces by size
  for (std::size_t size = std::size_t{1} << 24; size > kMaxOfOneSize; size /= 2) {
    while (IsAllocated(size)) continue;
  }
  for (std::size_t size = kMaxOfOneSize; size >= 8; size -= 8) {
    while (IsAllocated(size)) continue;
  }
}

// Makes the call in a copy of this process without memory. Its exit status, 0 if the call returns; negative: the signal
// that ended it. With a sanitizer, whose allocator ends the process instead of failing, and in an emulator, which
// ignores limits (scripts/emulate-arm64), the copy has memory.
template <typename Call>
int StatusWithoutMemory(const Call& call) {
  const pid_t copy = fork();
  if (copy == 0) {
#ifndef TROUPE_SANITIZED
    if (std::getenv("QEMU_LD_PREFIX") == nullptr) UseUpMemory();
#endif
    call();
    _exit(0);
  }
  int status = 0;
  waitpid(copy, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace troupe::test
