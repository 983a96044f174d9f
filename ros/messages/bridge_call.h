// The calls of a ros-service-bridge. It repeats a call until it is answered: DDS does not report when discovery is
// complete, and a request that a service receives before it has discovered its writer is lost.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace troupe::ros {

// A bridge's id as a client: this mark, and 32 random bits.
inline constexpr std::uint64_t kBridgeMark = 0x74726f75'00000000;
inline constexpr bool IsBridge(std::uint64_t client_guid) {
  return client_guid >> 32 == kBridgeMark >> 32;
}

// The last calls of bridges to a service, so that none is executed twice.
class RecentBridgeCalls {
 public:
  // False for a call that is one of the last kKept. Calls of other clients are always new: some begin to count again.
  bool Add(std::uint64_t client_guid, std::int64_t sequence_number) {
    if (!IsBridge(client_guid)) return true;
    const std::pair call(client_guid, sequence_number);
    if (std::find(calls_.begin(), calls_.end(), call) != calls_.end()) return false;
    calls_[next_] = call;
    next_ = (next_ + 1) % kKept;
    return true;
  }

  static constexpr std::size_t kKept = 256;

 private:
  std::array<std::pair<std::uint64_t, std::int64_t>, kKept> calls_{};  // client 0 is no bridge
  std::size_t next_ = 0;
};

}  // namespace troupe::ros
