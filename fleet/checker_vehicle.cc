#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "fleet/checker_parts.h"
#include "fleet/message_names.h"

namespace troupe::fleet {
namespace {

bool IsActive(ActionStatus status) {
  return status == ActionStatus::kInitializing || status == ActionStatus::kRunning;
}

bool IsAutomatic(OperatingMode mode) {
  return mode == OperatingMode::kAutomatic || mode == OperatingMode::kSemiautomatic;
}

bool IsRejection(std::string_view type, Version version) {
  constexpr std::string_view kOlder[] = {"validationError", "orderError", "orderUpdateError", "noRouteError"};
  // MOBILE_ROBOT_NOT_AVAILABLE ends with the mode.
  constexpr std::string_view kNewer[] = {
      "VALIDATION_FAILURE",   "UNSUPPORTED_PARAMETER",         "INVALID_ORDER_ACTION", "OUTDATED_ORDER_UPDATE",
      "SAME_ORDER_UPDATE_ID", "ORDER_UPDATE_FOLLOWING_CANCEL", "INSUFFICIENT_MEMORY",  "NO_ROUTE_TO_TARGET",
      "OTHER_ORDER_ACTIVE",   "START_NODE_OUT_OF_RANGE",       "UNKNOWN_MAP_ID"};
  const std::span<const std::string_view> types =
      IsBefore3(version) ? std::span(kOlder) : std::span<const std::string_view>(kNewer);
  return std::find(types.begin(), types.end(), type) != types.end();
}

std::string PlaceText(std::string_view id, std::uint32_t sequence_id) {
  return "'" + std::string(id) + "' (" + std::to_string(sequence_id) + ")";
}

// The action states of a state by their ids; of several with one id the first.
class ActionIndex {
 public:
  explicit ActionIndex(const std::vector<ActionState>& states) {
    for (const ActionState& state : states) states_.try_emplace(state.action_id, &state);
  }
  const ActionState* Find(std::string_view id) const {
    const auto found = states_.find(id);
    return found != states_.end() ? found->second : nullptr;
  }

 private:
  std::map<std::string_view, const ActionState*> states_;
};
const std::vector<ActionState>& ZoneActionsOf(const State& state) {
  static const std::vector<ActionState> kNone;
  return state.zone_action_states ? *state.zone_action_states : kNone;
}

struct StateIndex {
  explicit StateIndex(const State& state)
      : actions(state.action_states), instant(state.instant_action_states), zones(ZoneActionsOf(state)) {}
  // Of an instant action: before 3.0 it is among the others.
  const ActionState* FindInstant(std::string_view id, Version version) const {
    return (IsBefore3(version) ? actions : instant).Find(id);
  }

  ActionIndex actions;
  ActionIndex instant;
  ActionIndex zones;
};

// Orders that are accepted.

bool Continues(const KnownRoute& route, const Order& order) {
  const Node& first = order.nodes.front();
  return route.is_known && route.order_id == order.order_id && route.end_node.id == first.id &&
         route.end_node.sequence_id == first.sequence_id;
}

void AddActions(KnownRoute& route, const std::vector<Action>& actions, bool is_released) {
  for (const Action& action : actions) (is_released ? route.actions : route.horizon_actions)[action.id] = action;
}

void ExtendRoute(KnownRoute& route, const Order& order) {
  const bool is_new = route.order_id != order.order_id || !route.is_known;
  if (is_new) {
    route = {};
    route.is_known = true;
    route.order_id = order.order_id;
  } else {
    route.nodes.erase(route.nodes.upper_bound(route.base_end), route.nodes.end());
    route.horizon_actions.clear();
  }
  route.order_update_id = order.order_update_id;
  for (std::size_t i = 0; i < order.nodes.size(); ++i) {
    const Node& node = order.nodes[i];
    if (i > 0) AddActions(route, order.edges[i - 1].actions, order.edges[i - 1].released);
    if (i == 0 && !is_new) continue;
    AddActions(route, node.actions, node.released);
    route.nodes[node.sequence_id] = {node.id, node.released};
    if (!node.released) continue;
    route.base_end = node.sequence_id;
    route.end_node = node;
  }
}

// The route with the sent order `i` accepted, and before it those without which it continues nothing.
void Accept(VehicleRecord& record, std::size_t i) {
  const Order order = record.sent[i].order;
  if (record.route.is_known && record.route.order_id == order.order_id && !Continues(record.route, order)) {
    for (std::size_t j = i; j > 0; --j) {
      const Order& before = record.sent[j - 1].order;
      if (before.order_id != order.order_id) continue;
      const auto end =
          std::find_if(before.nodes.rbegin(), before.nodes.rend(), [](const Node& node) { return node.released; });
      if (end->id != order.nodes.front().id || end->sequence_id != order.nodes.front().sequence_id) continue;
      Accept(record, j - 1);
      break;
    }
    // The vehicle has accepted an update that continues nothing that was sent: what its route is, is not known.
    if (!Continues(record.route, order)) {
      record.route.is_known = false;
      return;
    }
  } else if (!(record.route.is_known && record.route.order_id == order.order_id) && order.order_update_id != 0 &&
             record.state && record.state->order_id == order.order_id) {
    return;  // an update of an order that is older than the checker, or whose route is not known any more
  }
  ExtendRoute(record.route, order);
}

// Whether the state shows an order or update that the state before did not.
bool JudgeAcceptance(MessageJudge& judge, const State& state) {
  VehicleRecord& record = judge.record;
  const bool is_first = !record.state.has_value();
  const bool has_changed =
      !is_first && (record.state->order_id != state.order_id || record.state->order_update_id != state.order_update_id);
  if (!is_first && !has_changed) return false;
  for (std::size_t i = record.sent.size(); i > 0; --i) {
    const Order& order = record.sent[i - 1].order;
    if (order.order_id != state.order_id || order.order_update_id != state.order_update_id) continue;
    Accept(record, i - 1);
    record.sent.erase(record.sent.begin(), record.sent.begin() + static_cast<std::ptrdiff_t>(i));
    record.cancelled_order_id.clear();
    return true;
  }
  if (is_first) return false;
  record.route.is_known = false;
  if (record.state->order_id == state.order_id && state.order_update_id < record.state->order_update_id) {
    judge.Break(Rule::kUpdateIdKept, "orderUpdateId " + std::to_string(state.order_update_id),
                "at least " + std::to_string(record.state->order_update_id));
  } else {
    judge.Break(Rule::kOrderWasSent,
                "the order '" + state.order_id + "' with orderUpdateId " + std::to_string(state.order_update_id));
  }
  return true;
}

// What a state says of itself.

void JudgeSequence(MessageJudge& judge, const State& state) {
  const std::vector<NodeState>& nodes = state.node_states;
  const std::vector<EdgeState>& edges = state.edge_states;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    if (nodes[i].sequence_id <= nodes[i - 1].sequence_id) {
      return judge.Break(Rule::kStateSequence, "node " + PlaceText(nodes[i].node_id, nodes[i].sequence_id) +
                                                   " behind " +
                                                   PlaceText(nodes[i - 1].node_id, nodes[i - 1].sequence_id));
    }
    if (nodes[i].released && !nodes[i - 1].released) {
      return judge.Break(
          Rule::kStateSequence,
          "the released node " + PlaceText(nodes[i].node_id, nodes[i].sequence_id) + " behind an unreleased one");
    }
  }
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (edges[i].sequence_id <= edges[i - 1].sequence_id || (edges[i].released && !edges[i - 1].released)) {
      return judge.Break(Rule::kStateSequence, "edge " + PlaceText(edges[i].edge_id, edges[i].sequence_id) +
                                                   " behind " +
                                                   PlaceText(edges[i - 1].edge_id, edges[i - 1].sequence_id));
    }
  }
  // Some vehicles list the first node until they have reached it.
  if (edges.size() != nodes.size() && edges.size() + 1 != nodes.size()) {
    judge.Break(Rule::kStateSequence,
                std::to_string(nodes.size()) + " nodes and " + std::to_string(edges.size()) + " edges",
                "an edge to each node");
  }
}

void JudgeMaps(MessageJudge& judge, const State& state) {
  if (!state.maps) return;
  std::set<std::string_view> enabled;
  for (const MapState& map : *state.maps) {
    if (map.status != StoredStatus::kEnabled) continue;
    const bool is_first = enabled.insert(map.map_id).second;
    if (!is_first) judge.Break(Rule::kOneEnabledMap, "two enabled versions of '" + map.map_id + "'");
  }
}

// The state has the zone set, or an error about it.
bool Answers(const State& state, const std::string& zone_set_id) {
  const std::vector<ZoneSetState> sets = state.zone_sets.value_or(std::vector<ZoneSetState>());
  const Reference reference = {"zoneSetId", zone_set_id};
  return std::any_of(sets.begin(), sets.end(), [&](const auto& set) { return set.zone_set_id == zone_set_id; }) ||
         std::any_of(state.errors.begin(), state.errors.end(), [&](const VehicleError& error) {
           return error.references &&
                  std::find(error.references->begin(), error.references->end(), reference) != error.references->end();
         });
}

void JudgeZones(MessageJudge& judge, const State& state) {
  VehicleRecord& record = judge.record;
  std::set<std::string> maps;
  std::set<std::string> enabled;
  for (const ZoneSetState& set : state.zone_sets.value_or(std::vector<ZoneSetState>())) {
    if (set.status != StoredStatus::kEnabled) continue;
    enabled.insert(set.zone_set_id);
    const bool is_first = maps.insert(set.map_id).second;
    if (!is_first) judge.Break(Rule::kOneEnabledZoneSet, "two enabled zone sets of the map '" + set.map_id + "'");
  }
  for (auto& sent : record.zone_sets) sent.second.is_answered = sent.second.is_answered || Answers(state, sent.first);
  for (const ZoneRequest& request : state.zone_requests.value_or(std::vector<ZoneRequest>())) {
    if (enabled.contains(request.zone_set_id)) continue;
    judge.Break(Rule::kRequestsOfEnabledSets,
                "the request '" + request.id + "' for a zone of '" + request.zone_set_id + "', which is not ENABLED");
  }
  if (!record.factsheet || !record.factsheet->type.supported_zones || state.zone_action_states) return;
  const std::vector<std::string>& zones = *record.factsheet->type.supported_zones;
  if (std::find(zones.begin(), zones.end(), NameOf(ZoneType::kAction)) == zones.end()) return;
  judge.Break(Rule::kZoneActionsReported, "no zoneActionStates");
}

void JudgeMode(MessageJudge& judge, const State& state) {
  const OperatingMode mode = state.operating_mode;
  const bool clears = mode == OperatingMode::kManual ||
                      (judge.is_3() && (mode == OperatingMode::kService || mode == OperatingMode::kTeachIn));
  if (clears && (!state.node_states.empty() || !state.edge_states.empty())) {
    judge.Break(Rule::kModeClearsOrder,
                std::to_string(state.node_states.size()) + " nodes in the mode " + TextOf(mode, judge.version));
  }
  if (mode != OperatingMode::kAutomatic && mode != OperatingMode::kSemiautomatic &&
      mode != OperatingMode::kIntervened) {
    judge.record.cancelled_order_id = state.order_id;
  }
}

// The way along the order.

void JudgeRoute(MessageJudge& judge, const State& state) {
  const VehicleRecord& record = judge.record;
  const KnownRoute& route = record.route;
  if (!route.is_known || route.order_id != state.order_id || route.order_update_id != state.order_update_id) return;
  for (const NodeState& node : state.node_states) {
    const auto known = route.nodes.find(node.sequence_id);
    if (known == route.nodes.end() || known->second.id != node.node_id) {
      judge.Break(Rule::kNodesOfOrder, "node " + PlaceText(node.node_id, node.sequence_id));
    } else if (node.released && !known->second.is_released) {
      judge.Break(Rule::kReleasedByFleet, "the released node " + PlaceText(node.node_id, node.sequence_id));
    }
  }
  const auto last = route.nodes.find(state.last_node_sequence_id);
  if (last == route.nodes.end() || last->second.id != state.last_node_id) return;
  if (!last->second.is_released) {
    judge.Break(
        Rule::kOnlyBaseTraversed,
        "the unreleased node " + PlaceText(state.last_node_id, state.last_node_sequence_id) + " as the last one");
  }
  if (record.cancelled_order_id == state.order_id) return;
  std::set<std::uint32_t> ahead;
  for (const NodeState& node : state.node_states) ahead.insert(node.sequence_id);
  for (auto node = std::next(last); node != route.nodes.end(); ++node) {
    if (ahead.contains(node->first)) continue;
    judge.Break(Rule::kHorizonComplete, "no node " + PlaceText(node->second.id, node->first));
  }
}

void JudgeTraversal(MessageJudge& judge, const State& state, bool has_new_order) {
  const KnownRoute& route = judge.record.route;
  const auto last = route.nodes.find(state.last_node_sequence_id);
  const bool is_on_route = route.is_known && route.order_id == state.order_id && last != route.nodes.end() &&
                           last->second.id == state.last_node_id;
  for (const NodeState& node : state.node_states) {
    if (is_on_route && node.sequence_id <= state.last_node_sequence_id) {
      judge.Break(Rule::kTraversalInSequence, "node " + PlaceText(node.node_id, node.sequence_id) +
                                                  " still ahead, behind " +
                                                  PlaceText(state.last_node_id, state.last_node_sequence_id));
    }
  }
  const std::optional<State>& before = judge.record.state;
  if (!before || before->order_id != state.order_id || has_new_order) return;
  const bool is_same =
      before->last_node_id == state.last_node_id && before->last_node_sequence_id == state.last_node_sequence_id;
  // A position that is set changes it, while there is no order.
  if (is_same || before->node_states.empty()) return;
  const auto passed = std::find_if(before->node_states.begin(), before->node_states.end(), [&](const NodeState& node) {
    return node.sequence_id == state.last_node_sequence_id && node.node_id == state.last_node_id;
  });
  if (passed == before->node_states.end()) {
    if (state.node_states.empty()) return;  // cleared, and set since
    judge.Break(Rule::kTraversalInSequence,
                "the last node " + PlaceText(state.last_node_id, state.last_node_sequence_id),
                "one of the nodes ahead");
  } else if (!passed->released) {
    judge.Break(
        Rule::kOnlyBaseTraversed,
        "the unreleased node " + PlaceText(state.last_node_id, state.last_node_sequence_id) + " as the last one");
  }
}

// Actions.

void JudgeActionStates(MessageJudge& judge, const State& state, const StateIndex& index, bool has_new_order) {
  const VehicleRecord& record = judge.record;
  const KnownRoute& route = record.route;
  if (route.is_known && route.order_id == state.order_id && route.order_update_id == state.order_update_id) {
    for (const auto* const actions : {&route.actions, &route.horizon_actions}) {
      for (const auto& [id, action] : *actions) {
        if (index.actions.Find(id) == nullptr) {
          judge.Break(Rule::kActionStatesComplete, "no state of the action '" + id + "'");
        }
      }
    }
  }
  if (!record.state) return;
  const State& before = *record.state;
  const bool is_same_order = before.order_id == state.order_id;
  for (const auto member : {&State::action_states, &State::instant_action_states}) {
    const ActionIndex& states = member == &State::action_states ? index.actions : index.instant;
    for (const ActionState& was : before.*member) {
      if (IsAmbiguous(was.action_id, record)) continue;
      const ActionState* const now = states.Find(was.action_id);
      if (now == nullptr) {
        // Finished instant actions may be removed: in 3.0 when asked for, before when an order is accepted.
        const bool is_instant = member == &State::instant_action_states || IsInstant(was.action_id, record);
        const bool may_go = is_instant ? IsFinal(was.status) && (judge.is_3() || !is_same_order)
                                       : !is_same_order || (was.status == ActionStatus::kWaiting && has_new_order);
        if (!may_go) judge.Break(Rule::kActionStatesKept, "no state of the action '" + was.action_id + "' any more");
        continue;
      }
      // An instant action that was sent again, once its state was cleared.
      const bool is_again = std::any_of(
          record.instant_actions.begin(), record.instant_actions.end(),
          [&](const auto& sent) { return sent.action.id == was.action_id && sent.message > record.state_message; });
      if (is_again) continue;
      const bool is_broken = (IsFinal(was.status) && now->status != was.status) ||
                             (now->status == ActionStatus::kWaiting && was.status != ActionStatus::kWaiting);
      if (is_broken && (is_same_order || IsInstant(was.action_id, record))) {
        judge.Break(Rule::kActionStatusSequence,
                    "the action '" + was.action_id + "' " + NameOf(now->status) + " after " + NameOf(was.status));
      }
    }
  }
  // Those of zones have no order. They may be cleared when they have ended.
  for (const ActionState& was : ZoneActionsOf(before)) {
    const ActionState* const now = index.zones.Find(was.action_id);
    if (now == nullptr && !IsFinal(was.status)) {
      judge.Break(Rule::kActionStatesKept, "no state of the zone's action '" + was.action_id + "' any more");
    } else if (now != nullptr && ((IsFinal(was.status) && now->status != was.status) ||
                                  (now->status == ActionStatus::kWaiting && was.status != ActionStatus::kWaiting))) {
      judge.Break(Rule::kActionStatusSequence,
                  "the zone's action '" + was.action_id + "' " + NameOf(now->status) + " after " + NameOf(was.status));
    }
  }
}

void JudgeBlocking(MessageJudge& judge, const State& state) {
  const KnownRoute& route = judge.record.route;
  if (!route.is_known || route.order_id != state.order_id) return;
  std::vector<const Action*> active;
  for (const ActionState& each : state.action_states) {
    const auto known = route.actions.find(each.action_id);
    const bool is_active = known != route.actions.end() && IsActive(each.status);
    if (is_active && !IsAmbiguous(each.action_id, judge.record)) active.push_back(&known->second);
  }
  const bool is_automatic = IsAutomatic(state.operating_mode);
  const std::vector<ActionState>& of_zones = ZoneActionsOf(state);
  const auto active_of_zones = static_cast<std::size_t>(
      std::count_if(of_zones.begin(), of_zones.end(), [](const ActionState& each) { return IsActive(each.status); }));
  for (const Action* const action : active) {
    const std::size_t others = active.size() - 1 + active_of_zones;
    if (RunsAlone(action->blocking_type) && others > 0) {
      judge.Break(Rule::kActionRunsAlone, "'" + action->id + "' with " + std::to_string(others) + " others");
    }
    if (StopsDriving(action->blocking_type) && state.driving && is_automatic) {
      judge.Break(Rule::kStandsForAction, "driving while '" + action->id + "' runs");
    }
  }
}

// What the end of an instant action says about the vehicle.

bool IsExplained(const State& state, const std::string& action_id) {
  return std::any_of(state.errors.begin(), state.errors.end(), [&](const VehicleError& error) {
    return error.references &&
           std::any_of(error.references->begin(), error.references->end(), [&](const Reference& reference) {
             return reference.key == "actionId" && reference.value == action_id;
           });
  });
}

void JudgeCancel(MessageJudge& judge, const State& state, const Action& action) {
  const bool is_unfinished = HasUnfinishedActions(state, judge.record);
  // A person who has taken the vehicle over moves it.
  const bool drives = state.driving && IsAutomatic(state.operating_mode);
  if (!state.node_states.empty() || !state.edge_states.empty() || is_unfinished || drives) {
    judge.Break(Rule::kCancelClears, "'" + action.id + "' FINISHED with " + std::to_string(state.node_states.size()) +
                                         " nodes, " + std::to_string(state.edge_states.size()) + " edges" +
                                         (is_unfinished ? ", unfinished actions" : "") + (drives ? ", driving" : ""));
  }
}

void JudgeInstantEnds(MessageJudge& judge, const State& state, const StateIndex& index, bool has_new_order) {
  VehicleRecord& record = judge.record;
  const Version version = judge.version;
  const std::optional<StateIndex> index_before = record.state ? std::optional<StateIndex>(*record.state) : std::nullopt;
  const Action* newest_pause = nullptr;
  for (const VehicleRecord::SentInstantAction& sent : record.instant_actions) {
    if (sent.action.type == "startPause" || sent.action.type == "stopPause") newest_pause = &sent.action;
  }
  for (VehicleRecord::SentInstantAction& sent : record.instant_actions) {
    const ActionState* const now = index.FindInstant(sent.action.id, version);
    if (now == nullptr) continue;
    sent.is_reported = true;
    if (IsAmbiguous(sent.action.id, record)) {
      if (sent.action.type == "cancelOrder") record.route.is_known = false;
      continue;
    }
    const ActionState* const before = index_before ? index_before->FindInstant(sent.action.id, version) : nullptr;
    const bool is_new = before == nullptr || before->status != now->status;
    const std::string& type = sent.action.type;
    if (type == "cancelOrder" && !IsFinal(now->status)) record.cancelled_order_id = state.order_id;
    if (!is_new || !IsFinal(now->status)) continue;
    const bool is_finished = now->status == ActionStatus::kFinished;
    if (type == "cancelOrder" && is_finished && !has_new_order) {
      record.cancelled_order_id = state.order_id;
      JudgeCancel(judge, state, sent.action);
    } else if (type == "cancelOrder" && !is_finished && !has_new_order && !IsExplained(state, sent.action.id)) {
      judge.Break(Rule::kCancelWithoutOrder, "'" + sent.action.id + "' FAILED without such an error");
    } else if (is_finished && &sent.action == newest_pause && state.paused) {
      if (type == "startPause" && (!*state.paused || state.driving)) {
        judge.Break(Rule::kPauseStands, *state.paused ? "driving" : "paused false");
      } else if (type == "stopPause" && *state.paused) {
        judge.Break(Rule::kPauseEnds, "paused true");
      }
    }
  }
}

// Rejections.

void JudgeRejections(MessageJudge& judge, const State& state, bool has_new_order) {
  const Version version = judge.version;
  for (VehicleRecord::SentOrder& sent : judge.record.sent) {
    const auto names_order = [&](const VehicleError& error) {
      if (!IsRejection(error.type, version) && error.type != "MOBILE_ROBOT_NOT_AVAILABLE") return false;
      return !error.references ||
             std::any_of(error.references->begin(), error.references->end(), [&](const Reference& each) {
               return each.key == "orderId" && each.value == sent.order.order_id;
             });
    };
    sent.is_answered = sent.is_answered || std::any_of(state.errors.begin(), state.errors.end(), names_order);
  }
  if (!judge.record.state || has_new_order) return;
  std::set<std::string_view> types;
  for (const VehicleError& error : state.errors) types.insert(error.type);
  for (const VehicleError& was : judge.record.state->errors) {
    if (IsRejection(was.type, version) && !types.contains(was.type))
      judge.Break(Rule::kRejectionKept, "no error '" + was.type + "' any more, and no order accepted since");
  }
}

}  // namespace

bool IsInstant(const std::string& action_id, const VehicleRecord& record) {
  const auto found = record.action_uses.find(action_id);
  return found != record.action_uses.end() && found->second.place.starts_with(kInstantPlace);
}

bool IsAmbiguous(const std::string& action_id, const VehicleRecord& record) {
  const auto found = record.action_uses.find(action_id);
  return found != record.action_uses.end() && found->second.is_ambiguous;
}

bool HasUnfinishedActions(const State& state, const VehicleRecord& record) {
  return std::any_of(state.action_states.begin(), state.action_states.end(), [&](const ActionState& each) {
    return !IsFinal(each.status) && !IsInstant(each.action_id, record) && !IsAmbiguous(each.action_id, record);
  });
}

bool IsBusy(const State& state, const VehicleRecord& record) {
  return !state.node_states.empty() || !state.edge_states.empty() || HasUnfinishedActions(state, record);
}

void JudgeState(MessageJudge& judge, const State& state) {
  VehicleRecord& record = judge.record;
  if (record.connection && *record.connection != ConnectionState::kOnline) {
    judge.Break(Rule::kOnlineBeforeState,
                "a state while the connection is " + TextOf(*record.connection, judge.version));
  }
  const StateIndex index(state);
  const bool has_new_order = JudgeAcceptance(judge, state);
  JudgeSequence(judge, state);
  JudgeMaps(judge, state);
  JudgeZones(judge, state);
  JudgeMode(judge, state);
  JudgeInstantEnds(judge, state, index, has_new_order);
  JudgeRoute(judge, state);
  JudgeTraversal(judge, state, has_new_order);
  JudgeActionStates(judge, state, index, has_new_order);
  JudgeBlocking(judge, state);
  JudgeRejections(judge, state, has_new_order);
  record.state = state;
  record.state_milliseconds = judge.milliseconds;
  record.state_message = judge.message;
  record.is_overdue = false;
  // What is answered is done with.
  std::erase_if(record.instant_actions, [&](const VehicleRecord::SentInstantAction& sent) {
    const ActionState* const now = index.FindInstant(sent.action.id, judge.version);
    return sent.is_reported && (now == nullptr || IsFinal(now->status));
  });
}

void JudgeTime(MessageJudge& judge) {
  VehicleRecord& record = judge.record;
  if (!record.state || (record.connection && *record.connection != ConnectionState::kOnline)) return;
  const std::int64_t late = judge.milliseconds - judge.options.answer_milliseconds;
  for (VehicleRecord::SentOrder& sent : record.sent) {
    if (sent.is_answered || sent.milliseconds >= late) continue;
    sent.is_answered = true;
    judge.BreakAt(Rule::kOrderAnswered, sent.message,
                  "no state that accepts or rejects the order '" + sent.order.order_id + "', orderUpdateId " +
                      std::to_string(sent.order.order_update_id));
  }
  for (VehicleRecord::SentInstantAction& sent : record.instant_actions) {
    if (sent.is_reported || sent.milliseconds >= late) continue;
    sent.is_reported = true;
    judge.BreakAt(Rule::kInstantActionReported, sent.message, "no state of the action '" + sent.action.id + "'");
  }
  for (auto& [id, sent] : record.zone_sets) {
    if (sent.is_answered || sent.milliseconds >= late) continue;
    sent.is_answered = true;
    judge.BreakAt(Rule::kZoneSetAnswered, sent.message, "no state that stores or refuses the zone set '" + id + "'");
  }
  const std::int64_t longest = 30'000 + judge.options.tolerance_milliseconds;
  if (record.is_overdue || judge.milliseconds - record.state_milliseconds <= longest) return;
  record.is_overdue = true;
  judge.BreakAt(Rule::kStateInterval, record.state_message,
                "no state for " + std::to_string(judge.milliseconds - record.state_milliseconds) + " ms");
}

}  // namespace troupe::fleet
