#include "launcher/hosts/host_messages.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace troupe {

std::string ToLine(const HostMessage& message) {
  return JsonText(message) + "\n";
}

HostMessage ParseHostMessage(const std::string& line) {
  return HostMessage::parse(line, nullptr, false);
}

bool WriteAll(int descriptor, const std::string& text) {
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t written = write(descriptor, text.data() + sent, text.size() - sent);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EAGAIN) {  // as of a socket that is read from, too, without waiting
      pollfd waited{descriptor, POLLOUT, 0};
      if (poll(&waited, 1, -1) < 0 && errno != EINTR) return false;
      continue;
    }
    if (written <= 0) return false;
    sent += static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace troupe
