#include "launcher/hosts/host_messages.h"

#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace troupe {

std::string ToLine(const HostMessage& message) {
  return JsonText(message) + "\n";
}

HostMessage ParseHostMessage(const std::string& line) {
  return HostMessage::parse(line, nullptr, false);
}

}  // namespace troupe
