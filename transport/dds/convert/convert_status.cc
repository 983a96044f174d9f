#include "transport/dds/convert/convert_status.h"

#include <tuple>
#include <utility>

namespace troupe::dds {
namespace {

// Calls visit(leaf, member) for each leaf of StatusMessage and its member of the wire's struct, which has the same
// order.
template <typename Wire, typename Visit>
void ForEachMember(Wire& wire, const Visit& visit) {
  auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q] = wire;
  const auto members = std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q);
  constexpr auto& leaves = kLeaves<StatusMessage>;
  static_assert(std::tuple_size_v<decltype(members)> == std::tuple_size_v<std::remove_cvref_t<decltype(leaves)>>);
  [&]<std::size_t... number>(std::index_sequence<number...>) {
    // The analyzer takes members of a tuple of references for uninitialized.
    (visit(std::get<number>(leaves), std::get<number>(members)), ...);  // NOLINT(clang-analyzer-core.CallAndMessage)
  }
  (std::make_index_sequence<std::tuple_size_v<decltype(members)>>());
}

}  // namespace

troupe_wire_Status ToWire(const StatusMessage& message, WireArena& arena) {
  troupe_wire_Status wire{};
  ForEachMember(wire, [&]<typename Leaf, typename Member>(const Leaf& leaf, Member& member) {
    const auto& part = leaf.Of(message);
    if constexpr (std::is_same_v<typename Leaf::Part, std::vector<std::string>>) {
      arena.FillStrings(member, part);
    } else if constexpr (std::is_same_v<typename Leaf::Part, std::optional<double>>) {
      member = part.value_or(0.0);
    } else {
      static_assert(std::is_same_v<Member, typename Leaf::Part>);
      member = part;
    }
  });
  return wire;
}

Result<StatusMessage> FromWire(const troupe_wire_Status& wire) {
  StatusMessage message;
  ForEachMember(wire, [&]<typename Leaf>(const Leaf& leaf, const auto& member) {
    auto& part = leaf.Of(message);
    if constexpr (std::is_same_v<typename Leaf::Part, std::vector<std::string>>) {
      part = Strings(member);
    } else if constexpr (std::is_same_v<typename Leaf::Part, std::optional<double>>) {
      if (member > 0.0) part = member;
    } else {
      part = member;
    }
  });
  return message;
}

}  // namespace troupe::dds
