// The parts of rows (troupe/fields.h) as values of idl/: their types, and the members of the structs that have them.
//
// The mapping of types is fixed here once: ids as 32 bits, "none" as -1, flags and enumerators as octets, indices as 32
// bits. A field and a member that do not agree fail to compile, so that a change of a list of fields cannot silently
// change the wire.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>

#include "transport/dds/binding/wire.h"
#include "troupe/fields.h"
#include "troupe/ids.h"

namespace troupe::dds {

// The members of a struct of idlc, in their order.
template <typename Struct>
auto MembersOf(Struct& s) {
  constexpr std::size_t count = kMemberCount<std::remove_const_t<Struct>>;
  static_assert(count >= 1 && count <= 32, "add the struct's number of members here");
#define TROUPE_MEMBERS(number, ...)  \
  if constexpr (count == (number)) { \
    auto& [__VA_ARGS__] = s;         \
    return std::tie(__VA_ARGS__);    \
  }
#define TROUPE_4 a, b, c, d
#define TROUPE_8 TROUPE_4, e, f, g, h
#define TROUPE_12 TROUPE_8, i, j, k, l
#define TROUPE_16 TROUPE_12, m, n, o, p
#define TROUPE_20 TROUPE_16, q, r, t, u
#define TROUPE_24 TROUPE_20, v, w, x, y
#define TROUPE_28 TROUPE_24, z, aa, ab, ac
  TROUPE_MEMBERS(1, a)
  TROUPE_MEMBERS(2, a, b)
  TROUPE_MEMBERS(3, a, b, c)
  TROUPE_MEMBERS(4, TROUPE_4)
  TROUPE_MEMBERS(5, TROUPE_4, e)
  TROUPE_MEMBERS(6, TROUPE_4, e, f)
  TROUPE_MEMBERS(7, TROUPE_4, e, f, g)
  TROUPE_MEMBERS(8, TROUPE_8)
  TROUPE_MEMBERS(9, TROUPE_8, i)
  TROUPE_MEMBERS(10, TROUPE_8, i, j)
  TROUPE_MEMBERS(11, TROUPE_8, i, j, k)
  TROUPE_MEMBERS(12, TROUPE_12)
  TROUPE_MEMBERS(13, TROUPE_12, m)
  TROUPE_MEMBERS(14, TROUPE_12, m, n)
  TROUPE_MEMBERS(15, TROUPE_12, m, n, o)
  TROUPE_MEMBERS(16, TROUPE_16)
  TROUPE_MEMBERS(17, TROUPE_16, q)
  TROUPE_MEMBERS(18, TROUPE_16, q, r)
  TROUPE_MEMBERS(19, TROUPE_16, q, r, t)
  TROUPE_MEMBERS(20, TROUPE_20)
  TROUPE_MEMBERS(21, TROUPE_20, v)
  TROUPE_MEMBERS(22, TROUPE_20, v, w)
  TROUPE_MEMBERS(23, TROUPE_20, v, w, x)
  TROUPE_MEMBERS(24, TROUPE_24)
  TROUPE_MEMBERS(25, TROUPE_24, z)
  TROUPE_MEMBERS(26, TROUPE_24, z, aa)
  TROUPE_MEMBERS(27, TROUPE_24, z, aa, ab)
  TROUPE_MEMBERS(28, TROUPE_28)
  TROUPE_MEMBERS(29, TROUPE_28, ad)
  TROUPE_MEMBERS(30, TROUPE_28, ad, ae)
  TROUPE_MEMBERS(31, TROUPE_28, ad, ae, af)
  TROUPE_MEMBERS(32, TROUPE_28, ad, ae, af, ag)
#undef TROUPE_MEMBERS
#undef TROUPE_4
#undef TROUPE_8
#undef TROUPE_12
#undef TROUPE_16
#undef TROUPE_20
#undef TROUPE_24
#undef TROUPE_28
}

template <typename... All>
constexpr auto WithoutFirst(const std::tuple<All...>& all) {
  return std::apply([](const auto&, auto&... others) { return std::tuple<decltype(others)...>(others...); }, all);
}

// Whether a cell of a column has the type for a field.
template <typename Cell, typename Part>
constexpr bool IsCellOf() {
  if constexpr (std::is_same_v<Part, std::optional<double>>) return std::is_same_v<Cell, double>;  // 0: none
  if constexpr (kIsOptional<Part>) return std::is_same_v<Cell, std::int32_t>;                      // -1: none
  if constexpr (kIsId<Part>) return std::is_same_v<Cell, std::uint32_t>;
  if constexpr (std::is_same_v<Part, std::string>) return std::is_same_v<Cell, char*>;
  if constexpr (std::is_same_v<Part, bool>) return std::is_same_v<Cell, bool> || std::is_same_v<Cell, std::uint8_t>;
  if constexpr (std::is_enum_v<Part>) return std::is_same_v<Cell, std::uint8_t>;
  // An index has the width of the machine, and its column 32 bits everywhere.
  if constexpr (std::is_same_v<Part, std::uint64_t> || std::is_same_v<Part, std::size_t>) {
    return std::is_same_v<Cell, std::uint32_t> || std::is_same_v<Cell, std::uint64_t>;
  }
  return std::is_same_v<Cell, Part>;
}

template <typename Cell, typename Part>
Cell ToCell(const Part& part, WireArena& arena) {
  static_assert(IsCellOf<Cell, Part>(), "a column has another type than its field");
  if constexpr (kIsOptionalId<Part>) {
    return part ? static_cast<Cell>(part->index()) : Cell{-1};
  } else if constexpr (std::is_same_v<Part, std::optional<double>>) {
    return part.value_or(0.0);
  } else if constexpr (kIsOptional<Part>) {
    return part ? static_cast<Cell>(*part) : Cell{-1};
  } else if constexpr (kIsId<Part>) {
    return static_cast<Cell>(part.index());
  } else if constexpr (std::is_same_v<Part, std::string>) {
    return arena.Copy(part);
  } else {
    return static_cast<Cell>(part);
  }
}

// False if the value is not one of the type: an unknown enumerator, another flag than 0 and 1, an id below -1. Numbers
// that are not finite and ids that no world has pass.
template <typename Cell, typename Part>
bool FromCell(Cell cell, Part& part) {
  static_assert(IsCellOf<std::remove_const_t<Cell>, Part>(), "a column has another type than its field");
  if constexpr (std::is_same_v<Part, std::optional<double>>) {
    part = cell == 0.0 ? std::nullopt : std::optional(cell);
    return !(cell < 0.0);
  } else if constexpr (kIsOptional<Part>) {
    if (cell >= 0) {
      part.emplace(static_cast<std::uint32_t>(cell));
    } else {
      part.reset();
    }
    return cell >= -1;
  } else if constexpr (kIsId<Part>) {
    part = Part(cell);
  } else if constexpr (std::is_same_v<Part, std::string>) {
    part = Text(cell);
  } else {
    part = static_cast<Part>(cell);
    if constexpr (std::is_same_v<Part, bool> && !std::is_same_v<std::remove_cvref_t<decltype(cell)>, bool>)
      return cell <= 1;
    if constexpr (std::is_enum_v<Part>) return part <= LastOf(Part());
  }
  return true;
}

}  // namespace troupe::dds
