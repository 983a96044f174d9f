// Round trips of all messages in all versions; each leniency by its name; faults with their places; hostile payloads.
#include "fleet/codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/fleet/full_messages.h"

namespace troupe::fleet {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

template <typename Message>
void ExpectRoundTrip(const Message& message, Version version) {
  const std::string text = Encode(message, version);
  const Decoded<Message> decoded = Decode<Message>(text, version);
  EXPECT_THAT(decoded.faults, IsEmpty()) << (decoded.ok() ? "" : decoded.faults[0].ToString()) << text;
  EXPECT_THAT(decoded.lenient, IsEmpty()) << text;
  EXPECT_TRUE(decoded.message == message) << text << '\n' << Encode(decoded.message, version);
}

TEST(Codec, AllMessagesReadBackTheSame) {
  for (const Version version : kAllVersions) {
    ExpectRoundTrip(FullOrder(version), version);
    ExpectRoundTrip(InstantActions{SampleHeader(version), {SampleActionOf("cancelOrder", "i1", BlockingType::kNone)}},
                    version);
    ExpectRoundTrip(FullState(version), version);
    ExpectRoundTrip(FullFactsheet(version), version);
    ExpectRoundTrip(Connection{SampleHeader(version), ConnectionState::kConnectionBroken}, version);
    Visualization visualization;
    visualization.header = SampleHeader(version);
    if (!IsBefore3(version)) visualization.reference_state_header_id = 6;
    visualization.position = FullState(version).position;
    ExpectRoundTrip(visualization, version);
  }
  ExpectRoundTrip(FullZoneSet(), Version::k3_0);
  ExpectRoundTrip(Responses{SampleHeader(Version::k3_0), {{"r1", GrantType::kQueued, {}}}}, Version::k3_0);
}

// One value of an order's text is replaced.
Decoded<Order> DecodeWith(Version version, const std::string& from, const std::string& to) {
  std::string text = Encode(FullOrder(version), version);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from << " in " << text;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return Decode<Order>(text, version);
}

struct LenientCase {
  Lenience lenience;
  Version version;
  std::string from;
  std::string to;
};

TEST(Codec, EachLenienceIsAcceptedAndNamed) {
  const LenientCase cases[] = {
      {Lenience::kNumberAsString, Version::k2_1, "\"maxSpeed\":1.25", "\"maxSpeed\":\"1.25\""},
      {Lenience::kNumberAsString, Version::k2_1, "\"sequenceId\":2", "\"sequenceId\":\"2\""},
      {Lenience::kBooleanAsString, Version::k2_1, "\"released\":true", "\"released\":\"true\""},
      {Lenience::kBooleanAsNumber, Version::k3_0, "\"released\":true", "\"released\":1"},
      {Lenience::kStringAsNumber, Version::k2_1, "\"zoneSetId\":\"zones\"", "\"zoneSetId\":17"},
      {Lenience::kNullForMissing, Version::k2_1, "\"length\":4", "\"length\":null"},
      {Lenience::kMissingList, Version::k2_1, ",\"actions\":[]}", "}"},
      {Lenience::kOtherName, Version::k2_0, "allowedDeviationXY", "allowedDeviationXy"},
      {Lenience::kOtherName, Version::k3_0, "nodeDescriptor", "nodeDescription"},
      {Lenience::kOtherForm, Version::k3_0, "{\"a\":0.3,\"b\":0.2,\"theta\":0.5}", "0.3"},
      {Lenience::kEnumerationSpelling, Version::k2_1, "\"SOFT\"", "\"soft\""},
      {Lenience::kEnumerationSpelling, Version::k2_1, "KINEMATICCENTER", "KINEMATIC_CENTER"},
      {Lenience::kAngleOutOfRange, Version::k2_1, "\"theta\":-1.5", "\"theta\":4.0"},
      {Lenience::kTimestampForm, Version::k2_1, "1970-01-01T00:00:01.00Z", "1970-01-01T01:00:01+01:00"},
  };
  for (const LenientCase& each : cases) {
    const Decoded<Order> decoded = DecodeWith(each.version, each.from, each.to);
    EXPECT_TRUE(decoded.ok()) << each.to << ": " << (decoded.ok() ? "" : decoded.faults[0].ToString());
    ASSERT_EQ(decoded.lenient.size(), 1u) << each.to;
    EXPECT_EQ(decoded.lenient[0].lenience, each.lenience) << each.to;
    EXPECT_THAT(decoded.lenient[0].pointer, testing::StartsWith("/"));
  }
  EXPECT_EQ(DecodeWith(Version::k2_1, "\"maxSpeed\":1.25", "\"maxSpeed\":\"1.25\"").message.edges[0].maximum_speed,
            1.25);
}

TEST(Codec, FaultsSayWhereAndWhatWasFoundAndExpected) {
  struct Case {
    std::string from;
    std::string to;
    std::string message;
  };
  const Case cases[] = {
      {"\"sequenceId\":2", "\"sequenceId\":\"two\"",
       "/nodes/1/sequenceId: found the string 'two', expected a whole number from 0 to 4294967295"},
      {"\"sequenceId\":2", "\"sequenceId\":2.5", "/nodes/1/sequenceId: found the number 2.5, expected a whole number"},
      {"\"sequenceId\":2", "\"sequenceId\":-2", "/nodes/1/sequenceId: found the number -2, expected a whole number"},
      {"\"released\":true", "\"released\":null", "/nodes/0/released: found null, expected true or false"},
      {"\"blockingType\":\"SOFT\"", "\"blockingType\":\"LOUD\"",
       "/nodes/1/actions/0/blockingType: found the string 'LOUD', expected one of NONE, SOFT, SINGLE, HARD"},
      {"\"orderId\":\"o1\",", "", "found no member 'orderId', expected one"},
      {"\"orderId\":\"o1\"", "\"orderId\":[]", "/orderId: found an empty array, expected a string"},
      {"\"version\":\"2.1.0\"", "\"version\":\"3.0.0\"", "/version: found the string '3.0.0', expected 2.x.y"},
      {"\"version\":\"2.1.0\"", "\"version\":\"1.1\"", "/version: found the string '1.1', expected 2.x.y"},
      {"\"leftWidth\":0.5", "\"leftWidth\":-0.5", "/edges/0/corridor/leftWidth: found the number -0.5, expected"},
      {"\"x\":4", "\"x\":\"NaN\"", "/nodes/1/nodePosition/x: found the string 'NaN', expected a number"},
      {"1970-01-01T00:00:01.00Z", "yesterday", "/timestamp: found the string 'yesterday', expected a time"},
      {"{\"x\":1,\"y\":1,\"weight\":2}", "7",
       "/edges/0/trajectory/controlPoints/1: found the number 7, expected an object"},
  };
  for (const Case& each : cases) {
    const Decoded<Order> decoded = DecodeWith(Version::k2_1, each.from, each.to);
    ASSERT_FALSE(decoded.ok()) << each.to;
    EXPECT_THAT(decoded.faults[0].ToString(), HasSubstr(each.message));
  }
}

TEST(Codec, HostileTextsAreFaults) {
  DecodeLimits limits;
  const std::string big = "{\"orderId\":\"" + std::string(10'000'000, 'a') + "\"}";
  std::string many = "[";
  for (int i = 0; i < 300'000; ++i) many += "1,";
  many += "1]";
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("nul"), std::string("{\"headerId\":NaN}"), std::string("[1,2]"),
        std::string("{\"x\":1e999}"), std::string("\xff\xfe"), std::string("{\"a\":1,\"a\":2}"),
        std::string(100'000, '['), std::string(100'000, '{'), big, many}) {
    const Decoded<Order> decoded = Decode<Order>(text, Version::k2_1, limits);
    EXPECT_FALSE(decoded.ok());
    for (const MessageFault& fault : decoded.faults) EXPECT_LT(fault.ToString().size(), 400u);
  }
  EXPECT_THAT(Decode<Order>(big, Version::k2_1).faults[0].text, HasSubstr("expected at most 4194304"));
  // As many faults as are listed, and no more work than that.
  std::string wrong = "{\"nodes\":[";
  for (int i = 0; i < 50'000; ++i) wrong += "1,";
  EXPECT_EQ(Decode<Order>(wrong + "1]}", Version::k2_1).faults.size(), kMaxMessageFaults);
}

TEST(Codec, UnknownMembersAreIgnored) {
  EXPECT_TRUE(DecodeWith(Version::k2_1, "{\"headerId\"", "{\"vendor\":{\"a\":[1]},\"headerId\"").ok());
}

TEST(Codec, ValuesOfOtherVersionsBecomeTheNearest) {
  State state = FullState(Version::k3_0);
  const State older = Decode<State>(Encode(state, Version::k2_1), Version::k2_1).message;
  EXPECT_EQ(older.operating_mode, OperatingMode::kManual);
  EXPECT_EQ(older.errors[0].level, ErrorLevel::kWarning);
  EXPECT_EQ(older.action_states[0].status, ActionStatus::kRunning);
  state.safety_state.emergency_stop = EmergencyStop::kAutomatic;
  EXPECT_THAT(Encode(state, Version::k3_0), HasSubstr("\"activeEmergencyStop\":\"NONE\""));
  EXPECT_THAT(Encode(state, Version::k2_1), HasSubstr("\"eStop\":\"AUTOACK\""));
}

TEST(Codec, ParametersOfActionsAreReadFromStrings) {
  EXPECT_EQ(ParameterValue::Of("1.5").Number(), 1.5);
  EXPECT_EQ(ParameterValue::Of(1.5).Number(), 1.5);
  EXPECT_EQ(ParameterValue::Of("1.5 m").Number(), std::nullopt);
  EXPECT_EQ(ParameterValue::Of("inf").Number(), std::nullopt);
  EXPECT_EQ(ParameterValue::Of("True").Boolean(), true);
  EXPECT_EQ(ParameterValue::Of("yes").Boolean(), std::nullopt);
}

TEST(Codec, Versions) {
  EXPECT_EQ(FindVersion("2.0.0"), Version::k2_0);
  EXPECT_EQ(FindVersion("2.1.0"), Version::k2_1);
  EXPECT_EQ(FindVersion("2.7"), Version::k2_1);
  EXPECT_EQ(FindVersion("3.0.1"), Version::k3_0);
  for (const char* const text : {"", "2", "1.1.0", "4.0.0", "v2.1", "2.", ".1", "2.x", "-2.1", "99999999999.1"}) {
    EXPECT_EQ(FindVersion(text), std::nullopt) << text;
  }
}

TEST(Codec, Timestamps) {
  EXPECT_EQ(FormatTimestamp(0, Version::k2_1), "1970-01-01T00:00:00.00Z");
  EXPECT_EQ(FormatTimestamp(1'709'210'096'789, Version::k3_0), "2024-02-29T12:34:56.789Z");
  EXPECT_EQ(ParseTimestamp("2024-02-29T12:34:56.789Z"), 1'709'210'096'789);
  EXPECT_EQ(ParseTimestamp("2024-02-29T12:34:56Z"), 1'709'210'096'000);
  EXPECT_EQ(ParseTimestamp("2024-02-29T12:34:56.78901234Z"), 1'709'210'096'789);
  EXPECT_EQ(ParseTimestamp("2024-02-29T14:34:56.7+02:00"), 1'709'210'096'700);
  for (const char* const text : {"", "2024", "2024-13-01T00:00:00Z", "2024-02-29", "2024-02-29T12:34",
                                 "2024-02-29T12:34:56.Z", "2024-02-29T12:34:56Zz", "-024-02-29T12:34:56Z"}) {
    EXPECT_EQ(ParseTimestamp(text), std::nullopt) << text;
  }
  for (std::int64_t day = 0; day < 100'000; day += 17) {
    const std::int64_t milliseconds = day * 86'400'000 + 12'345'678;
    EXPECT_EQ(ParseTimestamp(FormatTimestamp(milliseconds, Version::k3_0)), milliseconds);
  }
  EXPECT_EQ(FormatTimestamp(-5, Version::k3_0), "1970-01-01T00:00:00.000Z");
}

}  // namespace
}  // namespace troupe::fleet
