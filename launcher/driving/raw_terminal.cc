#include "launcher/driving/raw_terminal.h"

#include <unistd.h>

#include <array>
#include <csignal>

namespace troupe {
namespace {

// For the signal handler, which has no object.
int restored_descriptor = -1;
termios restored{};

// That end a process at once, by default; the program stops by the others in an orderly way.
constexpr std::array<int, 6> kDeadly = {SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};

void RestoreAndDie(int signal) {
  tcsetattr(restored_descriptor, TCSANOW, &restored);
  std::signal(signal, SIG_DFL);
  raise(signal);
}

}  // namespace

Result<std::unique_ptr<RawTerminal>> RawTerminal::Open(int descriptor) {
  termios before{};
  if (tcgetattr(descriptor, &before) != 0) {
    return Error{{}, "the standard input is no terminal, expected one for the keys", ErrorCode::kBadInput};
  }
  return std::unique_ptr<RawTerminal>(new RawTerminal(descriptor, before));
}

RawTerminal::RawTerminal(int descriptor, const termios& before) : descriptor_(descriptor), before_(before) {
  restored_descriptor = descriptor;
  restored = before;
  for (const int signal : kDeadly) std::signal(signal, RestoreAndDie);
  termios raw = before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  raw.c_cc[VSUSP] = _POSIX_VDISABLE;  // a stopped tool cannot steer, and would leave the terminal raw
  tcsetattr(descriptor, TCSANOW, &raw);
}

RawTerminal::~RawTerminal() {
  tcsetattr(descriptor_, TCSANOW, &before_);
  for (const int signal : kDeadly) std::signal(signal, SIG_DFL);
}

}  // namespace troupe
