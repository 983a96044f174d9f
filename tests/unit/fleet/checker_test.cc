// Each rule of the checker is broken by one message of an otherwise good sequence, and by no good sequence.
// reference.py judges random sequences of a vehicle that follows the rules.
#include "fleet/checker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>

#include "fleet/codec.h"
#include "tests/unit/fleet/fleet_samples.h"

namespace troupe::fleet {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// A fleet control and a vehicle whose messages a checker sees.
class Conversation {
 public:
  explicit Conversation(Version version) : version_(version), profile_(SampleProfile(version)) {
    options_.version = version;
    readings_ = SampleReadings();
    See(Topic::kConnection, Encode(Connection{SampleHeader(version), ConnectionState::kOnline}, version));
    See(Topic::kFactsheet, Encode(profile_.factsheet, version));
    Report();
  }

  void Send(Order order) {
    order.header = SampleHeader(version_, ++orders_, Now());
    See(Topic::kOrder, Encode(order, version_));
    Give(OrderReceived{order, {}});
  }
  // The message is seen, but the vehicle does not get it.
  void Lose(Order order) {
    order.header = SampleHeader(version_, ++orders_, Now());
    See(Topic::kOrder, Encode(order, version_));
  }
  void SendPlaces(const std::string& id, std::uint32_t update, const std::string& places, std::size_t released,
                  std::uint32_t first = 0) {
    Send(SampleOrder(version_, id, update, places, released, first));
  }
  void Instant(const Action& action, bool is_lost = false) {
    const InstantActions message = {SampleHeader(version_, ++instants_, Now()), {action}};
    See(Topic::kInstantActions, Encode(message, version_));
    if (!is_lost) Give(InstantActionsReceived{message, {}});
  }
  void Instant(const std::string& type) { Instant(SampleActionOf(type, type, BlockingType::kNone)); }
  void Give(const VehicleInput& input) {
    Apply(memory_, input, profile_, readings_);
    Report();
  }
  void Report() {
    ReportAs([](State&) {});
  }
  // A state as a faulty vehicle would send it.
  void ReportAs(const std::function<void(State&)>& change) {
    State state = MakeState(memory_, profile_, readings_);
    state.header = SampleHeader(version_, ++states_, Now());
    change(state);
    See(Topic::kState, Encode(state, version_));
  }
  void See(Topic topic, const std::string& payload, int major_version = 0) {
    Keep(CheckMessage(checker_, {"Troupe", "anna", topic, milliseconds_, payload, major_version}, options_));
    milliseconds_ += 100;
  }
  void Wait(std::int64_t milliseconds) {
    milliseconds_ += milliseconds;
    Keep(CheckTime(checker_, milliseconds_, options_));
  }

  std::set<std::string> Broken() const {
    std::set<std::string> rules;
    for (const Verdict& verdict : verdicts_) rules.insert(NameOf(verdict.rule));
    return rules;
  }
  const std::vector<Verdict>& verdicts() const { return verdicts_; }
  std::int64_t Now() const { return milliseconds_; }
  Version version() const { return version_; }

 private:
  void Keep(const std::vector<Verdict>& verdicts) {
    verdicts_.insert(verdicts_.end(), verdicts.begin(), verdicts.end());
  }

  const Version version_;
  VehicleProfile profile_;
  VehicleMemory memory_;
  VehicleReadings readings_;
  CheckerMemory checker_;
  CheckerOptions options_;
  std::vector<Verdict> verdicts_;
  std::int64_t milliseconds_ = 1'000;
  std::uint32_t orders_ = 0;
  std::uint32_t instants_ = 0;
  std::uint32_t states_ = 0;
};

using Play = std::function<void(Conversation&)>;

Order WithPick(Version version, BlockingType type, const std::string& id = "a1") {
  Order order = SampleOrder(version, "o1", 0, "ABCD", 3);
  order.nodes[1].actions = {SampleActionOf("pick", id, type), SampleActionOf("blink", id + "b", BlockingType::kNone)};
  return order;
}

void Start(Conversation& c) {
  c.SendPlaces("o1", 0, "ABCD", 3);
}

// For each rule a sequence that breaks it, and nothing else but what follows from it.
std::vector<std::pair<Rule, Play>> BrokenRules() {
  return {
      {Rule::kMessageForm, [](Conversation& c) { c.See(Topic::kOrder, "{\"orderId\": 7"); }},
      {Rule::kStrictJson,
       [](Conversation& c) {
         std::string text = Encode(Connection{SampleHeader(c.version()), ConnectionState::kOnline}, c.version());
         text.replace(text.find("\"ONLINE\""), 8, "\"Online\"");
         c.See(Topic::kConnection, text);
       }},
      {Rule::kHeaderIdCounts, [](Conversation& c) { c.ReportAs([](State& s) { s.header.header_id = 9; }); }},
      {Rule::kTimestampGrows,
       [](Conversation& c) { c.ReportAs([&](State& s) { s.header.timestamp = FormatTimestamp(0, c.version()); }); }},
      {Rule::kSenderInTopic, [](Conversation& c) { c.ReportAs([](State& s) { s.header.serial_number = "bela"; }); }},
      {Rule::kVersionOfTopic,
       [](Conversation& c) {
         const Connection message{SampleHeader(c.version()), ConnectionState::kOnline};
         c.See(Topic::kConnection, Encode(message, c.version()), 1);
       }},
      {Rule::kOrderForm,
       [](Conversation& c) {
         Order order = SampleOrder(c.version(), "o1", 0, "ABC", 3);
         order.edges.pop_back();
         c.Send(order);
       }},
      {Rule::kOrderBeginsAtZero, [](Conversation& c) { c.SendPlaces("o1", 0, "AB", 2, 4); }},
      {Rule::kNewOrderUpdateZero, [](Conversation& c) { c.SendPlaces("o1", 2, "AB", 2); }},
      {Rule::kUpdateIdGrows,
       [](Conversation& c) {
         Start(c);
         c.SendPlaces("o1", 2, "CD", 2, 4);
         c.SendPlaces("o1", 1, "CD", 2, 4);
       }},
      {Rule::kResendUnchanged,
       [](Conversation& c) {
         c.Lose(SampleOrder(c.version(), "o1", 0, "ABC", 3));
         c.SendPlaces("o1", 0, "ABD", 3);
       }},
      {Rule::kUpdateContinuesBase,
       [](Conversation& c) {
         Start(c);
         c.SendPlaces("o1", 1, "BD", 2, 2);
       }},
      {Rule::kStitchingNodeUnchanged,
       [](Conversation& c) {
         Start(c);
         Order update = SampleOrder(c.version(), "o1", 1, "CD", 2, 4);
         update.nodes[0].actions = {SampleActionOf("pick", "new", BlockingType::kNone)};
         c.Send(update);
       }},
      {Rule::kNewOrderWhenIdle,
       [](Conversation& c) {
         Start(c);
         c.SendPlaces("o2", 0, "AB", 2);
       }},
      {Rule::kNoUpdateAfterCancel,
       [](Conversation& c) {
         Start(c);
         c.Instant("cancelOrder");
         c.SendPlaces("o1", 1, "CD", 2, 4);
       }},
      {Rule::kOrdersInModes,
       [](Conversation& c) {
         c.Give(ModeChanged{OperatingMode::kManual});
         Start(c);
       }},
      {Rule::kOrderWithinFactsheet,
       [](Conversation& c) {
         Order order = SampleOrder(c.version(), "o1", 0, "AB", 2);
         order.nodes[1].actions = {SampleActionOf("fly", "a1")};
         c.Send(order);
       }},
      {Rule::kInstantActionKnown, [](Conversation& c) { c.Instant("fly"); }},
      {Rule::kInstantActionsInModes,
       [](Conversation& c) {
         c.Give(ModeChanged{OperatingMode::kManual});
         c.Instant("startPause");
       }},
      {Rule::kActionIdsUnique,
       [](Conversation& c) {
         c.Send(WithPick(c.version(), BlockingType::kHard, "startPause"));
         c.Instant("startPause");
       }},
      {Rule::kOnlineBeforeState,
       [](Conversation& c) {
         c.See(Topic::kConnection,
               Encode(Connection{SampleHeader(c.version()), ConnectionState::kOffline}, c.version()));
         c.Report();
       }},
      {Rule::kStateInterval, [](Conversation& c) { c.Wait(32'000); }},
      {Rule::kOrderAnswered,
       [](Conversation& c) {
         c.Lose(SampleOrder(c.version(), "o1", 0, "AB", 2));
         c.Wait(6'000);
       }},
      {Rule::kRejectionKept,
       [](Conversation& c) {
         c.SendPlaces("o1", 0, "BA", 2);
         c.ReportAs([](State& s) { s.errors.clear(); });
       }},
      {Rule::kInstantActionReported,
       [](Conversation& c) {
         c.Instant(SampleActionOf("stateRequest", "i1", BlockingType::kNone), true);
         c.Wait(6'000);
       }},
      {Rule::kOrderWasSent, [](Conversation& c) { c.ReportAs([](State& s) { s.order_id = "o9"; }); }},
      {Rule::kUpdateIdKept,
       [](Conversation& c) {
         Start(c);
         c.SendPlaces("o1", 1, "CD", 2, 4);
         c.ReportAs([](State& s) { s.order_update_id = 0; });
       }},
      {Rule::kStateSequence,
       [](Conversation& c) {
         Start(c);
         c.ReportAs([](State& s) { std::swap(s.node_states[0], s.node_states[1]); });
       }},
      {Rule::kNodesOfOrder,
       [](Conversation& c) {
         Start(c);
         c.ReportAs([](State& s) { s.node_states[1].node_id = "X"; });
       }},
      {Rule::kReleasedByFleet,
       [](Conversation& c) {
         Start(c);
         c.ReportAs([](State& s) { s.node_states[2].released = true; });
       }},
      {Rule::kHorizonComplete,
       [](Conversation& c) {
         Start(c);
         c.ReportAs([](State& s) {
           s.node_states.pop_back();
           s.edge_states.pop_back();
         });
       }},
      {Rule::kTraversalInSequence,
       [](Conversation& c) {
         Start(c);
         c.ReportAs([](State& s) {
           s.last_node_id = "C";
           s.last_node_sequence_id = 4;
         });
       }},
      {Rule::kOnlyBaseTraversed,
       [](Conversation& c) {
         Start(c);
         c.ReportAs([](State& s) {
           s.last_node_id = "D";
           s.last_node_sequence_id = 6;
           s.node_states.clear();
           s.edge_states.clear();
         });
       }},
      {Rule::kActionStatesComplete,
       [](Conversation& c) {
         const Order order = WithPick(c.version(), BlockingType::kHard);
         c.Lose(order);
         c.ReportAs([&](State& s) {
           s.order_id = "o1";
           s.last_node_id = "A";
           for (std::size_t i = 1; i < order.nodes.size(); ++i) {
             s.node_states.push_back({order.nodes[i].id, order.nodes[i].sequence_id, {}, order.nodes[i].released, {}});
             s.edge_states.push_back(
                 {order.edges[i - 1].id, order.edges[i - 1].sequence_id, {}, order.edges[i - 1].released, {}});
           }
         });
       }},
      {Rule::kActionStatesKept,
       [](Conversation& c) {
         c.Instant("startCharging");
         c.ReportAs([](State& s) {
           s.action_states.clear();
           s.instant_action_states.clear();
         });
       }},
      {Rule::kActionStatusSequence,
       [](Conversation& c) {
         c.Send(WithPick(c.version(), BlockingType::kHard));
         c.Give(NodeReached{2});
         c.ReportAs([](State& s) { s.action_states[0].status = ActionStatus::kWaiting; });
       }},
      {Rule::kActionRunsAlone,
       [](Conversation& c) {
         c.Send(WithPick(c.version(), BlockingType::kHard));
         c.Give(NodeReached{2});
         c.ReportAs([](State& s) { s.action_states[1].status = ActionStatus::kRunning; });
       }},
      {Rule::kStandsForAction,
       [](Conversation& c) {
         c.Send(WithPick(c.version(), BlockingType::kSoft));
         c.Give(NodeReached{2});
         c.ReportAs([](State& s) { s.driving = true; });
       }},
      {Rule::kPauseStands,
       [](Conversation& c) {
         c.Instant(SampleActionOf("startPause", "i1", BlockingType::kNone), true);
         c.ReportAs([](State& s) {
           (s.instant_action_states.empty() && s.header.version[0] == '3' ? s.instant_action_states : s.action_states)
               .push_back({"i1", {}, {}, ActionStatus::kFinished, {}});
         });
       }},
      {Rule::kPauseEnds,
       [](Conversation& c) {
         c.Instant(SampleActionOf("stopPause", "i1", BlockingType::kNone), true);
         c.ReportAs([](State& s) {
           s.paused = true;
           (s.header.version[0] == '3' ? s.instant_action_states : s.action_states)
               .push_back({"i1", {}, {}, ActionStatus::kFinished, {}});
         });
       }},
      {Rule::kCancelClears,
       [](Conversation& c) {
         Start(c);
         c.Instant(SampleActionOf("cancelOrder", "i1", BlockingType::kNone), true);
         c.ReportAs([](State& s) {
           (s.header.version[0] == '3' ? s.instant_action_states : s.action_states)
               .push_back({"i1", {}, {}, ActionStatus::kFinished, {}});
         });
       }},
      {Rule::kCancelWithoutOrder,
       [](Conversation& c) {
         c.Instant(SampleActionOf("cancelOrder", "i1", BlockingType::kNone), true);
         c.ReportAs([](State& s) {
           (s.header.version[0] == '3' ? s.instant_action_states : s.action_states)
               .push_back({"i1", {}, {}, ActionStatus::kFailed, {}});
         });
       }},
      {Rule::kModeClearsOrder,
       [](Conversation& c) {
         Start(c);
         c.ReportAs([](State& s) { s.operating_mode = OperatingMode::kManual; });
       }},
      {Rule::kOneEnabledMap,
       [](Conversation& c) {
         c.ReportAs([](State& s) {
           s.maps = {{{"L1", "1", {}, StoredStatus::kEnabled}, {"L1", "2", {}, StoredStatus::kEnabled}}};
         });
       }},
  };
}

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
  Order order = WithPick(GetParam(), BlockingType::kHard);
  order.edges[1].actions = {SampleActionOf("blink", "e1", BlockingType::kNone)};
  c.Send(order);
  c.Send(order);  // again
  c.Give(DrivingChanged{true});
  c.Give(NodeReached{2});
  c.Give(DrivingChanged{false});
  c.Give(ActionProgress{"a1", ActionStatus::kRunning, {}, {}});
  c.Instant("startPause");
  c.Instant("stopPause");
  c.Give(ActionProgress{"a1", ActionStatus::kFinished, {}, {}});
  c.Give(ActionProgress{"a1b", ActionStatus::kFinished, {}, {}});
  // An update is lost, the next one begins at the same node.
  Order update = SampleOrder(GetParam(), "o1", 1, "CD", 2, 4);
  c.Lose(update);
  update.order_update_id = 2;
  c.Send(update);
  c.Give(DrivingChanged{true});
  c.Give(NodeReached{4});
  c.Wait(20'000);
  c.Report();
  c.Give(NodeReached{6});
  c.Give(DrivingChanged{false});
  c.SendPlaces("o2", 0, "DCB", 2);
  c.Give(DrivingChanged{true});
  c.Instant("cancelOrder");
  c.Give(DrivingChanged{false});
  c.Give(ModeChanged{OperatingMode::kManual});
  c.Give(ModeChanged{OperatingMode::kAutomatic});
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
