#include "common/base/stop_signals.h"

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>
#include <utility>

namespace troupe {

StopSignals::StopSignals(std::function<void()> on_request) : on_request_(std::move(on_request)) {
  sigset_t watched;
  sigemptyset(&watched);
  for (int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&watched, signal);
  signals_ = signalfd(-1, &watched, SFD_NONBLOCK | SFD_CLOEXEC);
  if (signals_ < 0) throw std::system_error(errno, std::generic_category(), "watching signals");
  pthread_sigmask(SIG_BLOCK, &watched, &before_);
  watch_ = std::thread([this] { Watch(); });
}

StopSignals::~StopSignals() {
  end_.Signal();
  watch_.join();
  close(signals_);
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void StopSignals::Watch() {
  pollfd waited[] = {{signals_, POLLIN, 0}, {end_.descriptor(), POLLIN, 0}};
  while (waited[1].revents == 0) {
    poll(waited, 2, -1);
    signalfd_siginfo info;
    while (read(signals_, &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
      requested_ = true;
      if (on_request_) on_request_();
    }
  }
}

}  // namespace troupe
