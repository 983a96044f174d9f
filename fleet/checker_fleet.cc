#include <algorithm>

#include "fleet/checker_parts.h"
#include "fleet/message_names.h"
#include "fleet/order_check.h"

namespace troupe::fleet {
namespace {

constexpr std::size_t kMostSent = 64;  // orders and instant actions that are remembered for a vehicle
constexpr std::size_t kMostActionIds = 20'000;
constexpr std::size_t kMostOrders = 10'000;
constexpr std::size_t kMostSentZoneSets = 1'000;

bool IsModeForOrders(OperatingMode mode) {
  return mode == OperatingMode::kAutomatic || mode == OperatingMode::kSemiautomatic ||
         mode == OperatingMode::kIntervened;
}

const Node& BaseEnd(const Order& order) {
  const auto last =
      std::find_if(order.nodes.rbegin(), order.nodes.rend(), [](const Node& node) { return node.released; });
  return *last;
}

std::string NameOfNode(const Node& node) {
  return "node '" + node.id + "' (" + std::to_string(node.sequence_id) + ")";
}

// An id names one action: of one order, or an instant action.
void JudgeActionId(MessageJudge& judge, const Action& action, const std::string& place) {
  std::map<std::string, VehicleRecord::ActionUse>& uses = judge.record.action_uses;
  if (uses.size() >= kMostActionIds) uses.clear();
  const auto [known, is_new] = uses.try_emplace(action.id, VehicleRecord::ActionUse{place});
  VehicleRecord::ActionUse& use = known->second;
  if (is_new || use.place == place) return;
  const bool is_in_both = use.place.starts_with(kInstantPlace) != place.starts_with(kInstantPlace);
  if (is_in_both && !judge.is_3()) use.is_ambiguous = true;
  judge.Break(Rule::kActionIdsUnique,
              "the actionId '" + action.id + "' of " + place + ", which was used by " + use.place, "an id of its own");
}

void JudgeUpdate(MessageJudge& judge, const Order& order) {
  const VehicleRecord& record = judge.record;
  std::vector<const Node*> ends;
  const std::uint32_t newest = record.update_ids.at(order.order_id);
  const Order* newest_order = nullptr;
  if (record.route.is_known && record.route.order_id == order.order_id) ends.push_back(&record.route.end_node);
  for (const VehicleRecord::SentOrder& sent : record.sent) {
    if (sent.order.order_id != order.order_id) continue;
    ends.push_back(&BaseEnd(sent.order));
    if (sent.order.order_update_id == newest) newest_order = &sent.order;
  }
  if (order.order_update_id < newest) {
    return judge.Break(Rule::kUpdateIdGrows, "orderUpdateId " + std::to_string(order.order_update_id),
                       "at least " + std::to_string(newest));
  }
  if (order.order_update_id == newest) {
    if (newest_order != nullptr && !HaveSameContent(*newest_order, order)) {
      judge.Break(Rule::kResendUnchanged, "other content with orderUpdateId " + std::to_string(newest));
    }
    return;
  }
  if (record.cancelled_order_id == order.order_id) {
    judge.Break(Rule::kNoUpdateAfterCancel, "an update of the order '" + order.order_id + "', which is cancelled");
  }
  if (ends.empty()) return;  // its base is not known
  const Node& first = order.nodes.front();
  const auto end = std::find_if(ends.begin(), ends.end(), [&](const Node* node) {
    return node->id == first.id && node->sequence_id == first.sequence_id;
  });
  if (end == ends.end()) {
    judge.Break(Rule::kUpdateContinuesBase, NameOfNode(first) + " first", NameOfNode(*ends.back()));
  } else if (**end != first) {
    judge.Break(Rule::kStitchingNodeUnchanged, NameOfNode(first) + " with other content");
  }
}

void JudgeNewOrder(MessageJudge& judge, const Order& order) {
  if (order.nodes.front().sequence_id != 0) {
    judge.Break(Rule::kOrderBeginsAtZero, "sequenceId " + std::to_string(order.nodes.front().sequence_id), "0");
  }
  if (order.order_update_id != 0) {
    judge.Break(Rule::kNewOrderUpdateZero, "orderUpdateId " + std::to_string(order.order_update_id), "0");
  }
  const std::optional<State>& state = judge.record.state;
  if (state && IsBusy(*state, judge.record)) {
    judge.Break(Rule::kNewOrderWhenIdle, "the order '" + order.order_id + "' while '" + state->order_id + "' is active",
                "an idle vehicle");
  }
}

std::string ShortReferences(const std::vector<Reference>& references) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(references.size(), 8); ++i) {
    text += (text.empty() ? "" : ", ") + references[i].key + " " + references[i].value;
  }
  return text;
}

}  // namespace

void JudgeOrder(MessageJudge& judge, const Order& order) {
  VehicleRecord& record = judge.record;
  if (const std::vector<MessageFault> faults = CheckOrder(order, judge.version); !faults.empty()) {
    return judge.Break(Rule::kOrderForm, faults.front().ToString());
  }
  if (record.state && !IsModeForOrders(record.state->operating_mode)) {
    judge.Break(Rule::kOrdersInModes, "an order in the mode " + TextOf(record.state->operating_mode, judge.version));
  }
  if (record.factsheet) {
    const SupportFaults faults = CheckSupport(order, *record.factsheet);
    for (const auto* const list : {&faults.parameters, &faults.actions, &faults.lengths}) {
      if (!list->empty()) judge.Break(Rule::kOrderWithinFactsheet, ShortReferences(*list));
    }
  }
  for (const Node& node : order.nodes) {
    for (const Action& action : node.actions) JudgeActionId(judge, action, "order '" + order.order_id + "'");
  }
  for (const Edge& edge : order.edges) {
    for (const Action& action : edge.actions) JudgeActionId(judge, action, "order '" + order.order_id + "'");
  }
  const bool was_sent = record.update_ids.contains(order.order_id);
  // An order that the vehicle had before the checker came is not known.
  const bool is_strange = !was_sent && record.state && record.state->order_id == order.order_id;
  if (was_sent) {
    JudgeUpdate(judge, order);
  } else if (!is_strange) {
    JudgeNewOrder(judge, order);
  }
  if (record.update_ids.size() >= kMostOrders) record.update_ids.clear();
  std::uint32_t& newest = record.update_ids[order.order_id];
  newest = std::max(newest, order.order_update_id);
  const bool is_resend = std::any_of(record.sent.begin(), record.sent.end(), [&](const VehicleRecord::SentOrder& sent) {
    return HaveSameContent(sent.order, order);
  });
  const bool is_accepted = record.route.is_known && record.route.order_id == order.order_id &&
                           order.order_update_id <= record.route.order_update_id;
  if (is_resend || is_accepted) return;
  if (record.sent.size() >= kMostSent) record.sent.erase(record.sent.begin());
  record.sent.push_back({order, judge.message, judge.milliseconds, false});
}

void JudgeInstantActions(MessageJudge& judge, const InstantActions& message) {
  VehicleRecord& record = judge.record;
  for (const Action& action : message.actions) {
    JudgeActionId(judge, action, std::string(kInstantPlace) + action.type);
    const bool is_for_all = action.type == "startPause" || action.type == "stopPause" || action.type == "cancelOrder" ||
                            action.type == "stateRequest" || action.type == "factsheetRequest";
    if (record.factsheet && !is_for_all) {
      const std::string reason = WhyUnsupported(action, ActionScope::kInstant, *record.factsheet);
      if (!reason.empty()) judge.Break(Rule::kInstantActionKnown, "'" + action.type + "': " + reason);
    }
    if (record.state) {
      const OperatingMode mode = record.state->operating_mode;
      const bool is_allowed = mode == OperatingMode::kIntervened ? action.type == "cancelOrder" : IsModeForOrders(mode);
      if (!is_allowed) {
        judge.Break(Rule::kInstantActionsInModes, "'" + action.type + "' in the mode " + TextOf(mode, judge.version));
      }
    }
    const bool is_known = std::any_of(record.instant_actions.begin(), record.instant_actions.end(),
                                      [&](const auto& sent) { return sent.action.id == action.id; });
    if (is_known) continue;
    if (record.instant_actions.size() >= 16 * kMostSent) record.instant_actions.pop_front();
    record.instant_actions.push_back({action, judge.message, judge.milliseconds, false});
  }
}

void JudgeZoneSet(MessageJudge& judge, ZoneSet set) {
  std::map<std::string, VehicleRecord::SentZoneSet>& sets = judge.record.zone_sets;
  set.header = {};
  if (sets.size() >= kMostSentZoneSets) sets.clear();
  const auto [known, is_new] = sets.try_emplace(set.zone_set_id);
  if (is_new) {
    known->second = {std::move(set), judge.message, judge.milliseconds, false};
  } else if (known->second.set != set) {
    judge.Break(Rule::kZoneSetUnchanged, "the zone set '" + set.zone_set_id + "' with other content");
  }
}

}  // namespace troupe::fleet
