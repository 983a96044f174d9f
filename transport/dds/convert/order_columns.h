// Orders (troupe/order.h) between their list and the columns of their kinds in idl/order.idl.
//
// One struct of columns for each kind of order: rows of all robots of a message in one list, in the sequence of ByKind
// (common/spatial/check_order.h), so that a list and its columns are each other's inverse.
#pragma once

#include <string_view>
#include <vector>

#include "idl/order.h"
#include "transport/dds/convert/columns.h"
#include "troupe/order.h"
#include "troupe/result.h"

namespace troupe::dds {

// An order and the robot that gives it, or whose device it concerns; an unset id: none.
template <typename Kind>
struct OrderRow {
  RobotId robot;
  Kind order = {};
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &OrderRow::robot},
        Field{"order", &OrderRow::order},
    };
  }
};

// Fills the columns of one kind with the orders of it. `for_each(use)` calls use(robot, order) for each Order.
template <typename Kind, typename ForEach, typename Columns>
void OrdersToColumns(const ForEach& for_each, Columns& columns, WireArena& arena) {
  std::vector<OrderRow<Kind>> rows;
  for_each([&](RobotId robot, const Order& any) {
    if (const auto* const order = std::get_if<Kind>(&any)) rows.push_back({robot, *order});
  });
  const auto for_each_row = [&](const auto& use) {
    for (const OrderRow<Kind>& row : rows) use(row);
  };
  ListToColumns(rows.size(), for_each_row, kLeaves<OrderRow<Kind>>, MembersOf(columns), arena);
}

// The inverse: add(robot, order) for each row; false: nothing has such an order. As ListFromColumns.
template <typename Kind, typename Columns, typename Add>
Status OrdersFromColumns(std::string_view what, const Columns& columns, const Add& add) {
  std::vector<OrderRow<Kind>> rows;
  if (Status problem = ListFromColumns(what, kLeaves<OrderRow<Kind>>, MembersOf(columns), rows); !problem.ok()) {
    return problem;
  }
  for (OrderRow<Kind>& row : rows) {
    if (!add(row.robot, Order(std::move(row.order)))) {
      return Error{{}, std::string(what) + " of a robot that it does not have"};
    }
  }
  return {};
}

}  // namespace troupe::dds
