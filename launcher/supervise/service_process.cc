#include "launcher/supervise/service_process.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/json.h"
#include "launcher/hosts/connect_hosts.h"

namespace troupe {
namespace {

constexpr auto kConnectTimeout = std::chrono::seconds(30);
// s, from an attempt to connect again that has failed, or has had no answer, to the next one.
constexpr double kReconnectPeriod = 5.0;
constexpr double kFirstReconnect = 1.0;  // from the loss to the first attempt
constexpr double kReconnectTimeout = 30.0;

}  // namespace

ServiceProcess::ServiceProcess(const RunOptions& options, const RunHosts& hosts)
    : options_(options), hosts_(hosts), journal_parts_("", "--journal"), trace_parts_(options.trace.file, "--trace") {}

// On another host the outputs are in the folder of the run, from where FetchOutputs copies them; the world file has the
// same path on all hosts.
RunOptions ServiceProcess::OptionsOnHost() const {
  RunOptions options = options_;
  options.trace.file = trace_file_;
  const HostSettings* settings = hosts_.service_settings();
  if (settings == nullptr) return options;
  options.network.network_interface = InterfaceOf(*settings);
  options.ros.socket.clear();  // it starts the ros-participant of its host
  options.file = std::filesystem::absolute(options.file).lexically_normal().string();
  const std::string folder = hosts_.service_host().folder() + "/service-";
  if (!options.hash_log.empty()) options.hash_log = folder + "hashes";
  if (!options.poses.empty()) options.poses = folder + "poses";
  // The ending selects the format.
  if (!options.record.empty()) {
    options.record = folder + "record" + std::filesystem::path(options.record).extension().string();
  }
  if (!options.journal.empty()) options.journal = folder + "journal.mcap";
  if (!options.trace.file.empty()) options.trace.file = folder + "trace";
  return options;
}

// The recording of the user, if there is one, is the journal.
Status ServiceProcess::MakeJournal() {
  const RunOptions there = OptionsOnHost();
  const bool records = there.record.ends_with(".mcap");
  if (options_.on_service_loss == OnServiceLoss::kEnd && options_.journal.empty()) return {};
  std::string file = !there.journal.empty() ? there.journal : records ? there.record : std::string();
  if (!file.empty()) {
    journal_ = {"--journal=" + file};
  } else if (hosts_.service_settings() != nullptr) {
    journal_ = {"--journal=" + hosts_.service_host().folder() + "/service-journal.mcap", "--journal-optional"};
  } else {
    std::vector<std::string> parts;
    for (int i = 0; i < 3; ++i) {
      Result<std::string> part = journal_parts_.Add();
      if (!part.ok()) return {};  // the user has not asked for it
      parts.push_back(std::move(part).value());
    }
    journal_ = {"--journal=" + parts[0], "--journal-tail", parts[1], parts[2], "--journal-optional"};
  }
  if (options_.journal_sync) journal_.emplace_back("--journal-sync");
  return {};
}

// For a reader: options about the writing are left out.
std::vector<std::string> ServiceProcess::JournalOptions() const {
  std::vector<std::string> options = hosts_.service_settings() == nullptr ? journal_ : std::vector<std::string>();
  std::erase_if(options, [](const std::string& o) { return o == "--journal-optional" || o == "--journal-sync"; });
  return options;
}

Status ServiceProcess::Start(const RunKeys& keys) {
  if (!options_.trace.file.empty()) {
    Result<std::string> part = trace_parts_.Add();
    if (!part.ok()) return part.error();
    trace_file_ = std::move(part).value();
  }
  if (Status failure = MakeJournal(); !failure.ok()) return failure;
  return StartProcess(keys, {});
}

// A service that died before the run began loads the world file again, as there may be no journal yet.
Status ServiceProcess::Restart(const RunKeys& keys, const std::vector<std::uint16_t>& ports, bool begun) {
  std::vector<std::string> more = {"--resume", fmt::format("--successor={}", ++successors_)};
  for (const std::uint16_t port : ports) more.push_back("--port=" + std::to_string(port));
  has_begun_ = begun;
  return StartProcess(keys, more);
}

// The journal is the recording in that case: a second one would write the same bytes twice.
Status ServiceProcess::StartProcess(const RunKeys& keys, const std::vector<std::string>& more) {
  Result<std::string> security = keys.ForService(hosts_.service_host());
  if (!security.ok()) return security.error();
  RunOptions options = OptionsOnHost();
  options.network.security = std::move(security).value();
  if (has_begun_) {  // in the journal alone, with the changes of a branch
    options.file.clear();
    options.branch = {};
  }
  if (can_restart() && options.record.ends_with(".mcap")) options.record.clear();
  std::vector<std::string> arguments = ServiceArguments(options);
  arguments.insert(arguments.end(), journal_.begin(), journal_.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  Result<std::unique_ptr<Child>> process = hosts_.service_host().Start("world-service", arguments, true);
  if (!process.ok()) return process.error();
  process_ = std::move(process).value();
  return Status();
}

// One kind of line: an agent without an end is present.
void ServiceProcess::TellStart(AgentId agent) const {
  TellEnd(agent, {});
}

void ServiceProcess::TellEnd(AgentId agent, const std::string& end) const {
  nlohmann::json news = {{"agent", fmt::format("{:016x}", agent)}};
  if (!end.empty()) news["end"] = end;
  process_->Tell(JsonText(news));
}

std::vector<std::pair<std::string, std::string>> ServiceProcess::Outputs() const {
  const RunOptions there = OptionsOnHost();
  return {{there.hash_log, options_.hash_log},
          {there.poses, options_.poses},
          {there.record, options_.record},
          {there.trace.file, options_.trace.file}};
}

std::optional<Error> ServiceProcess::OutputFailureIn(const std::string& line) const {
  for (const auto& [there, here] : Outputs()) {
    if (std::optional<Error> failure = OutputFailure(line, there, here)) return failure;
  }
  return std::nullopt;
}

Status ServiceProcess::FetchOutputs(const FetchProgress& progress) const {
  if (hosts_.service_settings() == nullptr) return Status();
  for (const auto& [there, here] : Outputs()) {
    if (here.empty()) continue;
    const std::string& target = here == options_.trace.file ? trace_file_ : here;
    if (Status status = hosts_.service_host().Fetch(there, target, progress); !status.ok()) return status;
  }
  return Status();
}

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

// Written as a failed attempt in the past, so that NextAttempt needs no case for a first attempt.
void RunHosts::OnLoss(Host& host, double now) {
  lost_[&host] = {now + kFirstReconnect - kReconnectPeriod, true};
}

double RunHosts::NextAttempt(const Attempt& attempt) {
  return attempt.since + (attempt.has_failed ? kReconnectPeriod : kReconnectTimeout);
}

// Connecting is asynchronous: an attempt begins here and is seen to have ended in a later call.
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
  const std::string address = settings == nullptr ? OwnAddress(options_.network.network_interface) : settings->address;
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

// Tested, since no setting tells: switches and virtual networks drop multicast silently. An address of the loopback
// interface shows hosts that are simulated on one machine, where nothing is to be tested.
std::vector<std::string> RunHosts::WithoutMulticast(SignalWatch& signals) const {
  if (options_.hosts.empty()) return {};
  const HostSettings* const of_service = service_settings();
  const HostOnNetwork from = {&service_host(),
                              of_service != nullptr ? InterfaceOf(*of_service) : options_.network.network_interface};
  std::vector<HostOnNetwork> to;
  for (const AgentSite& site : AgentSites()) {
    if (site.host != from.first) to.emplace_back(site.host, site.network_interface);
  }
  const auto is_loopback = [](const HostOnNetwork& host) {
    return host.second == kLoopbackInterface || host.second.starts_with("127.");
  };
  if (to.empty() || is_loopback(from) || std::any_of(to.begin(), to.end(), is_loopback)) return {};
  return HostsWithoutMulticast(from, to, options_.network.domain, options_.network.session, signals);
}

Result<std::vector<std::size_t>> RunHosts::PlaceOnSites(const std::vector<std::string>& robots) const {
  if (options_.hosts.empty()) return std::vector<std::size_t>(robots.size(), 0);
  return PlaceRobots(robots, options_.hosts);
}

}  // namespace troupe
