// The fields of a row type (RobotState, DoorDescription, Event, ...), listed once: a static function Fields() of the
// type returns a tuple of Field, one for each member, with its name, documentation, unit and limits:
//
//   Field{"opening", &DoorState::opening, "from 0, closed, to 1"}.Within(0, 1),
//   Field{"z", &LiftState::z, "of the cabin's floor"}.In("m"),
//
// From this list come hashes, checks, the words of shared memory, the messages of idl/, the differences of replays, the
// rows of the viewer's page and the random rows of tests. A member that is not listed does not compile.
//
// A field whose type has fields is a branch. The leaves of a type are its other fields and the leaves of its branches.
// All of it is known at compile time.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace troupe {

// The numbers that a field may have; all finite ones by default. The limits of a list hold for its elements, the limits
// of an interval for its ends.
struct FieldLimits {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool is_min_excluded = false;

  constexpr bool has_min() const { return min != -std::numeric_limits<double>::infinity(); }
  constexpr bool has_max() const { return max != std::numeric_limits<double>::infinity(); }
  // False for a number that is not finite.
  constexpr bool Contain(double value) const {
    constexpr double kMax = std::numeric_limits<double>::max();
    return value >= min && value <= max && value >= -kMax && value <= kMax && !(is_min_excluded && value == min);
  }
  bool operator==(const FieldLimits&) const = default;
};

// What is known of a field, whatever its type. Its default is the member's, of a row made by Row().
struct FieldInfo {
  std::string_view name;           // lower case, words separated by '_'; unique among the leaves of a state's type
  std::string_view documentation;  // one line
  std::string_view unit;           // "m", "rad/s", ...; empty: none, or that of each leaf of a branch
  FieldLimits limits;
};

template <typename RowType, typename PartType>
struct Field : FieldInfo {
  using Row = RowType;
  using Part = PartType;

  constexpr Field(std::string_view its_name, Part RowType::*its_member, std::string_view its_documentation = {})
      : FieldInfo{its_name, its_documentation, {}, {}}, member(its_member) {}

  constexpr Field In(std::string_view its_unit) const {
    Field field = *this;
    field.unit = its_unit;
    return field;
  }
  constexpr Field AtLeast(double min) const { return With({min, limits.max, false}); }
  constexpr Field Above(double min) const { return With({min, limits.max, true}); }
  constexpr Field AtMost(double max) const { return With({limits.min, max, limits.is_min_excluded}); }
  constexpr Field Within(double min, double max) const { return With({min, max, false}); }
  constexpr Field With(const FieldLimits& its_limits) const {
    Field field = *this;
    field.limits = its_limits;
    return field;
  }

  constexpr Part& Of(RowType& row) const { return row.*member; }
  constexpr const Part& Of(const RowType& row) const { return row.*member; }

  Part RowType::*member;
};

template <typename Row>
concept HasFields = requires {
  Row::Fields();
};

// The units of fields.
inline constexpr std::array<std::string_view, 18> kFieldUnits = {
    "m", "rad", "s",    "m/s", "rad/s", "m/s^2", "m or rad", "m/s or rad/s", "J",
    "W", "kg",  "tick", "ns",  "pixel", "byte",  "byte/s",   "dBm",          "dB"};

template <typename Value>
inline constexpr bool kIsList = false;
template <typename Element>
inline constexpr bool kIsList<std::vector<Element>> = true;
template <typename Value>
inline constexpr bool kIsOptional = false;
template <typename Value>
inline constexpr bool kIsOptional<std::optional<Value>> = true;

namespace fields_internal {

struct AnyConvertible {
  template <typename Value>
  operator Value() const;  // NOLINT(google-explicit-constructor): stands for any initializer
};

template <typename Row, std::size_t... I>
constexpr bool CanInitialize(std::index_sequence<I...>) {
  return requires {
    Row{(static_cast<void>(I), AnyConvertible{})...};
  };
}

// Each attempt resolves the initialization of all members, so there are few of them: twice the number, until it is too
// many, then halves.
template <typename Row, std::size_t enough = 1, std::size_t too_many = 0>
constexpr std::size_t CountMembers() {
  if constexpr (too_many == 0) {
    if constexpr (CanInitialize<Row>(std::make_index_sequence<enough * 2>())) {
      return CountMembers<Row, enough * 2>();
    } else {
      constexpr std::size_t known = enough == 1 ? 0 : enough;  // one has not been tried
      return CountMembers<Row, known, enough * 2>();
    }
  } else if constexpr (too_many - enough == 1) {
    return enough;
  } else if constexpr (constexpr std::size_t middle = (enough + too_many) / 2;
                       CanInitialize<Row>(std::make_index_sequence<middle>())) {
    return CountMembers<Row, middle, too_many>();
  } else {
    return CountMembers<Row, enough, middle>();
  }
}

template <typename A, typename B>
constexpr bool IsSameMember(const A& a, const B& b) {
  if constexpr (std::is_same_v<A, B>) return a.member == b.member;
  return false;
}

template <typename... Listed>
constexpr bool AreDistinct(const std::tuple<Listed...>& fields) {
  if constexpr (sizeof...(Listed) == 0) {
    return true;
  } else {
    return std::apply(
        [](const auto&... a) {
          const auto count = [&](const auto& b) { return (0 + ... + (IsSameMember(a, b) ? 1 : 0)); };
          return (... && (count(a) == 1));
        },
        fields);
  }
}

constexpr bool IsUnit(std::string_view unit) {
  for (const std::string_view known : kFieldUnits) {
    if (unit == known) return true;
  }
  return unit.empty();
}

template <typename... Listed>
constexpr bool HaveUnits(const std::tuple<Listed...>& fields) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return (... && IsUnit(std::get<I>(fields).unit));
  }
  (std::index_sequence_for<Listed...>());
}

template <typename Branch, typename Leaf>
struct NestedLeaf : FieldInfo {
  using Part = typename Leaf::Part;

  constexpr NestedLeaf(const Branch& its_branch, const Leaf& its_leaf)
      : FieldInfo(static_cast<const FieldInfo&>(its_leaf)), branch(its_branch), leaf(its_leaf) {
    if (documentation.empty()) documentation = branch.documentation;
    if (unit.empty()) unit = branch.unit;
    if (limits == FieldLimits()) limits = branch.limits;
  }

  template <typename Row>
  constexpr auto& Of(Row& row) const {
    return leaf.Of(branch.Of(row));
  }

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
          return std::tuple(NestedLeaf<Listed, std::remove_cvref_t<decltype(leaf)>>(field, leaf)...);
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
template <HasFields Row>
inline constexpr std::size_t kMemberCount<Row> = std::tuple_size_v<decltype(Row::Fields())>;

// The list of a type, checked.
template <typename Row>
constexpr auto FieldsOf() {
  constexpr auto fields = Row::Fields();
  static_assert(fields_internal::AreDistinct(fields), "a member is listed twice in Fields()");
  static_assert(!fields_internal::CanInitialize<Row>(std::make_index_sequence<kMemberCount<Row> + 1>()),
                "a member is missing in Fields()");
  static_assert(fields_internal::HaveUnits(fields), "a field has a unit that is not in kFieldUnits");
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
