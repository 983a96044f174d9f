// Rows (troupe/fields.h) between their lists and columns of idl/: structs of sequences, one for each leaf of the row
// type, in its order. A column that is missing, that is none of the leaves or that has another type does not compile.
//
// Columns and not structs, because a sequence of numbers is copied in one piece: a frame of a thousand robots is some
// dozen copies. The checks of a received list: all columns have one length, and each value is one of its type. Whether
// ids exist is checked later, with the world.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "transport/dds/binding/wire.h"
#include "transport/dds/convert/cells.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/result.h"

namespace troupe::dds {

namespace columns_internal {

template <typename Leaf>
inline constexpr bool kIsBytes = std::is_same_v<typename Leaf::Part, std::vector<std::uint8_t>>;

template <std::size_t leaf, std::size_t column, typename Leaves, typename Columns, typename Visit>
void VisitColumns(const Leaves& leaves, const Columns& columns, Visit& visit) {
  if constexpr (leaf < std::tuple_size_v<Leaves>) {
    static_assert(column < std::tuple_size_v<Columns>, "a field has no column");
    const auto& field = std::get<leaf>(leaves);
    if constexpr (kIsBytes<std::remove_cvref_t<decltype(field)>>) {
      visit(field, std::get<column>(columns), std::get<column + 1>(columns));
      VisitColumns<leaf + 1, column + 2>(leaves, columns, visit);
    } else {
      visit(field, std::get<column>(columns));
      VisitColumns<leaf + 1, column + 1>(leaves, columns, visit);
    }
  } else {
    static_assert(column == std::tuple_size_v<Columns>, "a column is not one of a field");
  }
}

}  // namespace columns_internal

// Calls visit(leaf, column) for each leaf of a row type; visit(leaf, lengths, bytes) for bytes, which have two columns:
// their number in each row, and the bytes of all rows.
template <typename Leaves, typename Columns, typename Visit>
void ForEachColumn(const Leaves& leaves, const Columns& columns, Visit&& visit) {
  columns_internal::VisitColumns<0, 0>(leaves, columns, visit);
}

template <typename Sequence>
using CellOf = std::remove_cvref_t<decltype(*std::declval<Sequence&>()._buffer)>;

// Fills columns. `for_each_row(use)` calls use(row) for each of the `count` rows.
template <typename Leaves, typename Columns, typename ForEachRow>
void ListToColumns(std::size_t count, const ForEachRow& for_each_row, const Leaves& leaves, const Columns& columns,
                   WireArena& arena) {
  if (count == 0) return;
  ForEachColumn(leaves, columns, [&]<typename Column>(const auto& leaf, Column& column, auto&... bytes) {
    auto* out = arena.Fill(column, count);
    if constexpr (sizeof...(bytes) == 0) {
      for_each_row([&](const auto& row) { *out++ = ToCell<CellOf<Column>>(leaf.Of(row), arena); });
    } else {
      std::size_t size = 0;
      for_each_row([&](const auto& row) { size += leaf.Of(row).size(); });
      std::uint8_t* content = arena.Fill(bytes..., size);
      for_each_row([&](const auto& row) {
        *out++ = static_cast<CellOf<Column>>(leaf.Of(row).size());
        content = std::copy(leaf.Of(row).begin(), leaf.Of(row).end(), content);
      });
    }
  });
}

// The inverse. The error: columns that are not of one list, or a value that is not of its type.
template <typename Row, typename Leaves, typename Columns>
Status ListFromColumns(std::string_view what, const Leaves& leaves, const Columns& columns, std::vector<Row>& rows) {
  rows.resize(Elements(std::get<0>(columns)).size());
  const char* problem = nullptr;
  ForEachColumn(leaves, columns, [&](const auto& leaf, const auto& column, const auto&... bytes) {
    const auto cells = Elements(column);
    if (cells.size() != rows.size()) {
      problem = "columns of different lengths";
    } else if (problem != nullptr) {
      return;
    } else if constexpr (sizeof...(bytes) == 0) {
      bool is_fine = true;
      for (std::size_t i = 0; i < rows.size(); ++i) is_fine &= FromCell(cells[i], leaf.Of(rows[i]));
      if (!is_fine) problem = "a value that is not known";
    } else {
      auto content = Elements(bytes...);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto own = content.first(std::min<std::size_t>(cells[i], content.size()));
        if (own.size() < cells[i]) problem = "fewer bytes than their lengths say";
        content = content.subspan(own.size());
        leaf.Of(rows[i]).assign(own.begin(), own.end());
      }
      if (!content.empty()) problem = "more bytes than their lengths say";
    }
  });
  if (problem == nullptr) return {};
  return Error{{}, std::string(what) + " with " + problem};
}

}  // namespace troupe::dds
