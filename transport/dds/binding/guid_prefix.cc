#include "transport/dds/binding/guid_prefix.h"

#include <algorithm>
#include <span>

#include "common/base/hexadecimal.h"

namespace troupe::dds {

GuidPrefix PrefixOf(const dds_guid_t& guid) {
  GuidPrefix prefix;
  std::copy_n(std::begin(guid.v), prefix.bytes.size(), prefix.bytes.begin());
  return prefix;
}

std::string ToText(const GuidPrefix& prefix) {
  return ToHexadecimal(std::as_bytes(std::span(prefix.bytes)));
}

std::optional<GuidPrefix> ParseGuidPrefix(std::string_view text) {
  const std::optional<std::string> bytes = FromHexadecimal(text);
  GuidPrefix prefix;
  if (!bytes || bytes->size() != prefix.bytes.size()) return std::nullopt;
  std::copy(bytes->begin(), bytes->end(), prefix.bytes.begin());
  return prefix;
}

}  // namespace troupe::dds
