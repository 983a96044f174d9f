// Conversations of a fleet control and a vehicle that a checker sees: one that breaks no rule, and one for each rule.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fleet/checker.h"
#include "fleet/codec.h"
#include "fleet/message_log.h"
#include "fleet/vehicle.h"
#include "tests/unit/fleet/fleet_samples.h"

namespace troupe::fleet {

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
  // A set of one zone, which the vehicle does not get.
  void LoseZones(const std::string& id, ZoneType type) {
    if (IsBefore3(version_)) return;
    ZoneSet set = {SampleHeader(version_, ++zone_sets_, Now()), "L1", id, {}, {}};
    set.zones = {{.id = "zone", .type = type, .vertices = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}}};
    See(Topic::kZoneSet, Encode(set, version_));
  }
  // Another factsheet; the vehicle itself stays as it is.
  void AnnounceZones(const std::vector<std::string>& types) {
    Factsheet sheet = profile_.factsheet;
    if (!IsBefore3(version_)) sheet.type.supported_zones = types;
    ++sheet.header.header_id;
    See(Topic::kFactsheet, Encode(sheet, version_));
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
    const int major = major_version != 0 ? major_version : MajorOf(version_);
    log_.push_back({milliseconds_, TopicName{"uagv", major, "Troupe", "anna", topic}.ToString(), payload});
    Keep(CheckMessage(checker_, {"Troupe", "anna", topic, milliseconds_, payload, major_version}, options_));
    milliseconds_ += 100;
  }
  void Wait(std::int64_t milliseconds) {
    milliseconds_ += milliseconds;
    // In a log time goes by with the messages of others.
    Connection other{SampleHeader(version_), ConnectionState::kOnline};
    other.header.serial_number = "bela";
    log_.push_back({milliseconds_,
                    TopicName{"uagv", MajorOf(version_), "Troupe", "bela", Topic::kConnection}.ToString(),
                    Encode(other, version_)});
    Keep(CheckTime(checker_, milliseconds_, options_));
  }

  std::set<std::string> Broken() const {
    std::set<std::string> rules;
    for (const Verdict& verdict : verdicts_) rules.insert(NameOf(verdict.rule));
    return rules;
  }
  const std::vector<Verdict>& verdicts() const { return verdicts_; }
  const std::vector<LoggedMessage>& log() const { return log_; }  // all messages that the checker has seen
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
  std::vector<LoggedMessage> log_;
  std::int64_t milliseconds_ = 1'000;
  std::uint32_t orders_ = 0;
  std::uint32_t instants_ = 0;
  std::uint32_t zone_sets_ = 0;
  std::uint32_t states_ = 0;
};

using Play = std::function<void(Conversation&)>;

inline Order WithPick(Version version, BlockingType type, const std::string& id = "a1") {
  Order order = SampleOrder(version, "o1", 0, "ABCD", 3);
  order.nodes[1].actions = {SampleActionOf("pick", id, type), SampleActionOf("blink", id + "b", BlockingType::kNone)};
  return order;
}

inline void Start(Conversation& c) {
  c.SendPlaces("o1", 0, "ABCD", 3);
}

// For each rule a sequence that breaks it, and nothing else but what follows from it.
inline std::vector<std::pair<Rule, Play>> BrokenRules() {
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
      {Rule::kZoneSetUnchanged,
       [](Conversation& c) {
         c.LoseZones("z1", ZoneType::kBlocked);
         c.LoseZones("z1", ZoneType::kLineGuided);
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
      {Rule::kZoneSetAnswered,
       [](Conversation& c) {
         c.LoseZones("z1", ZoneType::kBlocked);
         c.Wait(10'000);
       }},
      {Rule::kOneEnabledZoneSet,
       [](Conversation& c) {
         c.ReportAs([](State& s) {
           s.zone_sets = {{{"z1", "L1", StoredStatus::kEnabled}, {"z2", "L1", StoredStatus::kEnabled}}};
         });
       }},
      {Rule::kRequestsOfEnabledSets,
       [](Conversation& c) {
         c.ReportAs([](State& s) {
           s.zone_sets = {{{"z1", "L1", StoredStatus::kDisabled}}};
           s.zone_requests = {{{"r1", ZoneRequestType::kAccess, "zone", "z1", RequestStatus::kRequested, {}}}};
         });
       }},
      {Rule::kZoneActionsReported,
       [](Conversation& c) {
         c.AnnounceZones({"ACTION"});
         c.Report();
       }},
  };
}

inline void HoldGoodConversation(Conversation& c) {
  Order order = WithPick(c.version(), BlockingType::kHard);
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
  Order update = SampleOrder(c.version(), "o1", 1, "CD", 2, 4);
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
}

}  // namespace troupe::fleet
