// A network of this process' own.
#pragma once

#include <sched.h>

#include <cstdlib>

namespace troupe::test {

// Moves the process to a network of its own with the interface net0 (10.77.0.1). False without root, and on a kernel
// without network namespaces and veth. Call before the first thread is started.
inline bool HasNetworkOfItsOwn() {
  static const bool has =
      unshare(CLONE_NEWNET) == 0 && std::system(
                                        "ip link set lo up && ip link add net0 type veth peer name net1 2>/dev/null && "
                                        "ip addr add 10.77.0.1/24 dev net0 && ip link set net0 up && "
                                        "ip link set net1 up && ip route add default dev net0") == 0;
  return has;
}

}  // namespace troupe::test
