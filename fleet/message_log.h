// Logs of messages of VDA 5050: one JSON object a line, as `mosquitto_sub -F %j` writes it, with the members
//   time or tst   when the message was seen: s since 1970-01-01 (UTC), or ISO 8601
//   topic         of MQTT
//   payload       the text of the message, or the message itself as a JSON object
// Other members are ignored.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "troupe/result.h"

namespace troupe::fleet {

struct LoggedMessage {
  std::int64_t milliseconds = 0;  // since 1970-01-01 (UTC)
  std::string topic;
  std::string payload;

  bool operator==(const LoggedMessage&) const = default;
};

// Longer lines are refused.
inline constexpr std::size_t kLongestLogLine = 64u << 20;  // bytes

// `file` and `line` name the place in errors.
Result<LoggedMessage> ReadLogLine(std::string_view text, const std::string& file, int line);

// With a line feed. Bytes of the payload that are not UTF-8 become U+FFFD.
std::string LogLine(const LoggedMessage& message);

// The messages of a log, in its order, with the numbers of their lines from 1; empty lines are left out. The error is
// the first one of a line, of the file, or of `visit`.
Status VisitLog(const std::string& path, const std::function<Status(const LoggedMessage& message, int line)>& visit);

}  // namespace troupe::fleet
