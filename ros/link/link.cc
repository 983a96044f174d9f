#include "ros/link/link.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

#include "troupe/check.h"

namespace troupe::ros {
namespace {

constexpr std::size_t kReadAtATime = std::size_t{64} << 10;
constexpr int kMostChunks = 16;  // of one call: a fast sender holds up no other
constexpr std::size_t kDroppedAtATime = std::size_t{256} << 10;

}  // namespace

Link::Link(int descriptor) : descriptor_(descriptor), chunk_(kReadAtATime) {}

Link::~Link() {
  close(descriptor_);
}

void Link::Add(LinkKind kind, std::uint32_t id, std::span<const std::byte> content) {
  TROUPE_CHECK(content.size() <= kLargestContent);
  const Header header = {static_cast<std::uint32_t>(content.size()), static_cast<std::uint32_t>(kind), id};
  const auto begin = std::as_bytes(std::span(&header, 1));
  const std::lock_guard lock(mutex_);
  output_.insert(output_.end(), begin.begin(), begin.end());
  output_.insert(output_.end(), content.begin(), content.end());
}

bool Link::Flush() {
  const std::lock_guard lock(mutex_);
  while (sent_ < output_.size()) {
    const ssize_t sent = send(descriptor_, output_.data() + sent_, output_.size() - sent_, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) {
      const int error = errno;
      DropSent();
      return error == EAGAIN || error == EWOULDBLOCK;
    }
    sent_ += static_cast<std::size_t>(sent);
  }
  output_.clear();
  sent_ = 0;
  return true;
}

// Of a link that is never empty, too. Not at each call, because all that is left moves.
void Link::DropSent() {
  if (sent_ < kDroppedAtATime) return;
  output_.erase(output_.begin(), output_.begin() + static_cast<std::ptrdiff_t>(sent_));
  sent_ = 0;
}

std::size_t Link::pending() const {
  const std::lock_guard lock(mutex_);
  return output_.size() - sent_;
}

bool Link::ReadArrived() {
  for (int chunk = 0; chunk < kMostChunks; ++chunk) {
    const ssize_t count = recv(descriptor_, chunk_.data(), chunk_.size(), MSG_DONTWAIT);
    if (count == 0) return false;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno == EAGAIN || errno == EWOULDBLOCK;
    received_.insert(received_.end(), chunk_.begin(), chunk_.begin() + count);
    if (static_cast<std::size_t>(count) < chunk_.size()) return true;
  }
  return true;
}

}  // namespace troupe::ros
