// GuidPrefix: the identity of a participant on the network, which all of its readers and writers share.
#pragma once

#include <dds/dds.h>

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::dds {

struct GuidPrefix {
  std::array<std::uint8_t, 12> bytes{};
  auto operator<=>(const GuidPrefix&) const = default;
};

// Of any entity of that participant.
GuidPrefix PrefixOf(const dds_guid_t& guid);

// 24 lower-case hexadecimal digits.
std::string ToText(const GuidPrefix& prefix);
std::optional<GuidPrefix> ParseGuidPrefix(std::string_view text);

}  // namespace troupe::dds
