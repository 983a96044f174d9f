#include "launcher/hosts/host_messages.h"

#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/base/json_text.h"

namespace troupe {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";

}  // namespace

std::string ToLine(const HostMessage& message) {
  return JsonText(message) + "\n";
}

HostMessage ParseHostMessage(const std::string& line) {
  return HostMessage::parse(line, nullptr, false);
}

std::string ToHexadecimal(const char* data, std::size_t size) {
  std::string text;
  text.reserve(2 * size);
  for (std::size_t i = 0; i < size; ++i) {
    const auto byte = static_cast<unsigned char>(data[i]);
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string FromHexadecimal(const std::string& text) {
  std::string data;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    data += static_cast<char>(kDigits.find(text[i]) << 4 | kDigits.find(text[i + 1]));
  }
  return data;
}

bool WriteAll(int descriptor, const std::string& text) {
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t written = write(descriptor, text.data() + sent, text.size() - sent);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    sent += static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace troupe
