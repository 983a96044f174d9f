// The decision about an order that a vehicle receives, as one table: the first row whose condition holds decides.
// Sources: VDA 5050 2.1, section 6.6 with figure 8, and 3.0, section 6.1 with figure 8.
//
// OrderFacts are the questions of the table, answered by FactsOf (vehicle.h) from the memory of a vehicle.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "fleet/order_message.h"
#include "fleet/state_message.h"

namespace troupe::fleet {

struct OrderFacts {
  Version version = Version::k2_1;
  bool is_valid = true;           // its JSON, types, sequence and counts (CheckOrder)
  bool is_same_order = false;     // its id is that of the vehicle's order
  std::uint32_t update_id = 0;    // of the message
  std::uint32_t present_id = 0;   // of the vehicle's order
  bool is_cancelled = false;      // the vehicle's order has been cancelled or cleared
  bool is_clearing = false;       // ... is being cleared
  bool has_same_content = false;  // as the order or update that was accepted last
  bool is_mode_for_orders = true;
  bool has_fatal_error = false;
  bool fits_limits = true;           // of the factsheet
  bool parameters_supported = true;  // optional members
  bool actions_supported = true;
  bool reuses_action_id = false;  // of an action that the vehicle still reports
  bool maps_known = true;
  bool is_busy = false;        // nodes, edges or actions of the order are left
  bool is_start_near = false;  // the vehicle is on the first node, or within its deviation
  bool continues = false;      // the first node is the end of the base, of an idle vehicle the last node
};

enum class OrderVerdict : std::uint8_t { kReject, kDiscard, kAcceptNew, kAcceptUpdate };
constexpr auto NamesOf(OrderVerdict) {
  return std::array{"reject", "discard", "accept_new", "accept_update"};
}
constexpr bool IsAccepted(OrderVerdict verdict) {
  return verdict == OrderVerdict::kAcceptNew || verdict == OrderVerdict::kAcceptUpdate;
}

struct OrderRow {
  std::string_view name;
  std::string_view condition;  // in words
  bool (*holds)(const OrderFacts& facts);
  OrderVerdict verdict = OrderVerdict::kReject;
  // The type of the error that a rejection reports, and its level. Fleet controls know the four types of 2.x as
  // rejections of orders and expect them for nothing else.
  std::string_view older_error = "";
  std::string_view newer_error = "";
  ErrorLevel newer_level = ErrorLevel::kWarning;

  std::string_view ErrorOf(Version version) const { return IsBefore3(version) ? older_error : newer_error; }
  ErrorLevel LevelOf(Version version) const { return IsBefore3(version) ? ErrorLevel::kWarning : newer_level; }
};

std::span<const OrderRow> OrderTable();

// The row that decides; there always is one.
const OrderRow& RowFor(const OrderFacts& facts);

}  // namespace troupe::fleet
