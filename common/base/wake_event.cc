#include "common/base/wake_event.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

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

}  // namespace troupe
