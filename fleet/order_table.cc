#include "fleet/order_table.h"

#include <algorithm>

#include "troupe/check.h"

namespace troupe::fleet {
namespace {

using enum OrderVerdict;
using Facts = OrderFacts;

constexpr OrderRow kTable[] = {
    {"invalid", "wrong JSON, types, counts or sequence", [](const Facts& f) { return !f.is_valid; }, kReject,
     "validationError", "VALIDATION_FAILURE"},

    // The order that the vehicle has: older, cancelled, sent again.
    {"outdated_update", "same order, smaller update id",
     [](const Facts& f) { return f.is_same_order && f.update_id < f.present_id; }, kReject, "orderUpdateError",
     "OUTDATED_ORDER_UPDATE"},
    {"after_cancel", "same order, which is cancelled (3.0), or is being cancelled and the update id is larger (2.x)",
     [](const Facts& f) {
       if (!f.is_same_order) return false;
       return IsBefore3(f.version) ? f.is_clearing && f.update_id > f.present_id : f.is_clearing || f.is_cancelled;
     },
     kReject, "orderUpdateError", "ORDER_UPDATE_FOLLOWING_CANCEL"},
    {"resend", "same order, same update id (3.0: and the same content)",
     [](const Facts& f) {
       return f.is_same_order && f.update_id == f.present_id && (IsBefore3(f.version) || f.has_same_content);
     },
     kDiscard},
    {"changed_resend", "same order, same update id, other content (3.0)",
     [](const Facts& f) { return f.is_same_order && f.update_id == f.present_id; }, kReject, "",
     "SAME_ORDER_UPDATE_ID"},

    // What the vehicle can do at all.
    {"mode_without_orders", "an operating mode that takes no orders",
     [](const Facts& f) { return !f.is_mode_for_orders; }, kReject, "orderError", "MOBILE_ROBOT_NOT_AVAILABLE"},
    {"fatal_error", "the vehicle has a fatal error", [](const Facts& f) { return f.has_fatal_error; }, kReject,
     "orderError", "MOBILE_ROBOT_NOT_AVAILABLE"},
    {"too_long", "longer than the limits of the factsheet", [](const Facts& f) { return !f.fits_limits; }, kReject,
     "orderError", "INSUFFICIENT_MEMORY", ErrorLevel::kUrgent},
    {"unsupported_parameter", "an optional member that the vehicle cannot use, or needs",
     [](const Facts& f) { return !f.parameters_supported; }, kReject, "orderError", "UNSUPPORTED_PARAMETER",
     ErrorLevel::kCritical},
    {"unsupported_action", "an action that the vehicle cannot execute",
     [](const Facts& f) { return !f.actions_supported; }, kReject, "orderError", "INVALID_ORDER_ACTION"},
    {"reused_action_id", "the id of an action that the vehicle still reports",
     [](const Facts& f) { return f.reuses_action_id; }, kReject, "validationError", "VALIDATION_FAILURE"},
    {"unknown_map", "a node on a map that the vehicle does not have", [](const Facts& f) { return !f.maps_known; },
     kReject, "orderError", "UNKNOWN_MAP_ID"},

    // A new order.
    {"other_order_active", "other order, busy", [](const Facts& f) { return !f.is_same_order && f.is_busy; }, kReject,
     "orderError", "OTHER_ORDER_ACTIVE"},
    {"update_without_order", "other order, update id not 0 (3.0)",
     [](const Facts& f) { return !f.is_same_order && !IsBefore3(f.version) && f.update_id != 0; }, kReject, "",
     "VALIDATION_FAILURE"},
    {"start_too_far", "other order, idle, first node too far",
     [](const Facts& f) { return !f.is_same_order && !f.is_start_near; }, kReject, "noRouteError",
     "START_NODE_OUT_OF_RANGE"},
    {"new_order", "other order, idle, first node near", [](const Facts& f) { return !f.is_same_order; }, kAcceptNew},

    // An update of the order that the vehicle has.
    {"update_of_base", "same order, larger update id, busy, begins at the end of the base",
     [](const Facts& f) { return f.is_busy && f.continues; }, kAcceptUpdate},
    {"update_breaks_base", "same order, larger update id, busy, begins elsewhere",
     [](const Facts& f) { return f.is_busy; }, kReject, "orderUpdateError", "VALIDATION_FAILURE"},
    {"update_of_finished", "same order, larger update id, idle, begins at the last node",
     [](const Facts& f) { return f.continues; }, kAcceptUpdate},
    {"update_breaks_finished", "same order, larger update id, idle, begins elsewhere",
     [](const Facts&) { return true; }, kReject, "orderUpdateError", "VALIDATION_FAILURE"},
};

}  // namespace

std::span<const OrderRow> OrderTable() {
  return kTable;
}

const OrderRow& RowFor(const OrderFacts& facts) {
  const auto row =
      std::find_if(std::begin(kTable), std::end(kTable), [&](const OrderRow& each) { return each.holds(facts); });
  TROUPE_CHECK(row != std::end(kTable));
  return *row;
}

}  // namespace troupe::fleet
