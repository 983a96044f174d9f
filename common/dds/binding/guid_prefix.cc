#include "common/dds/binding/guid_prefix.h"

#include <algorithm>
#include <charconv>

namespace troupe::dds {
namespace {

constexpr int kHexadecimal = 16;

}  // namespace

GuidPrefix PrefixOf(const dds_guid_t& guid) {
  GuidPrefix prefix;
  std::copy_n(std::begin(guid.v), prefix.bytes.size(), prefix.bytes.begin());
  return prefix;
}

std::string ToText(const GuidPrefix& prefix) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : prefix.bytes) {
    text += kDigits[byte / kHexadecimal];
    text += kDigits[byte % kHexadecimal];
  }
  return text;
}

std::optional<GuidPrefix> ParseGuidPrefix(std::string_view text) {
  GuidPrefix prefix;
  if (text.size() != 2 * prefix.bytes.size()) return std::nullopt;
  for (std::size_t i = 0; i < prefix.bytes.size(); ++i) {
    const char* const digits = text.data() + 2 * i;
    const auto [end, problem] = std::from_chars(digits, digits + 2, prefix.bytes[i], kHexadecimal);
    if (problem != std::errc() || end != digits + 2) return std::nullopt;
  }
  return prefix;
}

}  // namespace troupe::dds
