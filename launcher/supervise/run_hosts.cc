#include "launcher/supervise/run_hosts.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "launcher/hosts/connect_hosts.h"
#include "launcher/hosts/host.h"
#include "launcher/hosts/place_robots.h"

namespace troupe {
namespace {

constexpr auto kConnectTimeout = std::chrono::seconds(30);
// s, from an attempt to connect again that has failed, or has had no answer, to the next one.
constexpr double kReconnectPeriod = 5.0;
constexpr double kFirstReconnect = 1.0;  // from the loss to the first attempt
constexpr double kReconnectTimeout = 30.0;

}  // namespace

RunHosts::RunHosts(const RunOptions& options) : options_(options) {
  // Other hosts cannot reach agents on the loopback interface.
  const bool loopback = options.network.network_interface == kLoopbackInterface;
  hosts_.push_back(std::make_unique<LocalHost>(loopback ? Addresses::kSame : Addresses::kRandom));
}

Status RunHosts::Connect(SignalWatch& signals) {
  Result<std::vector<std::unique_ptr<RemoteHost>>> connected =
      ConnectHosts(options_.hosts, options_.network.session, kConnectTimeout, signals);
  if (!connected.ok()) return connected.error();
  for (std::unique_ptr<RemoteHost>& host : connected.value()) hosts_.push_back(std::move(host));
  return Status();
}

std::vector<int> RunHosts::descriptors() const {
  std::vector<int> all;
  for (const std::unique_ptr<Host>& host : hosts_) {
    for (const int descriptor : host->descriptors()) all.push_back(descriptor);
  }
  return all;
}

void RunHosts::OnLoss(Host& host, double now) {
  lost_[&host] = {now + kFirstReconnect - kReconnectPeriod, true};
}

double RunHosts::NextAttempt(const Attempt& attempt) {
  return attempt.since + (attempt.has_failed ? kReconnectPeriod : kReconnectTimeout);
}

std::vector<Host*> RunHosts::Reconnect(double now) {
  std::vector<Host*> connected;
  for (auto& [host, attempt] : lost_) {
    if (!host->PollLoss().ok()) attempt.has_failed = true;
    if (host->connected()) {
      connected.push_back(host);
    } else if (now >= NextAttempt(attempt)) {
      attempt = {now, false};
      host->Reconnect();
    }
  }
  for (Host* host : connected) lost_.erase(host);
  return connected;
}

std::optional<double> RunHosts::NextReconnect() const {
  std::optional<double> next;
  for (const auto& [host, attempt] : lost_) next = std::min(next.value_or(NextAttempt(attempt)), NextAttempt(attempt));
  return next;
}

const HostSettings* RunHosts::service_settings() const {
  const auto found = std::find_if(options_.hosts.rbegin(), options_.hosts.rend(),
                                  [](const HostSettings& host) { return host.service; });
  return found == options_.hosts.rend() ? nullptr : &*found;
}

Host& RunHosts::service_host() const {
  const HostSettings* settings = service_settings();
  return settings == nullptr ? *hosts_[0] : *hosts_[1 + static_cast<std::size_t>(settings - options_.hosts.data())];
}

std::string RunHosts::ServiceAddress(std::uint16_t port) const {
  const HostSettings* settings = service_settings();
  const std::string address =
      settings == nullptr ? LocalAddress(options_.network.network_interface) : settings->address;
  return address + ":" + std::to_string(port);
}

std::vector<AgentSite> RunHosts::AgentSites() const {
  if (options_.hosts.empty()) return {{hosts_[0].get(), options_.network.network_interface}};
  std::vector<AgentSite> sites;
  for (std::size_t i = 0; i < options_.hosts.size(); ++i) {
    sites.push_back({hosts_[1 + i].get(), InterfaceOf(options_.hosts[i])});
  }
  return sites;
}

Result<std::vector<std::size_t>> RunHosts::PlaceOnSites(const std::vector<std::string>& robots) const {
  if (options_.hosts.empty()) return std::vector<std::size_t>(robots.size(), 0);
  return PlaceRobots(robots, options_.hosts);
}

}  // namespace troupe
