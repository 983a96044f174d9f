// Writes random sequences of messages between a fleet control and a vehicle of VDA 5050, with what the vehicle and the
// checker make of them, for a reference that judges them by itself (reference.py):
//   fleet_sequences FIRST COUNT
// A line for each sequence, then one for each input with the state behind it. Wrong and hostile messages are among
// them.
//   fleet_sequences --messages FIRST COUNT
// Messages for the public schemas (schemas_test.py), those of the vehicle in the sequences among them: a line for each
// with topic, version and text.
//   fleet_sequences --conversations
// A line for each version and rule: {"version", "rule", "broken": whether the version has the rule, "log": lines of a
// log (message_log.h)}, and one without a rule, of a conversation that breaks none.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fleet/checker.h"
#include "fleet/codec.h"
#include "fleet/message_names.h"
#include "fleet/vehicle.h"
#include "tests/unit/fleet/conversation.h"
#include "tests/unit/fleet/fleet_samples.h"
#include "tests/unit/fleet/full_messages.h"
#include "troupe/random.h"

namespace troupe::fleet {
namespace {

using nlohmann::json;

class Sequence {
 public:
  Sequence(std::uint64_t seed, Version version, bool writes_messages)
      : seed_(seed), writes_messages_(writes_messages), profile_(SampleProfile(version)) {
    profile_.stops_between_nodes = Draw(4) != 0;
    options_.version = version;
    memory_.maps = {{"L1", "1", {}, StoredStatus::kEnabled}, {"L1", "2", {}, StoredStatus::kDisabled}};
    readings_ = SampleReadings();
    Write(json{{"seed", seed}, {"version", NameOf(version)}, {"stops", profile_.stops_between_nodes}});
    Observe(Topic::kConnection, Encode(Connection{SampleHeader(version), ConnectionState::kOnline}, version));
    Observe(Topic::kFactsheet, Encode(profile_.factsheet, version));
    SendState();
  }

  void Run() {
    const std::uint64_t steps = 10 + Draw(40);
    for (std::uint64_t i = 0; i < steps; ++i) {
      milliseconds_ += 100;
      Step();
    }
  }

 private:
  std::uint64_t Draw(std::uint64_t below) { return RandomBits({seed_, 0x5da50, ++draws_}) % below; }
  bool Chance(std::uint64_t percent) { return Draw(100) < percent; }

  void Step() {
    const Version version = profile_.version;
    const bool may_drive = MayDrive(memory_, profile_);
    if (memory_.is_driving && !may_drive && Chance(70)) return Drive(false);
    const std::uint64_t choice = Draw(100);
    if (choice < 25) {
      SendOrder();
    } else if (choice < 38) {
      SendInstantActions();
    } else if (choice < 60) {
      if (!may_drive) return Drive(false);
      if (!memory_.is_driving) return Drive(true);
      const Node& next = memory_.nodes.front();
      readings_.position->x = next.position->x;
      Do(NodeReached{next.sequence_id}, {{"kind", "node"}, {"sequence", next.sequence_id}, {"x", next.position->x}});
    } else if (choice < 88) {
      Progress();
    } else if (choice < 91) {
      const OperatingMode mode = static_cast<OperatingMode>(Chance(60) ? 0 : Draw(7));
      Do(ModeChanged{mode}, {{"kind", "mode"}, {"mode", NameOf(mode)}});
    } else if (choice < 93) {
      const bool is_paused = Chance(40);
      Do(PauseChanged{is_paused}, {{"kind", "pause"}, {"paused", is_paused}});
    } else if (choice < 95) {
      VehicleError error;
      error.type = "test";
      error.level = static_cast<ErrorLevel>(Draw(4));
      if (Chance(50)) return Do(ErrorCleared{"test"}, {{"kind", "clear"}});
      Do(ErrorRaised{error}, {{"kind", "error"}, {"level", NameOf(error.level)}});
    } else if (choice < 97) {
      // A node that is not next, an action that is not there.
      if (Chance(50)) return Do(NodeReached{77}, {{"kind", "node"}, {"sequence", 77}, {"x", readings_.position->x}});
      Do(ActionProgress{"no such action", ActionStatus::kFinished, {}, {}},
         {{"kind", "progress"}, {"action", "no such action"}, {"status", "FINISHED"}});
    } else {
      RestoreItself();
      SendHostile(version);
    }
  }

  void Drive(bool is_driving) { Do(DrivingChanged{is_driving}, {{"kind", "drive"}, {"driving", is_driving}}); }

  void Progress() {
    std::vector<const TrackedAction*> started;
    for (const auto* const list : {&memory_.actions, &memory_.instant_actions}) {
      for (const TrackedAction& tracked : *list) {
        if (IsStarted(tracked.status)) started.push_back(&tracked);
      }
    }
    if (started.empty()) return Drive(memory_.is_driving && MayDrive(memory_, profile_));
    constexpr ActionStatus kStatuses[] = {ActionStatus::kRunning, ActionStatus::kFinished, ActionStatus::kFinished,
                                          ActionStatus::kFailed,  ActionStatus::kPaused,   ActionStatus::kInitializing};
    const std::string id = started[Draw(started.size())]->action.id;
    const ActionStatus status = kStatuses[Draw(std::size(kStatuses))];
    ActionProgress progress = {id, status, {}, {}};
    bool has_error = false;
    if (status == ActionStatus::kFailed && Chance(30)) {
      progress.error.emplace();
      progress.error->type = "broken";
      progress.error->level = ErrorLevel::kCritical;
      has_error = true;
    }
    Do(progress, {{"kind", "progress"}, {"action", id}, {"status", NameOf(status)}, {"error", has_error}});
  }

  std::vector<Action> RandomActions(bool is_edge) {
    std::vector<Action> actions;
    if (!Chance(40)) return actions;
    const std::uint64_t count = 1 + Draw(3);
    for (std::uint64_t i = 0; i < count; ++i) {
      constexpr const char* kTypes[] = {"pick", "drop", "blink", "blink", "waitForTrigger", "enableMap", "unknown"};
      std::string type = kTypes[Draw(Chance(3) ? 7 : is_edge ? 4 : 6)];
      std::string id = "a" + std::to_string(++actions_);
      if (Chance(2)) id = "a" + std::to_string(1 + Draw(actions_));
      Action action = SampleActionOf(type, id, static_cast<BlockingType>(Draw(4)));
      if (IsBefore3(profile_.version) && action.blocking_type == BlockingType::kSingle) {
        action.blocking_type = BlockingType::kNone;
      }
      if (type == "enableMap") {
        action.parameters = {
            {{"mapId", ParameterValue::Of("L1")}, {"mapVersion", ParameterValue::Of(std::to_string(1 + Draw(3)))}}};
      }
      if (!IsBefore3(profile_.version) && Chance(40)) action.retriable = true;
      actions.push_back(action);
    }
    return actions;
  }

  Order RandomOrder(const std::string& id, std::uint32_t update_id, char first, std::uint32_t sequence_id) {
    std::string places(1, first);
    const std::uint64_t count = Draw(5);
    for (std::uint64_t i = 0; i < count; ++i) places += static_cast<char>('A' + Draw(6));
    Order order = SampleOrder(profile_.version, id, update_id, places, 1 + Draw(places.size()), sequence_id);
    for (std::size_t i = 0; i < order.nodes.size(); ++i) {
      order.nodes[i].actions = RandomActions(false);
      if (i > 0) order.edges[i - 1].actions = RandomActions(true);
    }
    return order;
  }

  void SendOrder() {
    const bool is_new = memory_.order_id.empty() || (IsBusy(memory_) ? Chance(15) : Chance(60));
    if (!last_order_.nodes.empty() && Chance(10)) {
      Order again = last_order_;
      if (Chance(30)) again.nodes.back().descriptor = "changed";
      return SendOrderOf(again);
    }
    Order order;
    if (is_new) {
      const char near = static_cast<char>('A' + static_cast<int>(readings_.position->x / 4.0 + 0.5));
      order = RandomOrder("o" + std::to_string(++orders_), Chance(90) ? 0 : 1 + static_cast<std::uint32_t>(Draw(3)),
                          Chance(85) ? near : static_cast<char>('A' + Draw(6)), Chance(95) ? 0 : 4);
    } else {
      std::string end = memory_.last_node_id.empty() ? "A" : memory_.last_node_id;
      std::uint32_t sequence_id = memory_.last_node_sequence_id;
      Node content;
      for (const Node& node : memory_.nodes) {
        if (!node.released) break;
        end = node.id;
        sequence_id = node.sequence_id;
      }
      if (Chance(10)) end = std::string(1, static_cast<char>('A' + Draw(6)));
      if (Chance(5)) sequence_id += 2;
      std::uint32_t update_id = memory_.order_update_id + 1;
      if (Chance(10)) update_id = static_cast<std::uint32_t>(Draw(memory_.order_update_id + 2));
      order = RandomOrder(memory_.order_id, update_id, end[0], sequence_id);
      if (!IsBefore3(profile_.version) || Chance(80)) order.nodes.front().actions.clear();
    }
    const std::uint64_t flaw = Draw(40);
    if (flaw == 0 && !order.edges.empty()) order.edges.pop_back();
    if (flaw == 1) order.nodes.back().sequence_id += 1;
    if (flaw == 2) order.nodes.front().released = false;
    if (flaw == 3 && order.nodes.size() > 2) {
      order.nodes[1].released = false;
      order.nodes[2].released = true;
    }
    if (flaw == 4) order.nodes.back().position->map_id = "L9";
    if (flaw == 5 && !order.edges.empty()) order.edges.back().orientation = 1.0;
    if (flaw == 6) order.order_id.clear();
    if (flaw == 7) order.nodes.clear();
    last_order_ = order;
    SendOrderOf(order);
  }

  void SendOrderOf(Order order) {
    order.header = SampleHeader(profile_.version, ++order_headers_, milliseconds_);
    std::string payload = Encode(order, profile_.version);
    if (Chance(5)) payload = Mutated(payload);
    DeliverOrder(payload);
  }

  void DeliverOrder(const std::string& payload) {
    Decoded<Order> decoded = Decode<Order>(payload, profile_.version);
    const std::vector<Verdict> verdicts = Observe(Topic::kOrder, payload);
    Do(OrderReceived{std::move(decoded.message), std::move(decoded.faults)}, {{"kind", "order"}, {"payload", payload}},
       verdicts);
  }

  void DeliverInstantActions(const std::string& payload) {
    Decoded<InstantActions> decoded = Decode<InstantActions>(payload, profile_.version);
    const std::vector<Verdict> verdicts = Observe(Topic::kInstantActions, payload);
    Do(InstantActionsReceived{std::move(decoded.message), std::move(decoded.faults)},
       {{"kind", "instant"}, {"payload", payload}}, verdicts);
  }

  void SendInstantActions() {
    constexpr const char* kTypes[] = {
        "startPause", "stopPause", "stopPause",   "cancelOrder",         "cancelOrder",   "stateRequest",
        "trigger",    "retry",     "skipRetry",   "clearInstantActions", "startCharging", "logReport",
        "enableMap",  "deleteMap", "downloadMap", "initPosition",        "doNotKnow",     "factsheetRequest"};
    InstantActions message;
    message.header = SampleHeader(profile_.version, ++instant_headers_, milliseconds_);
    const std::uint64_t count = 1 + (Chance(20) ? Draw(3) : 0);
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::string type = kTypes[Draw(std::size(kTypes))];
      std::string id = "i" + std::to_string(++actions_);
      if (Chance(4)) id = (Chance(50) ? "i" : "a") + std::to_string(1 + Draw(actions_));
      Action action = SampleActionOf(type, id, BlockingType::kNone);
      if (IsBefore3(profile_.version) && Chance(40))
        action.blocking_type = Chance(50) ? BlockingType::kHard : BlockingType::kSoft;
      if (type.ends_with("Map") && Chance(90)) {
        action.parameters = {{{"mapId", ParameterValue::Of(Chance(80) ? "L1" : "L2")},
                              {"mapVersion", ParameterValue::Of(std::to_string(1 + Draw(3)))}}};
      }
      if (type == "initPosition" && Chance(50)) {
        action.parameters = {{{"x", ParameterValue::Of("4.0")}, {"lastNodeId", ParameterValue::Of("B")}}};
      }
      if (type == "cancelOrder" && Chance(20)) {
        action.parameters = {{{"orderId", ParameterValue::Of(Chance(50) ? memory_.order_id : "other")}}};
      }
      if (type == "retry" || type == "skipRetry") {
        std::string failed = "none";
        for (const TrackedAction& tracked : memory_.actions) {
          if (tracked.status == ActionStatus::kRetriable || failed == "none") failed = tracked.action.id;
        }
        action.parameters = {{{"actionId", ParameterValue::Of(failed)}}};
      }
      message.actions.push_back(action);
    }
    std::string payload = Encode(message, profile_.version);
    if (Chance(5)) payload = Mutated(payload);
    DeliverInstantActions(payload);
  }

  // One value of a message is dropped, or becomes another one.
  std::string Mutated(const std::string& payload) {
    json message = json::parse(payload);
    json* at = &message;
    for (int depth = 0; depth < 6; ++depth) {
      if (!at->is_structured() || at->empty()) break;
      const std::uint64_t i = Draw(at->size());
      auto child = at->begin();
      std::advance(child, static_cast<std::ptrdiff_t>(i));
      const bool is_deep = child->is_structured() && !child->empty();
      if (is_deep && Chance(75)) {
        at = &*child;
        continue;
      }
      const std::uint64_t kind = Draw(6);
      if (kind == 0) {
        at->erase(child);
      } else if (kind == 1 && child->is_number()) {
        *child = child->dump();
      } else if (kind == 2) {
        *child = nullptr;
      } else if (kind == 3) {
        *child = json::array({1, "two"});
      } else if (kind == 4) {
        *child = -1.5;
      } else {
        *child = "text";
      }
      break;
    }
    return message.dump();
  }

  void SendHostile(Version version) {
    std::string payload;
    switch (Draw(6)) {
      case 0:
        payload = "";
        break;
      case 1:
        payload = std::string(2000, '[');
        break;
      case 2:
        payload = "{\"headerId\": NaN}";
        break;
      case 3:
        payload = "\xff\xfe\x80";
        break;
      case 4:
        payload = "[]";
        break;
      default:
        payload = Encode(SampleOrder(version, "h", 0, "AB", 2), version);
        payload.resize(Draw(payload.size()));
        break;
    }
    if (Chance(50)) {
      DeliverOrder(payload);
    } else {
      DeliverInstantActions(payload);
    }
  }

  // A vehicle that is saved and restored goes on in the same way.
  void RestoreItself() {
    Result<VehicleMemory> restored = RestoreMemory(SaveMemory(memory_));
    if (!restored.ok() || !(restored.value() == memory_)) {
      std::cerr << "seed " << seed_ << ": the restored memory differs\n" << SaveMemory(memory_) << '\n';
      std::exit(1);
    }
    memory_ = std::move(restored.value());
  }

  std::vector<Verdict> Observe(Topic topic, const std::string& payload) {
    return CheckMessage(checker_, {"Troupe", "anna", topic, milliseconds_, payload}, options_);
  }

  std::vector<Verdict> SendState() {
    State state = MakeState(memory_, profile_, readings_);
    if (has_sent_ && ReasonsToSend(last_state_, state).empty()) return {};
    has_sent_ = true;
    last_state_ = state;
    state.header = SampleHeader(profile_.version, ++state_headers_, milliseconds_);
    const std::string text = Encode(state, profile_.version);
    if (writes_messages_) std::cout << "state " << NameOf(profile_.version) << ' ' << text << '\n';
    return Observe(Topic::kState, text);
  }

  void Do(const VehicleInput& input, json line, const std::vector<Verdict>& fleet_verdicts = {}) {
    const VehicleOutcome outcome = Apply(memory_, input, profile_, readings_);
    const std::vector<Verdict> vehicle_verdicts = SendState();
    const State state = MakeState(memory_, profile_, readings_);
    json after;
    after["row"] = outcome.row != nullptr ? json(outcome.row->name) : json();
    after["order"] = {state.order_id, state.order_update_id};
    after["last"] = {state.last_node_id, state.last_node_sequence_id};
    after["nodes"] = json::array();
    for (const NodeState& node : state.node_states)
      after["nodes"].push_back({node.node_id, node.sequence_id, node.released});
    after["edges"] = json::array();
    for (const EdgeState& edge : state.edge_states)
      after["edges"].push_back({edge.edge_id, edge.sequence_id, edge.released});
    const auto actions = [](const std::vector<ActionState>& states) {
      json list = json::array();
      for (const ActionState& each : states) list.push_back({each.action_id, NameOf(each.status)});
      return list;
    };
    after["actions"] = actions(state.action_states);
    after["instant"] = actions(state.instant_action_states);
    after["mode"] = NameOf(state.operating_mode);
    after["paused"] = state.paused.value_or(false);
    after["driving"] = state.driving;
    after["may"] = MayDrive(memory_, profile_);
    after["errors"] = json::array();
    for (const VehicleError& error : state.errors) after["errors"].push_back(error.type);
    after["maps"] = json::array();
    if (state.maps) {
      for (const MapState& map : *state.maps) after["maps"].push_back({map.map_id, map.version, NameOf(map.status)});
    }
    after["verdicts"] = json::array();
    for (const Verdict& verdict : fleet_verdicts) after["verdicts"].push_back(NameOf(verdict.rule));
    // A vehicle that follows the rules breaks none.
    after["broken"] = json::array();
    for (const Verdict& verdict : vehicle_verdicts) after["broken"].push_back(verdict.ToString());
    line["after"] = std::move(after);
    Write(line);
  }

  void Write(const json& line) const {
    if (!writes_messages_) std::cout << line.dump(-1, ' ', false, json::error_handler_t::replace) << '\n';
  }

  const std::uint64_t seed_;
  const bool writes_messages_;
  VehicleProfile profile_;
  VehicleMemory memory_;
  VehicleReadings readings_;
  CheckerMemory checker_;
  CheckerOptions options_;
  State last_state_;
  bool has_sent_ = false;
  Order last_order_;
  std::int64_t milliseconds_ = 1'000;
  std::uint64_t draws_ = 0;
  std::uint64_t actions_ = 0;
  std::uint64_t orders_ = 0;
  std::uint32_t order_headers_ = 0;
  std::uint32_t instant_headers_ = 0;
  std::uint32_t state_headers_ = 0;
};

void WriteConversation(Version version, const RuleInfo* info, const Play& play) {
  Conversation conversation(version);
  play(conversation);
  json line = {{"version", NameOf(version)},
               {"rule", info != nullptr ? json(NameOf(info->rule)) : json()},
               {"broken", info != nullptr && info->IsIn(version)},
               {"log", json::array()}};
  for (const LoggedMessage& message : conversation.log()) line["log"].push_back(LogLine(message));
  std::cout << line.dump() << '\n';
}

void WriteConversations() {
  for (const Version version : {Version::k2_0, Version::k2_1, Version::k3_0}) {
    WriteConversation(version, nullptr, HoldGoodConversation);
    for (const auto& [rule, play] : BrokenRules()) WriteConversation(version, &InfoOf(rule), play);
  }
}

}  // namespace
}  // namespace troupe::fleet

int main(int argc, char** argv) {
  using namespace troupe::fleet;
  if (argc == 2 && std::string_view(argv[1]) == "--conversations") {
    WriteConversations();
    return 0;
  }
  const bool writes_messages = argc > 1 && std::string_view(argv[1]) == "--messages";
  const int first_argument = writes_messages ? 2 : 1;
  if (argc != first_argument + 2) return 2;
  const std::uint64_t first = std::strtoull(argv[first_argument], nullptr, 10);
  const std::uint64_t count = std::strtoull(argv[first_argument + 1], nullptr, 10);
  std::ios::sync_with_stdio(false);
  if (writes_messages) {
    for (const NamedPayload& payload : AllPayloads()) {
      std::cout << payload.topic << ' ' << troupe::NameOf(payload.version) << ' ' << payload.text << '\n';
    }
  }
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    Sequence(seed, static_cast<Version>(seed % 3), writes_messages).Run();
  }
  return 0;
}
