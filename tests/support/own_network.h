// A network of this process' own.
// For tests of interfaces, multicast and lost links, which must not touch the machine's network nor depend on it. Where
// the kernel forbids it, these tests are skipped.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>

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

// BridgedHosts: two hosts as network namespaces, joined by a bridge. Needs root, the program `ip` and a kernel that
// makes namespaces.
class BridgedHosts {
 public:
  static constexpr const char* kInterface = "eth0";

  // Null where the machine cannot make them.
  static std::unique_ptr<BridgedHosts> Make() {
    auto hosts = std::make_unique<BridgedHosts>();
    if (geteuid() != 0 || !hosts->Build()) return nullptr;
    return hosts;
  }
  ~BridgedHosts() {
    for (const char* name : {"lan", "1", "2"}) Ip("netns del " + Space(name));  // with its interfaces
  }

  // The IPv4 address of a host, 1 or 2.
  static std::string AddressOf(int host) { return "10.213.78." + std::to_string(host); }

  // While it lives, the sockets, threads and processes that this thread makes are of that host.
  class Visit {
   public:
    Visit(const BridgedHosts& hosts, int host) : home_(open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC)) {
      const std::string path = "/run/netns/" + hosts.Space(std::to_string(host));
      const int there = open(path.c_str(), O_RDONLY | O_CLOEXEC);
      if (home_ < 0 || there < 0 || setns(there, CLONE_NEWNET) != 0) std::abort();
      close(there);
    }
    ~Visit() {
      if (setns(home_, CLONE_NEWNET) != 0) std::abort();
      close(home_);
    }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    int home_;
  };

 private:
  static bool Ip(const std::string& words) { return std::system(("ip " + words + " 2>/dev/null").c_str()) == 0; }
  static std::string Space(const std::string& name) { return "troupe-test-" + std::to_string(getpid()) + "-" + name; }

  bool Build() {
    const std::string lan = Space("lan");
    bool built = Ip("netns add " + lan) && Ip("-n " + lan + " link add bridge type bridge mcast_snooping 0") &&
                 Ip("-n " + lan + " link set bridge up");
    for (const int host : {1, 2}) {
      const std::string name = std::to_string(host);
      const std::string space = Space(name);
      built = built && Ip("netns add " + space) && Ip("-n " + space + " link set lo up") &&
              Ip("-n " + lan + " link add h" + name + " type veth peer name " + kInterface + " netns " + space) &&
              Ip("-n " + lan + " link set h" + name + " master bridge up") &&
              Ip("-n " + space + " addr add " + AddressOf(host) + "/24 dev " + kInterface) &&
              Ip("-n " + space + " link set " + kInterface + " up");
    }
    return built;
  }
};

}  // namespace troupe::test
