#include "common/base/wake_event.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>
#include <utility>

namespace troupe {
namespace {

int MakeEvent() {
  const int event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (event < 0) throw std::system_error(errno, std::generic_category(), "making an eventfd");
  return event;
}

}  // namespace

WakeEvent::WakeEvent() : descriptor_(MakeEvent()) {}

WakeEvent::~WakeEvent() {
  close(descriptor_);
}

void WakeEvent::Signal() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(descriptor_, &one, sizeof one);
}

void WakeEvent::Clear() const {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t size = read(descriptor_, &count, sizeof count);
}

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
