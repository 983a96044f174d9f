#include "launcher/process/signal_watch.h"

#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <initializer_list>
#include <system_error>

namespace troupe {

SignalWatch::SignalWatch() {
  sigset_t watched;
  sigemptyset(&watched);
  for (int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&watched, signal);
  descriptor_ = signalfd(-1, &watched, SFD_NONBLOCK | SFD_CLOEXEC);
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "watching signals");
  // A parent may have left it ignored: then the ends of children would be neither told nor kept.
  signal(SIGCHLD, SIG_DFL);
  pthread_sigmask(SIG_BLOCK, &watched, &before_);
}

SignalWatch::~SignalWatch() {
  close(descriptor_);
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool SignalWatch::ReadStopRequest() {
  bool stop = false;
  signalfd_siginfo info;
  while (read(descriptor_, &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
    const bool is_child = info.ssi_signo == static_cast<unsigned>(SIGCHLD);
    child_ended_ = child_ended_ || is_child;
    stop = stop || !is_child;
  }
  stop_requested_ = stop_requested_ || stop;
  return stop;
}

}  // namespace troupe
