// The rules of VDA 5050 that a sequence of messages can be judged by, with the versions that have them. checker.h
// judges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "fleet/order_message.h"

namespace troupe::fleet {

enum class Side : std::uint8_t { kFleet, kVehicle, kBoth };
constexpr auto NamesOf(Side) {
  return std::array{"fleet", "vehicle", "both"};
}

enum class Rule : std::uint8_t {
  // Every message.
  kMessageForm,
  kStrictJson,
  kHeaderIdCounts,
  kTimestampGrows,
  kSenderInTopic,
  kVersionOfTopic,
  // The fleet control.
  kOrderForm,
  kOrderBeginsAtZero,
  kNewOrderUpdateZero,
  kUpdateIdGrows,
  kResendUnchanged,
  kUpdateContinuesBase,
  kStitchingNodeUnchanged,
  kNewOrderWhenIdle,
  kNoUpdateAfterCancel,
  kOrdersInModes,
  kOrderWithinFactsheet,
  kInstantActionKnown,
  kInstantActionsInModes,
  kActionIdsUnique,
  kZoneSetUnchanged,
  // The vehicle.
  kOnlineBeforeState,
  kStateInterval,
  kOrderAnswered,
  kRejectionKept,
  kInstantActionReported,
  kOrderWasSent,
  kUpdateIdKept,
  kStateSequence,
  kNodesOfOrder,
  kReleasedByFleet,
  kHorizonComplete,
  kTraversalInSequence,
  kOnlyBaseTraversed,
  kActionStatesComplete,
  kActionStatesKept,
  kActionStatusSequence,
  kActionRunsAlone,
  kStandsForAction,
  kPauseStands,
  kPauseEnds,
  kCancelClears,
  kCancelWithoutOrder,
  kModeClearsOrder,
  kOneEnabledMap,
  kZoneSetAnswered,
  kOneEnabledZoneSet,
  kRequestsOfEnabledSets,
  kZoneActionsReported,
};
constexpr auto NamesOf(Rule) {
  return std::array{"message_form",
                    "strict_json",
                    "header_id_counts",
                    "timestamp_grows",
                    "sender_in_topic",
                    "version_of_topic",
                    "order_form",
                    "order_begins_at_zero",
                    "new_order_update_zero",
                    "update_id_grows",
                    "resend_unchanged",
                    "update_continues_base",
                    "stitching_node_unchanged",
                    "new_order_when_idle",
                    "no_update_after_cancel",
                    "orders_in_modes",
                    "order_within_factsheet",
                    "instant_action_known",
                    "instant_actions_in_modes",
                    "action_ids_unique",
                    "zone_set_unchanged",
                    "online_before_state",
                    "state_interval",
                    "order_answered",
                    "rejection_kept",
                    "instant_action_reported",
                    "order_was_sent",
                    "update_id_kept",
                    "state_sequence",
                    "nodes_of_order",
                    "released_by_fleet",
                    "horizon_complete",
                    "traversal_in_sequence",
                    "only_base_traversed",
                    "action_states_complete",
                    "action_states_kept",
                    "action_status_sequence",
                    "action_runs_alone",
                    "stands_for_action",
                    "pause_stands",
                    "pause_ends",
                    "cancel_clears",
                    "cancel_without_order",
                    "mode_clears_order",
                    "one_enabled_map",
                    "zone_set_answered",
                    "one_enabled_zone_set",
                    "requests_of_enabled_sets",
                    "zone_actions_reported"};
}

struct RuleInfo {
  Rule rule = Rule::kMessageForm;
  Side side = Side::kBoth;            // that breaks it
  std::array<bool, 3> versions = {};  // 2.0, 2.1, 3.0
  std::string_view requirement;       // in one sentence

  bool IsIn(Version version) const { return versions[static_cast<std::size_t>(version)]; }
};

// One for each rule, in the order of their numbers.
std::span<const RuleInfo> Rules();
const RuleInfo& InfoOf(Rule rule);

}  // namespace troupe::fleet
