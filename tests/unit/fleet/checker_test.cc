// Each rule of the checker is broken by one message of an otherwise good sequence, and by no good sequence.
// reference.py judges random sequences of a vehicle that follows the rules.
#include "fleet/checker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>

#include "fleet/codec.h"
#include "tests/unit/fleet/conversation.h"
#include "tests/unit/fleet/fleet_samples.h"

namespace troupe::fleet {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class CheckerOf : public testing::TestWithParam<Version> {};
INSTANTIATE_TEST_SUITE_P(Versions, CheckerOf, testing::Values(Version::k2_0, Version::k2_1, Version::k3_0),
                         [](const auto& info) {
                           return std::string("V") + NameOf(info.param)[0] + NameOf(info.param)[2];
                         });

TEST_P(CheckerOf, EachRuleIsBrokenByItsSequenceInItsVersions) {
  std::set<Rule> seen;
  for (const auto& [rule, play] : BrokenRules()) {
    Conversation conversation(GetParam());
    ASSERT_THAT(conversation.verdicts(), IsEmpty()) << conversation.verdicts()[0].ToString();
    play(conversation);
    std::string all;
    for (const Verdict& verdict : conversation.verdicts()) all += verdict.ToString() + '\n';
    if (InfoOf(rule).IsIn(GetParam())) {
      EXPECT_THAT(conversation.Broken(), ElementsAre(NameOf(rule))) << NameOf(rule) << '\n' << all;
    } else {
      EXPECT_THAT(conversation.verdicts(), IsEmpty()) << NameOf(rule) << '\n' << all;
    }
    seen.insert(rule);
  }
  EXPECT_EQ(seen.size(), Rules().size());
}

TEST(Checker, RulesHaveTheirPlaces) {
  for (std::size_t i = 0; i < Rules().size(); ++i) EXPECT_EQ(Rules()[i].rule, static_cast<Rule>(i));
}

// docs/vda5050.md has the decision table and the rules as they are.
TEST(Checker, ThePageListsRowsRulesAndLeniencies) {
  const char* const folder = std::getenv("TROUPE_SOURCE_DIR");
  ASSERT_NE(folder, nullptr);
  std::ifstream file(std::string(folder) + "/docs/vda5050.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  const auto code = [](std::string_view text) { return text.empty() ? "-" : "`" + std::string(text) + "`"; };
  for (const OrderRow& row : OrderTable()) {
    std::string line = "| `" + std::string(row.name) + "` | " + std::string(row.condition) + " | " +
                       NameOf(row.verdict) + " | " + code(row.older_error) + " | " + code(row.newer_error);
    if (row.newer_level != ErrorLevel::kWarning) line += std::string(" (") + NameOf(row.newer_level) + ")";
    EXPECT_THAT(page, testing::HasSubstr(line + " |\n"));
  }
  for (const RuleInfo& info : Rules()) {
    std::string line = std::string("| `") + NameOf(info.rule) + "` | " + NameOf(info.side) + " |";
    for (const bool is_in : info.versions) line += is_in ? " x |" : " - |";
    EXPECT_THAT(page, testing::HasSubstr(line + " " + std::string(info.requirement) + " |\n"));
  }
  for (const std::string& name : AllNames<Lenience>()) EXPECT_THAT(page, testing::HasSubstr("`" + name + "`"));
}

TEST_P(CheckerOf, AGoodConversationBreaksNoRule) {
  Conversation c(GetParam());
  HoldGoodConversation(c);
  for (const Verdict& verdict : c.verdicts()) ADD_FAILURE() << verdict.ToString();
}

// Without a version of all messages each vehicle is judged by its own, and a topic of another one is a violation.
TEST(Checker, EachVehicleIsJudgedByItsVersion) {
  CheckerMemory memory;
  const CheckerOptions options;
  const auto see = [&](const std::string& vehicle, const Connection& connection, Version version, int major) {
    return CheckMessage(memory, {"Troupe", vehicle, Topic::kConnection, 0, Encode(connection, version), major},
                        options);
  };
  for (const Version version : {Version::k2_0, Version::k2_1, Version::k3_0}) {
    Connection connection{SampleHeader(version), ConnectionState::kOnline};
    connection.header.serial_number = NameOf(version);
    EXPECT_THAT(see(NameOf(version), connection, version, MajorOf(version)), IsEmpty());
    EXPECT_EQ(memory.vehicles.at(std::string("Troupe/") + NameOf(version)).version, version);
  }
  const auto verdicts = see("anna", {SampleHeader(Version::k2_1), ConnectionState::kOnline}, Version::k2_1, 3);
  ASSERT_EQ(verdicts.size(), 1u);
  EXPECT_EQ(verdicts[0].rule, Rule::kVersionOfTopic);
  EXPECT_EQ(verdicts[0].found, "version '2.1.0' in a topic of v3");
}

// Nothing that a message can have takes long, or fills the memory.
TEST_P(CheckerOf, HostileMessagesAreJudgedSoonAndInFewWords) {
  CheckerMemory memory;
  CheckerOptions options;
  options.version = GetParam();
  State state = MakeState(VehicleMemory(), SampleProfile(GetParam()), SampleReadings());
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const std::string id = "a" + std::to_string(i);
    state.action_states.push_back({id, {}, {}, ActionStatus::kRunning, {}});
    state.node_states.push_back({"n", 5, {}, true, {}});
  }
  std::vector<Verdict> verdicts;
  for (std::uint32_t i = 0; i < 3; ++i) {
    state.header = SampleHeader(GetParam(), i);
    if (i == 2) state.action_states.clear();
    verdicts = CheckMessage(memory, {"Troupe", "anna", Topic::kState, 0, Encode(state, GetParam())}, options);
  }
  const auto kept = std::count_if(verdicts.begin(), verdicts.end(),
                                  [](const Verdict& verdict) { return verdict.rule == Rule::kActionStatesKept; });
  EXPECT_EQ(static_cast<std::size_t>(kept), kMostVerdicts);
  for (std::size_t i = 0; i < kMostVehicles + 10; ++i) {
    CheckMessage(memory, {"Troupe", std::to_string(i), Topic::kState, 0, "{"}, options);
  }
  EXPECT_EQ(memory.vehicles.size(), kMostVehicles);
  EXPECT_EQ(memory.left_out, 11u);
}

TEST_P(CheckerOf, ACheckerThatComesLateKnowsNothingOfTheOrder) {
  CheckerMemory memory;
  CheckerOptions options;
  options.version = GetParam();
  VehicleProfile profile = SampleProfile(GetParam());
  VehicleMemory vehicle;
  Apply(vehicle, OrderReceived{SampleOrder(GetParam(), "o1", 0, "ABC", 2), {}}, profile, SampleReadings());
  State state = MakeState(vehicle, profile, SampleReadings());
  state.header = SampleHeader(GetParam(), 50);
  EXPECT_THAT(CheckMessage(memory, {"Troupe", "anna", Topic::kState, 0, Encode(state, GetParam())}, options),
              IsEmpty());
  Order update = SampleOrder(GetParam(), "o1", 1, "BC", 2, 2);
  update.header.header_id = 40;
  EXPECT_THAT(CheckMessage(memory, {"Troupe", "anna", Topic::kOrder, 100, Encode(update, GetParam())}, options),
              IsEmpty());
  Apply(vehicle, OrderReceived{update, {}}, profile, SampleReadings());
  state = MakeState(vehicle, profile, SampleReadings());
  state.header = SampleHeader(GetParam(), 51, 2'000);
  const auto verdicts =
      CheckMessage(memory, {"Troupe", "anna", Topic::kState, 200, Encode(state, GetParam())}, options);
  for (const Verdict& verdict : verdicts) ADD_FAILURE() << verdict.ToString();
}

TEST(Checker, TheMemoryIsAValue) {
  CheckerOptions options;
  CheckerMemory memory;
  const ObservedMessage message = {
      "Troupe", "anna", Topic::kConnection, 0,
      Encode(Connection{SampleHeader(Version::k2_1), ConnectionState::kOnline}, Version::k2_1)};
  CheckMessage(memory, message, options);
  CheckerMemory copy = memory;
  EXPECT_TRUE(copy == memory);
  CheckMessage(copy, message, options);
  EXPECT_FALSE(copy == memory);
}

}  // namespace
}  // namespace troupe::fleet
