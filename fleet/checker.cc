#include "fleet/checker.h"

#include <algorithm>

#include "common/base/json_tree.h"
#include "fleet/checker_parts.h"
#include "fleet/codec.h"

namespace troupe::fleet {
namespace {

std::string Listed(const std::vector<MessageFault>& faults) {
  std::string text;
  for (const MessageFault& fault : faults) text += (text.empty() ? "" : "; ") + fault.ToString();
  return text;
}

void JudgeHeader(MessageJudge& judge, const ObservedMessage& observed, const Header& header) {
  VehicleRecord::Sender& sender = judge.record.senders[static_cast<std::size_t>(observed.topic)];
  // The last will is composed when the vehicle connects, so it is older than what came since.
  if (observed.topic != Topic::kConnection) {
    if (sender.header_id && header.header_id != *sender.header_id + 1) {
      judge.Break(Rule::kHeaderIdCounts, "headerId " + std::to_string(header.header_id),
                  std::to_string(*sender.header_id + 1));
    }
    sender.header_id = header.header_id;
    const std::int64_t time = ParseTimestamp(header.timestamp).value_or(sender.timestamp);
    if (time < sender.timestamp) {
      judge.Break(Rule::kTimestampGrows, "the timestamp " + header.timestamp,
                  "at least " + FormatTimestamp(sender.timestamp, judge.version));
    }
    sender.timestamp = std::max(sender.timestamp, time);
  }
  const std::optional<Version> version = FindVersion(header.version);
  if (version && observed.major_version != 0 && MajorOf(*version) != observed.major_version) {
    judge.Break(Rule::kVersionOfTopic,
                "version '" + header.version + "' in a topic of v" + std::to_string(observed.major_version));
  }
  const bool has_sender = !header.manufacturer.empty() || !header.serial_number.empty();
  if (has_sender && (header.manufacturer != observed.manufacturer || header.serial_number != observed.serial_number)) {
    judge.Break(Rule::kSenderInTopic, "'" + header.manufacturer + "/" + header.serial_number + "'",
                "'" + observed.manufacturer + "/" + observed.serial_number + "'");
  }
}

constexpr std::int64_t kSweepMilliseconds = 100;  // between looks at all vehicles

// What the vehicle states when it comes, or else its first message, or its topic.
void ChooseVersion(VehicleRecord& record, const ObservedMessage& observed, const CheckerOptions& options) {
  if (options.version) {
    record.version = options.version;
    return;
  }
  if (record.version && observed.topic != Topic::kConnection && observed.topic != Topic::kFactsheet) return;
  const DecodeLimits limits;
  const Result<JsonTree> tree = JsonTree::Parse(observed.payload, "", {limits.bytes, limits.values});
  const JsonNode* const version = tree.ok() ? tree.value().root().Find("version") : nullptr;
  const std::optional<Version> stated = version != nullptr ? FindVersion(version->text) : std::nullopt;
  if (stated) record.version = stated;
  if (!record.version) record.version = observed.major_version == 3 ? Version::k3_0 : Version::k2_1;
}

// The message, if it has the form of its topic.
template <typename Message>
std::optional<Message> Read(MessageJudge& judge, const ObservedMessage& observed) {
  Decoded<Message> decoded = Decode<Message>(observed.payload, judge.version);
  if (!decoded.ok()) {
    judge.Break(Rule::kMessageForm, Listed(decoded.faults));
    return std::nullopt;
  }
  if (!decoded.lenient.empty()) {
    std::string found;
    for (const LenientPlace& place : decoded.lenient) {
      found += (found.empty() ? "" : "; ") + place.pointer + ": " + NameOf(place.lenience);
    }
    judge.Break(Rule::kStrictJson, std::move(found));
  }
  JudgeHeader(judge, observed, decoded.message.header);
  return std::move(decoded.message);
}

void Judge(MessageJudge& judge, const ObservedMessage& observed) {
  switch (observed.topic) {
    case Topic::kOrder:
      if (const auto order = Read<Order>(judge, observed)) JudgeOrder(judge, *order);
      break;
    case Topic::kInstantActions:
      if (const auto actions = Read<InstantActions>(judge, observed)) JudgeInstantActions(judge, *actions);
      break;
    case Topic::kState:
      if (const auto state = Read<State>(judge, observed)) JudgeState(judge, *state);
      break;
    case Topic::kConnection:
      if (const auto connection = Read<Connection>(judge, observed)) {
        judge.record.connection = connection->state;
        // A vehicle that has been away counts from the beginning, and its last state may be long ago.
        for (const Topic topic : {Topic::kState, Topic::kFactsheet, Topic::kVisualization}) {
          judge.record.senders[static_cast<std::size_t>(topic)].header_id.reset();
        }
        judge.record.is_overdue = true;
      }
      break;
    case Topic::kFactsheet:
      if (auto factsheet = Read<Factsheet>(judge, observed)) judge.record.factsheet = std::move(*factsheet);
      break;
    case Topic::kVisualization:
      Read<Visualization>(judge, observed);
      break;
    case Topic::kZoneSet:
      if (auto set = Read<ZoneSet>(judge, observed)) JudgeZoneSet(judge, std::move(*set));
      break;
    case Topic::kResponses:
      Read<Responses>(judge, observed);
      break;
  }
}

}  // namespace

std::string Verdict::ToString() const {
  return vehicle + ", message " + std::to_string(message) + ": " + NameOf(rule) + ": found " + found + ", expected " +
         expected;
}

std::vector<Verdict> CheckMessage(CheckerMemory& memory, const ObservedMessage& message,
                                  const CheckerOptions& options) {
  std::vector<Verdict> verdicts;
  const std::uint64_t number = memory.messages++;
  const std::string vehicle = message.manufacturer + "/" + message.serial_number;
  if (memory.vehicles.size() >= kMostVehicles && !memory.vehicles.contains(vehicle)) {
    ++memory.left_out;
    return verdicts;
  }
  VehicleRecord& record = memory.vehicles[vehicle];
  ++record.messages;
  ChooseVersion(record, message, options);
  MessageJudge judge{record, options, *record.version, vehicle, number, message.milliseconds, verdicts};
  JudgeTime(judge);
  Judge(judge, message);
  if (message.milliseconds - memory.swept_milliseconds < kSweepMilliseconds) return verdicts;
  const std::vector<Verdict> others = CheckTime(memory, message.milliseconds, options);
  verdicts.insert(verdicts.end(), others.begin(), others.end());
  return verdicts;
}

std::vector<Verdict> CheckTime(CheckerMemory& memory, std::int64_t milliseconds, const CheckerOptions& options) {
  memory.swept_milliseconds = milliseconds;
  std::vector<Verdict> all;
  for (auto& [vehicle, record] : memory.vehicles) {
    std::vector<Verdict> verdicts;
    MessageJudge judge{record, options, *record.version, vehicle, memory.messages, milliseconds, verdicts};
    JudgeTime(judge);
    all.insert(all.end(), verdicts.begin(), verdicts.end());
  }
  return all;
}

void MissMessages(CheckerMemory& memory) {
  for (auto& [name, record] : memory.vehicles) {
    VehicleRecord kept;
    kept.messages = record.messages;
    kept.version = record.version;
    kept.factsheet = std::move(record.factsheet);
    for (std::size_t i = 0; i < kept.senders.size(); ++i) kept.senders[i].timestamp = record.senders[i].timestamp;
    record = std::move(kept);
  }
}

}  // namespace troupe::fleet
