// The fields of a row type (RobotState, Event, ...), listed once: a static function Fields() of the type returns a
// tuple of Field, one for each member. From this list come the state hash, the checks, the words of shared memory, the
// columns of idl/, the differences of replays and the rows of the viewer's page. A member that is not listed does not
// compile.
//
// A field of a type with fields is a branch; the other ones, its and those of its branches, are the leaves of a type.
#pragma once

#include <cstddef>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

namespace troupe {

template <typename RowType, typename PartType>
struct Field {
  using Part = PartType;

  constexpr Field(std::string_view its_name, Part RowType::*its_member) : name(its_name), member(its_member) {}
  constexpr Part& Of(RowType& row) const { return row.*member; }
  constexpr const Part& Of(const RowType& row) const { return row.*member; }

  std::string_view name;  // lower case, words separated by '_'; unique among the leaves of a type
  Part RowType::*member;
};

template <typename Row>
concept HasFields = requires {
  Row::Fields();
};

namespace fields_internal {

struct Anything {
  template <typename Value>
  operator Value() const;  // NOLINT(google-explicit-constructor): stands for any initializer
};

template <typename Row, std::size_t... I>
constexpr bool CanInitialize(std::index_sequence<I...>) {
  return requires {
    Row{(static_cast<void>(I), Anything{})...};
  };
}

template <typename Row, std::size_t count = 0>
constexpr std::size_t CountMembers() {
  if constexpr (CanInitialize<Row>(std::make_index_sequence<count + 1>())) {
    return CountMembers<Row, count + 1>();
  } else {
    return count;
  }
}

template <typename A, typename B>
constexpr bool IsSameMember(const A& a, const B& b) {
  if constexpr (std::is_same_v<A, B>) return a.member == b.member;
  return false;
}

template <typename... Listed>
constexpr bool AreDistinct(const std::tuple<Listed...>& fields) {
  return std::apply(
      [&](const auto&... a) {
        const auto count = [&](const auto& b) { return (0 + ... + (IsSameMember(a, b) ? 1 : 0)); };
        return (... && (count(a) == 1));
      },
      fields);
}

template <typename Branch, typename Leaf>
struct NestedLeaf {
  using Part = typename Leaf::Part;

  template <typename Row>
  constexpr auto& Of(Row& row) const {
    return leaf.Of(branch.Of(row));
  }

  std::string_view name;
  Branch branch;
  Leaf leaf;
};

template <typename Row>
constexpr auto Leaves();

template <typename Listed>
constexpr auto LeavesOf(const Listed& field) {
  if constexpr (HasFields<typename Listed::Part>) {
    return std::apply(
        [&](const auto&... leaf) {
          return std::tuple(NestedLeaf<Listed, std::remove_cvref_t<decltype(leaf)>>{leaf.name, field, leaf}...);
        },
        Leaves<typename Listed::Part>());
  } else {
    return std::tuple(field);
  }
}

}  // namespace fields_internal

// The number of members of an aggregate.
template <typename Row>
inline constexpr std::size_t kMemberCount = fields_internal::CountMembers<Row>();

// The list of a type, checked.
template <typename Row>
constexpr auto FieldsOf() {
  constexpr auto fields = Row::Fields();
  static_assert(std::tuple_size_v<decltype(fields)> == kMemberCount<Row>, "a member is missing in Fields()");
  static_assert(fields_internal::AreDistinct(fields), "a member is listed twice in Fields()");
  return fields;
}

template <typename Row>
constexpr auto fields_internal::Leaves() {
  return std::apply([](const auto&... field) { return std::tuple_cat(LeavesOf(field)...); }, FieldsOf<Row>());
}

template <typename Row>
inline constexpr auto kFields = FieldsOf<Row>();
template <typename Row>
inline constexpr auto kLeaves = fields_internal::Leaves<Row>();

// Calls visit(field) for each, in the order of the list.
template <typename Row, typename Visit>
constexpr void ForEachField(Visit&& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, kFields<Row>);
}
template <typename Row, typename Visit>
constexpr void ForEachLeaf(Visit&& visit) {
  std::apply([&](const auto&... leaf) { (visit(leaf), ...); }, kLeaves<Row>);
}

}  // namespace troupe
