// The layout of the messages to the page (page_messages.h), as a number that both sides compare.
#pragma once

#include <cstdint>
#include <string_view>

#include "common/base/hash.h"
#include "troupe/sensor.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"
#include "viewer/gateway/page_values.h"

namespace troupe {

// Version of what PageLayout does not see: the parts of messages that are no rows.
inline constexpr std::uint32_t kPageProtocol = 10;

// A hash of the layout of messages, which follows from the lists of fields; the page refuses another one.
inline std::uint32_t PageLayout() {
  static const std::uint64_t layout = [] {
    Hasher hasher;
    hasher.Add(std::uint64_t{kPageProtocol});
    hasher.Add(std::string_view(PageValue<WorldState>::Read()));
    hasher.Add(std::string_view(PageValue<WorldDescription>::Read()));
    hasher.Add(std::string_view(PageValue<ReadingContent>::Read()));
    return hasher.value();
  }();
  return static_cast<std::uint32_t>(layout);
}

}  // namespace troupe
