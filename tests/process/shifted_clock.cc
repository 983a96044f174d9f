// A library that a program is started with (LD_PRELOAD): the clock of its host is CLOCK_SHIFT seconds fast, or slow.
// The clock for durations stays right.
#include <stdlib.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

namespace {

time_t Shift() {
  const char* const shift = getenv("CLOCK_SHIFT");
  return shift == nullptr ? 0 : strtol(shift, nullptr, 10);
}

timespec ShiftedTime() {
  timespec time{};
  syscall(SYS_clock_gettime, CLOCK_REALTIME, &time);
  time.tv_sec += Shift();
  return time;
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE) {
    return static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  }
  *time = ShiftedTime();
  return 0;
}

int gettimeofday(timeval* time, void*) noexcept {
  const timespec now = ShiftedTime();
  *time = {now.tv_sec, static_cast<suseconds_t>(now.tv_nsec / 1000)};
  return 0;
}

time_t time(time_t* time) noexcept {
  const time_t now = ShiftedTime().tv_sec;
  if (time != nullptr) *time = now;
  return now;
}

}  // extern "C"
