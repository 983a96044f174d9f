#include "launcher/process/signal_watch.h"

#include <sys/signalfd.h>
#include <unistd.h>

#include <initializer_list>

#include "troupe/check.h"

namespace troupe {

SignalWatch::SignalWatch() {
  sigset_t watched;
  sigemptyset(&watched);
  for (int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&watched, signal);
  pthread_sigmask(SIG_BLOCK, &watched, &before_);
  descriptor_ = signalfd(-1, &watched, SFD_NONBLOCK | SFD_CLOEXEC);
  TROUPE_CHECK(descriptor_ >= 0);
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
