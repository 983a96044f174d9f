#include "launcher/hosts/connect_hosts.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>

#include <utility>

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

void WaitForNews(const std::vector<const RemoteHost*>& hosts, const SignalWatch& signals,
                 std::chrono::milliseconds timeout) {
  std::vector<pollfd> waited = {{signals.descriptor(), POLLIN, 0}};
  for (const RemoteHost* host : hosts) {
    for (const int descriptor : host->descriptors()) waited.push_back({descriptor, POLLIN, 0});
  }
  poll(waited.data(), waited.size(), static_cast<int>(timeout.count()));
}

}  // namespace

Result<RemoteHosts> ConnectHosts(const std::vector<HostSettings>& settings, const std::string& session,
                                 std::chrono::seconds timeout, SignalWatch& signals) {
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

std::string LocalAddress(const std::string& network_interface) {
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

}  // namespace troupe
