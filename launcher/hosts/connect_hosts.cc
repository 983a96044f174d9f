#include "launcher/hosts/connect_hosts.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <string_view>

#include "common/base/glob.h"
#include "worldfile/scenario/scenario.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

using RemoteHosts = std::vector<std::unique_ptr<RemoteHost>>;

// The hosts that have not answered.
std::vector<const RemoteHost*> Unready(const RemoteHosts& hosts) {
  std::vector<const RemoteHost*> unready;
  for (const std::unique_ptr<RemoteHost>& host : hosts) {
    if (!host->connected()) unready.push_back(host.get());
  }
  return unready;
}

std::string NamesOf(const std::vector<const RemoteHost*>& hosts) {
  std::string names;
  for (const RemoteHost* host : hosts) names += (names.empty() ? "" : ", ") + host->name();
  return names;
}

// Wakes for each message, each line of an error stream, and signals.
void WaitForNews(const std::vector<const RemoteHost*>& hosts, const SignalWatch& signals,
                 std::chrono::milliseconds timeout) {
  std::vector<pollfd> waited = {{signals.descriptor(), POLLIN, 0}};
  for (const RemoteHost* host : hosts) {
    for (const int descriptor : host->descriptors()) waited.push_back({descriptor, POLLIN, 0});
  }
  poll(waited.data(), waited.size(), static_cast<int>(timeout.count()));
}

constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

constexpr const char* kGroup = "239.255.0.1";  // of RTPS
constexpr auto kPeriod = std::chrono::milliseconds(20);
constexpr auto kSending = std::chrono::seconds(10);
constexpr auto kListening = std::chrono::seconds(2);
constexpr int kPollMilliseconds = 10;
constexpr unsigned char kHops = 32;  // as Cyclone's

// Exit statuses.
constexpr int kHeard = 0;
constexpr int kNotHeard = 3;
constexpr int kCannotListen = 2;

// Of UDP; closed with the object.
class Socket {
 public:
  Socket() : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Socket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  int get() const { return descriptor_; }
  template <typename Value>
  bool Set(int level, int option, const Value& value) {
    return setsockopt(descriptor_, level, option, &value, sizeof value) == 0;
  }

 private:
  int descriptor_;
};

sockaddr_in GroupAddress(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  inet_pton(AF_INET, kGroup, &address.sin_addr);
  return address;
}

// False for a name that only the start command knows.
bool HasIpv6AddressesOnly(const std::string& address) {
  addrinfo wanted = {};
  wanted.ai_socktype = SOCK_DGRAM;
  addrinfo* first = nullptr;
  if (getaddrinfo(address.c_str(), nullptr, &wanted, &first) != 0) return false;
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(first, &freeaddrinfo);
  for (const addrinfo* one = first; one != nullptr; one = one->ai_next) {
    if (one->ai_family == AF_INET) return false;
  }
  return true;
}

in_addr AddressOf(const std::string& network_interface) {
  in_addr address{};
  inet_pton(AF_INET, OwnAddress(network_interface).c_str(), &address);
  return address;
}

// The probe uses the port of DDS itself, since a firewall may pass some ports and not others.
std::vector<std::string> Arguments(const char* task, const std::string& network_interface, std::uint32_t domain,
                                   const std::string& word) {
  // Data by multicast (RTPS 2.2, section 9.6.1).
  const std::uint32_t port = 7401 + 250 * domain;
  return {"host",   "--multicast",        task,     "--interface", network_interface,
          "--port", std::to_string(port), "--word", word};
}

}  // namespace

// All connections are begun before the first is waited for.
Result<RemoteHosts> ConnectHosts(const std::vector<HostSettings>& settings, const std::string& session,
                                 std::chrono::seconds timeout, SignalWatch& signals) {
  for (const HostSettings& host : settings) {
    if (!HasIpv6AddressesOnly(host.address)) continue;
    return Error{host.where, "found host '" + host.address +
                                 "', which has IPv6 addresses only, expected one with an IPv4 "
                                 "address: the processes of a run find each other by IPv4"};
  }
  RemoteHosts hosts;
  for (const HostSettings& host : settings) {
    Result<std::unique_ptr<RemoteHost>> connection = RemoteHost::Connect(host, session + "/" + host.name);
    if (!connection.ok()) return connection.error();
    hosts.push_back(std::move(connection).value());
  }
  const auto deadline = Clock::now() + timeout;
  while (true) {
    for (const std::unique_ptr<RemoteHost>& host : hosts) {
      host->Receive();
      host->ReadOutput();  // of a login; the error quotes its last line
      if (Status loss = host->PollLoss(); !loss.ok()) return loss.error();
    }
    const std::vector<const RemoteHost*> unready = Unready(hosts);
    if (unready.empty()) return hosts;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) {
      return Failure("no answer from host " + NamesOf(unready) + " within " + std::to_string(timeout.count()) +
                     " s; expected its `start` command to start programs there");
    }
    WaitForNews(unready, signals, left);
    if (signals.ReadStopRequest()) return Failure("stopped while waiting for host " + NamesOf(unready));
  }
}

// IPv4 alone: the processes of a run find each other by it.
std::string OwnAddress(const std::string& network_interface) {
  in_addr address{};
  if (inet_pton(AF_INET, network_interface.c_str(), &address) == 1) return network_interface;
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return "127.0.0.1";
  std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(first, &freeifaddrs);
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    bool reaches_others = (entry->ifa_flags & IFF_UP) != 0 && (entry->ifa_flags & IFF_LOOPBACK) == 0;
    if (network_interface == "auto" ? !reaches_others : network_interface != entry->ifa_name) continue;
    char text[INET_ADDRSTRLEN] = "";
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr, text, sizeof text);
    return text;
  }
  return "127.0.0.1";
}

// Three passes, by falling precision of the request: names, numbers, shares. Each takes robots that no earlier one has
// placed.
Result<std::vector<std::size_t>> PlaceRobots(const std::vector<std::string>& robots,
                                             const std::vector<HostSettings>& hosts) {
  std::vector<std::size_t> places(robots.size(), kNowhere);
  for (std::size_t host = 0; host < hosts.size(); ++host) {
    for (const std::string& pattern : hosts[host].robot_names) {
      bool found = false;
      for (std::size_t robot = 0; robot < robots.size(); ++robot) {
        if (!MatchesGlob(pattern, robots[robot])) continue;
        found = true;
        if (places[robot] == kNowhere) places[robot] = host;
      }
      if (!found) {
        return Error{hosts[host].where,
                     "host " + hosts[host].name + ": found no robot named '" + pattern + "', expected one"};
      }
    }
  }
  std::size_t next = 0;  // no robot before it is without a host
  const auto place = [&](std::size_t host, std::size_t count) {
    for (; next < robots.size() && count > 0; ++next) {
      if (places[next] != kNowhere) continue;
      places[next] = host;
      --count;
    }
  };
  std::size_t sharing = 0;
  for (std::size_t host = 0; host < hosts.size(); ++host) {
    place(host, hosts[host].robot_count.value_or(0));
    if (hosts[host].robot_names.empty() && !hosts[host].robot_count) ++sharing;
  }
  auto left = static_cast<std::size_t>(std::count(places.begin(), places.end(), kNowhere));
  if (left > 0 && sharing == 0) {
    return Error{hosts.front().where, "found hosts for " + std::to_string(robots.size() - left) + " of " +
                                          std::to_string(robots.size()) + " robots, expected a host for each"};
  }
  for (std::size_t host = 0; host < hosts.size(); ++host) {
    if (!hosts[host].robot_names.empty() || hosts[host].robot_count) continue;
    const std::size_t share = (left + sharing - 1) / sharing;
    place(host, share);
    left -= share;
    --sharing;
  }
  return places;
}

// Until it is killed by the prober; the limit is for a prober that dies.
int SendMulticast(const MulticastProbe& probe) {
  Socket socket;
  socket.Set(IPPROTO_IP, IP_MULTICAST_IF, AddressOf(probe.network_interface));
  socket.Set(IPPROTO_IP, IP_MULTICAST_TTL, kHops);
  const sockaddr_in group = GroupAddress(probe.port);
  for (const auto end = Clock::now() + kSending; Clock::now() < end;) {
    sendto(socket.get(), probe.word.data(), probe.word.size(), 0, reinterpret_cast<const sockaddr*>(&group),
           sizeof group);
    poll(nullptr, 0, static_cast<int>(kPeriod.count()));
  }
  return 0;
}

int ListenForMulticast(const MulticastProbe& probe) {
  Socket socket;
  const sockaddr_in group = GroupAddress(probe.port);
  // Participants of other runs may listen at the port, too.
  const bool listens =
      socket.Set(SOL_SOCKET, SO_REUSEADDR, 1) && socket.Set(SOL_SOCKET, SO_REUSEPORT, 1) &&
      bind(socket.get(), reinterpret_cast<const sockaddr*>(&group), sizeof group) == 0 &&
      socket.Set(IPPROTO_IP, IP_ADD_MEMBERSHIP, ip_mreq{group.sin_addr, AddressOf(probe.network_interface)});
  if (!listens) return kCannotListen;
  const auto end = Clock::now() + kListening;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd waited{socket.get(), POLLIN, 0};
    if (left <= 0) return kNotHeard;
    if (poll(&waited, 1, static_cast<int>(left)) <= 0) continue;
    char text[256];
    const ssize_t size = recv(socket.get(), text, sizeof text, MSG_DONTWAIT);
    if (size > 0 && std::string_view(text, static_cast<std::size_t>(size)) == probe.word) return kHeard;
  }
}

// Listeners start before the sender. A host whose listener cannot start or listen is not deaf: nothing is known about
// it, and the profile stays.
std::vector<std::string> HostsWithoutMulticast(const HostOnNetwork& from, const std::vector<HostOnNetwork>& to,
                                               std::uint32_t domain, const std::string& word, SignalWatch& signals) {
  struct Listener {
    Host* host;
    std::unique_ptr<Child> process;
  };
  std::vector<Listener> listeners;
  for (const auto& [host, network_interface] : to) {
    Result<std::unique_ptr<Child>> listener =
        host->Start("troupe", Arguments("listen", network_interface, domain, word), false);
    if (listener.ok()) listeners.push_back({host, std::move(listener).value()});
  }
  const Result<std::unique_ptr<Child>> sender =
      from.first->Start("troupe", Arguments("send", from.second, domain, word), false);
  if (!sender.ok()) return {};
  std::vector<std::string> deaf;
  const auto end = Clock::now() + kSending;
  while (!listeners.empty() && Clock::now() < end) {
    std::vector<pollfd> waited = {{signals.descriptor(), POLLIN, 0}};
    from.first->Receive();
    from.first->ReadOutput();
    for (const Listener& listener : listeners) {
      listener.host->Receive();
      listener.host->ReadOutput();
      for (const int descriptor : listener.host->descriptors()) waited.push_back({descriptor, POLLIN, 0});
    }
    std::erase_if(listeners, [&](const Listener& listener) {
      if (!listener.process->Poll()) return false;
      if (listener.process->end()->exit_code == kNotHeard) deaf.push_back(listener.host->name());
      return true;
    });
    if (signals.ReadStopRequest()) break;
    if (!listeners.empty()) poll(waited.data(), waited.size(), kPollMilliseconds);
  }
  sender.value()->Kill();
  return signals.stop_requested() ? std::vector<std::string>() : deaf;
}

}  // namespace troupe
