#include "fleet/message_log.h"

#include <unistd.h>

#include <cmath>

#include "common/base/file.h"
#include "common/base/json_tree.h"
#include "common/base/json_writer.h"
#include "fleet/order_message.h"

namespace troupe::fleet {
namespace {

constexpr std::size_t kPieceOfLog = 1u << 20;  // bytes
constexpr double kLatestSeconds = 4e9;         // since 1970: the year 2096

// Nothing of a value that is no time.
std::optional<std::int64_t> TimeOf(const JsonNode& node) {
  if (node.is_string()) {
    // mosquitto_sub writes "Z+0000".
    const std::size_t twice = node.text.rfind("Z+");
    return ParseTimestamp(twice == std::string::npos ? node.text
                                                     : node.text.substr(0, twice) + node.text.substr(twice + 1));
  }
  if (!node.is_number() || !(std::abs(node.number) <= kLatestSeconds)) return std::nullopt;
  return std::llround(node.number * 1e3);
}

}  // namespace

Result<LoggedMessage> ReadLogLine(std::string_view text, const std::string& file, int line) {
  const Result<JsonTree> tree = JsonTree::Parse(text, file, {kLongestLogLine, JsonLimits::OfUsers().values});
  if (!tree.ok()) {
    Error error = tree.error();
    error.where.line = line;
    return error;
  }
  const JsonNode& root = tree.value().root();
  const auto fault = [&](const JsonNode& at, const std::string& found, const std::string& expected) {
    Error error = tree.value().ErrorAt(at, "found " + found + ", expected " + expected);
    error.where.line = line;
    return error;
  };
  if (!root.is_object()) return fault(root, Describe(root), "an object with time, topic and payload");
  const JsonNode* const time = root.Find("time") != nullptr ? root.Find("time") : root.Find("tst");
  const JsonNode* const topic = root.Find("topic");
  const JsonNode* const payload = root.Find("payload");
  if (time == nullptr) return fault(root, "no 'time' or 'tst'", "the time of the message");
  if (topic == nullptr) return fault(root, "no 'topic'", "that of the message");
  if (payload == nullptr) return fault(root, "no 'payload'", "the message");
  const std::optional<std::int64_t> milliseconds = TimeOf(*time);
  if (!milliseconds) return fault(*time, Describe(*time), "seconds since 1970, or a time in ISO 8601");
  if (!topic->is_string()) return fault(*topic, Describe(*topic), "a string");
  return LoggedMessage{*milliseconds, topic->text,
                       payload->is_string() ? payload->text : std::string(payload->span.Of(text))};
}

std::string LogLine(const LoggedMessage& message) {
  std::string line;
  JsonWriter(line)
      .BeginObject()
      .Member("time", static_cast<double>(message.milliseconds) / 1e3)
      .Member("topic", message.topic)
      .Member("payload", message.payload)
      .EndObject();
  return line + "\n";
}

Status VisitLog(const std::string& path, const std::function<Status(const LoggedMessage& message, int line)>& visit) {
  const Result<FileDescriptor> file = OpenToRead(path);
  if (!file.ok()) return Error{{path}, file.error().message};
  std::string text;  // that no line has been made of yet
  int line = 0;
  const auto read_line = [&](std::string_view content) -> Status {
    ++line;
    if (content.find_first_not_of(" \t\r") == std::string_view::npos) return {};
    const Result<LoggedMessage> message = ReadLogLine(content, path, line);
    return message.ok() ? visit(message.value(), line) : message.error();
  };
  for (std::size_t searched = 0;;) {
    const std::size_t size = text.size();
    text.resize(size + kPieceOfLog);
    const ssize_t got = read(file.value().get(), text.data() + size, kPieceOfLog);
    if (got < 0) return FileError(path);
    text.resize(size + static_cast<std::size_t>(got));
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = text.find('\n', std::max(begin, searched))) != std::string::npos;) {
      if (Status status = read_line(std::string_view(text).substr(begin, end - begin)); !status.ok()) return status;
      begin = end + 1;
    }
    text.erase(0, begin);
    searched = text.size();
    if (got == 0) return text.empty() ? Status() : read_line(text);
    if (text.size() > kLongestLogLine) {
      return Error{{path, line + 1, 1}, "found a line of more than " + std::to_string(kLongestLogLine >> 20) + " MiB"};
    }
  }
}

}  // namespace troupe::fleet
