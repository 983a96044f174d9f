// SharingAddress: where the processes of this machine find the shared memory of a world service. The service announces
// it to its agents.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace troupe {

struct SharingAddress {
  // Of processes that can share memory: the boot of the machine, the namespaces of processes and networks (a container,
  // or a host that is emulated, counts as a machine of its own), and the user.
  std::string machine;
  std::int32_t process = 0;
  std::int32_t frames = 0;  // descriptors of that process
  std::int32_t answers = 0;
  std::uint64_t key = 0;  // random; in the memory too, so that another one is not mistaken for it
  bool operator==(const SharingAddress&) const = default;
};

// Of this process; empty: the system does not tell.
std::string ThisMachine();

// Whether the service is on this machine, since the same boot; its memory may belong to another user or container.
bool IsThisBoot(const SharingAddress& address);

// One word without ';'.
std::string ToText(const SharingAddress& address);
std::optional<SharingAddress> ParseSharingAddress(std::string_view text);

}  // namespace troupe
