#include "fleet/message_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "fleet/topic.h"
#include "tests/support/files.h"

namespace troupe::fleet {
namespace {

TEST(FleetTopic, HasFiveLevelsAndAnInterfaceOfAnyNumberOfThem) {
  const TopicName plain = {"uagv", 2, "Acme", "anna", Topic::kState};
  EXPECT_EQ(plain.ToString(), "uagv/v2/Acme/anna/state");
  EXPECT_EQ(FindTopic("uagv/v2/Acme/anna/state"), plain);
  EXPECT_EQ(FindTopic("site/hall/v3/Acme/anna/zoneSet"), (TopicName{"site/hall", 3, "Acme", "anna", Topic::kZoneSet}));
  EXPECT_EQ(FindTopic("v2/Acme/anna/order"), (TopicName{"", 2, "Acme", "anna", Topic::kOrder}));
  for (const char* other :
       {"", "/", "state", "a/state", "Acme/anna/state", "uagv/2/Acme/anna/state", "uagv/v/Acme/anna/state",
        "uagv/v2x/Acme/anna/state", "uagv/v2/Acme//state", "uagv/v2/Acme/anna/states", "uagv/v2/Acme/anna/state/",
        "uagv/v-2/Acme/anna/state", "uagv/v99999999999999999999/Acme/anna/state"}) {
    EXPECT_EQ(FindTopic(other), std::nullopt) << other;
  }
}

TEST(MessageLog, ReadsItsFormsAndWhatItWrites) {
  const LoggedMessage message = {1'764'316'800'250, "a/b", "{\"x\": \"y\"}\n"};
  EXPECT_EQ(LogLine(message), "{\"time\":1764316800.25,\"topic\":\"a/b\",\"payload\":\"{\\\"x\\\": \\\"y\\\"}\\n\"}\n");
  EXPECT_EQ(ReadLogLine(LogLine(message), "log", 1).value(), message);
  // A message that is not a string is kept as it is written.
  EXPECT_EQ(ReadLogLine(R"({"time": 2, "topic": "t", "payload": {"a":  1.50}})", "log", 1).value(),
            (LoggedMessage{2'000, "t", R"({"a":  1.50})"}));
  // By mosquitto_sub -F %j.
  const char* const line =
      R"({"tst":"2025-11-28T08:00:00.250000Z+0000","topic":"t","qos":0,"retain":0,"payloadlen":1,"payload":"x"})";
  EXPECT_EQ(ReadLogLine(line, "log", 1).value(), (LoggedMessage{1'764'316'800'250, "t", "x"}));
  EXPECT_EQ(LogLine({0, "t", "\xff"}), "{\"time\":0,\"topic\":\"t\",\"payload\":\"\xef\xbf\xbd\"}\n");
}

TEST(MessageLog, NamesTheFaultOfALine) {
  const auto error = [](const char* line) { return ReadLogLine(line, "log", 7).error().ToString(); };
  EXPECT_EQ(error("[1]"), "log:7:1: error: found an array of 1, expected an object with time, topic and payload");
  EXPECT_EQ(error(R"({"topic": "t", "payload": ""})"),
            "log:7:1: error: found no 'time' or 'tst', expected the time of the message");
  EXPECT_EQ(error(R"({"time": 1, "payload": ""})"), "log:7:1: error: found no 'topic', expected that of the message");
  EXPECT_EQ(error(R"({"time": 1, "topic": "t"})"), "log:7:1: error: found no 'payload', expected the message");
  EXPECT_EQ(error(R"({"time": 1, "topic": 3, "payload": ""})"),
            "log:7:22: error: found the number 3, expected a string");
  EXPECT_EQ(error(R"({"time": "now", "topic": "t", "payload": ""})"),
            "log:7:10: error: found the string 'now', expected seconds since 1970, or a time in ISO 8601");
  EXPECT_EQ(error(R"({"time": 1e300, "topic": "t", "payload": ""})"),
            "log:7:10: error: found the number 1e+300, expected seconds since 1970, or a time in ISO 8601");
  EXPECT_THAT(error("{\"time\": 1"), testing::StartsWith("log:7:11: error: "));
}

TEST(MessageLog, IsReadLineByLine) {
  test::TemporaryFolder folder;
  const std::string path = folder.Path("log.jsonl");
  const std::string large(3u << 20, 'x');
  std::ofstream(path) << LogLine({1, "a", "1"}) << "\n \r\n"
                      << LogLine({2, "b", large}) << R"({"time":0.003,)"
                      << R"("topic":"c","payload":"3"})";
  std::vector<std::pair<int, std::string>> seen;
  const auto visit = [&](const LoggedMessage& message, int line) -> Status {
    seen.emplace_back(line, message.topic);
    EXPECT_EQ(message.milliseconds, static_cast<std::int64_t>(seen.size()));
    if (message.topic == "b") EXPECT_EQ(message.payload, large);
    return {};
  };
  EXPECT_TRUE(VisitLog(path, visit).ok());
  EXPECT_THAT(seen, testing::ElementsAre(testing::Pair(1, "a"), testing::Pair(4, "b"), testing::Pair(5, "c")));
  EXPECT_EQ(VisitLog(folder.Path("none"), visit).error().code, ErrorCode::kBadInput);
  std::ofstream(path) << "\n{\n";
  EXPECT_THAT(VisitLog(path, visit).error().ToString(), testing::StartsWith(path + ":2:"));
}

}  // namespace
}  // namespace troupe::fleet
