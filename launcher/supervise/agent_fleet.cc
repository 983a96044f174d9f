#include "launcher/supervise/agent_fleet.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "command_line/run_flags.h"
#include "common/base/identity.h"
#include "troupe/check.h"
#include "troupe/random.h"

namespace troupe {
namespace {

constexpr double kMaxStartDelay = 0.5;  // s, with --shuffle-start

// Limits of agents per host that are started and have not joined. docs/performance-trials.md has figures. When several
// agents request the same discovery data at once, Cyclone sends it to all agents of their group that have joined, so
// that on one machine, where an agent joins quickly, few start at a time. With security, an agent waits a third of a
// second for timers of the handshake, without work.
constexpr std::size_t kMaxStarting = 16;
constexpr std::size_t kMaxStartingOnOneMachine = 6;
constexpr std::size_t kMaxStartingSecured = 64;

// The order in which `count` agents are started: by index, or shuffled (Fisher and Yates).
std::vector<std::size_t> StartOrder(std::size_t count, const std::optional<std::uint64_t>& shuffle) {
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i;
  for (std::size_t i = count; shuffle && i > 1; --i) {
    // Counter-based, so that a failure of a shuffled start can be repeated by its number.
    std::swap(order[i - 1], order[RandomBits({*shuffle, 0, i}) % i]);
  }
  return order;
}

// Robots that share a process.
// A group becomes one agent process.
struct Group {
  std::size_t site;
  std::vector<std::string> robots;
};

// Groups consecutive robots of one site, so that the scan files of the groups are in the order of robots.
std::vector<Group> MakeGroups(const std::vector<std::string>& robots, const std::vector<std::size_t>& site_of_robot,
                              std::size_t packing) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (groups.empty() || groups.back().site != site_of_robot[i] || groups.back().robots.size() == packing) {
      groups.push_back({site_of_robot[i], {}});
    }
    groups.back().robots.push_back(robots[i]);
  }
  return groups;
}

constexpr auto kCopyReportPeriod = std::chrono::seconds(5);

}  // namespace

AgentFleet::AgentFleet(const RunOptions& options, const RunKeys& keys)
    : options_(options), keys_(keys), scans_("--scans", options.scans), traces_("--trace", options.trace.file) {}

Status AgentFleet::Start(const ReadyReport& ready, const std::vector<std::string>& service_addresses,
                         const std::vector<AgentSite>& sites, const std::vector<std::size_t>& site_of_robot) {
  sites_ = sites;
  ready_ = ready;
  service_addresses_ = service_addresses;
  if (Status failure = Plan(ready.robots, site_of_robot, Occasion::kAtBegin); !failure.ok()) return failure;
  return StartAfterJoins(0);
}

Status AgentFleet::StartAfterJoins(std::size_t agents) {
  const bool is_one_machine = options_.network.data_sharing && sites_.size() == 1;
  const std::size_t starting = keys_.secured()  ? kMaxStartingSecured
                               : is_one_machine ? kMaxStartingOnOneMachine
                                                : kMaxStarting;
  // Without multicast few at first, and as many more as have joined: over a slow link, what is sent to many agents at
  // once is lost, sent again, and lost again.
  const bool is_unicast = options_.network.network_profile == kUnicastProfile && sites_.size() > 1;
  const std::size_t limit = starting * sites_.size();
  return StartUpTo(agents + (is_unicast ? std::min(limit, sites_.size() + agents) : limit));
}

Status AgentFleet::Add(const std::vector<std::string>& robots, const std::vector<std::size_t>& site_of_robot) {
  if (Status failure = Plan(robots, site_of_robot, Occasion::kOfNewRobots); !failure.ok()) return failure;
  return StartUpTo(size());
}

Status AgentFleet::Plan(const std::vector<std::string>& robots, const std::vector<std::size_t>& site_of_robot,
                        Occasion occasion) {
  const std::size_t packing = std::max(1u, ready_.robots_per_process);
  std::vector<Group> groups = MakeGroups(robots, site_of_robot, packing);
  const std::size_t first = group_sites_.size();
  // Pointers into sites_, which does not change after Start.
  for (const Group& group : groups) group_sites_.push_back(&sites_[group.site]);
  // Before any process starts: a part for each group, by index of the group, whatever the order of starts.
  if (Status status = scans_.AddParts(groups.size()); !status.ok()) return status;
  if (Status status = traces_.AddParts(groups.size()); !status.ok()) return status;
  for (const std::size_t index : StartOrder(groups.size(), options_.shuffle_start)) {
    waiting_.push_back({first + index, std::move(groups[index].robots), occasion});
    if (options_.shuffle_start) {
      waiting_.back().delay = kMaxStartDelay * RandomUniform({*options_.shuffle_start, 1, index});
    }
  }
  return Status();
}

Status AgentFleet::StartUpTo(std::size_t agents) {
  while (agents_.size() < agents && !waiting_.empty()) {
    WaitingAgent next = std::move(waiting_.front());
    waiting_.pop_front();
    if (Status failure = StartAgent(std::move(next)); !failure.ok()) return failure;
  }
  return Status();
}

// The options are copied and adapted to the site; AgentArguments alone knows the command line of the program.
Result<std::vector<std::string>> AgentFleet::ArgumentsOf(std::size_t group, const std::vector<std::string>& robots,
                                                         Occasion occasion) const {
  const AgentSite& site = *group_sites_[group];
  RunOptions options = options_;
  options.network.network_interface = site.network_interface;
  // In turn, so that of those that start at a time few use one participant.
  const std::size_t served_by = group % ready_.participants.size();
  options.network.service_participant = ready_.participants[served_by].participant;
  if (!options_.hosts.empty()) options.ros.socket.clear();  // agents on other hosts start their own ros-participant
  std::optional<bool>& infinite_ranges = options.ros.robots.infinite_ranges;
  infinite_ranges = infinite_ranges.value_or(ready_.ros_infinite_ranges);
  Result<std::string> security = keys_.ForAgent(*site.host, robots);
  if (!security.ok()) return security.error();
  options.network.security = std::move(security).value();
  std::vector<std::string> arguments =
      AgentArguments(options, service_addresses_[served_by], robots, ready_.libraries, ready_.ros);
  if (!scans_.empty()) arguments.push_back("--scans=" + scans_.PathOn(*site.host, group));
  // A robot may have been deleted before its agent is there; and one that was deleted and has returned has another
  // agent than the process that it began with, which keeps its name (AgentName) with all robots that it ever had.
  if (occasion != Occasion::kAtBegin) arguments.emplace_back("--skip-unavailable");
  if (occasion == Occasion::kAgain && !scans_.empty()) arguments.emplace_back("--keep-scans");
  return arguments;
}

Status AgentFleet::StartAgent(WaitingAgent agent) {
  const AgentSite& site = *group_sites_[agent.group];
  Result<std::vector<std::string>> made = ArgumentsOf(agent.group, agent.robots, agent.occasion);
  if (!made.ok()) return made.error();
  std::vector<std::string> arguments = std::move(made).value();
  // Not for a restart: the file has the trace of the lost agent.
  if (!traces_.empty()) {
    for (std::string& argument : TraceArguments(options_.trace, traces_.PathOn(*site.host, agent.group))) {
      arguments.push_back(std::move(argument));
    }
  }
  if (agent.delay > 0.0) arguments.push_back("--start-delay=" + std::to_string(agent.delay));
  Result<StartedProcess> started = StartProcess(agent.group, std::move(arguments));
  if (!started.ok()) return started.error();
  auto& [id, process] = started.value();
  agents_.push_back({agents_.size(), id, std::move(process), site.host, agent.group, std::move(agent.robots)});
  return Status();
}

Result<AgentFleet::StartedProcess> AgentFleet::StartProcess(std::size_t group, std::vector<std::string> arguments) {
  // Random and not counted: the service must not take a restarted agent, or one of another run, for its predecessor.
  const AgentId id = MakeRandomId();
  arguments.push_back(fmt::format("--agent-id={:016x}", id));
  Result<std::unique_ptr<Child>> process = group_sites_[group]->host->Start("robot-agent", arguments, false);
  if (!process.ok()) return process.error();
  ++running_;
  started_.push_back(id);
  return StartedProcess{id, std::move(process).value()};
}

Status AgentFleet::Restart(std::size_t number) {
  AgentProcess& agent = agents_.at(number);
  TROUPE_CHECK(!agent.process->running());
  Result<std::vector<std::string>> arguments = ArgumentsOf(agent.group, agent.robots, Occasion::kAgain);
  if (!arguments.ok()) return arguments.error();
  Result<StartedProcess> started = StartProcess(agent.group, std::move(arguments).value());
  if (!started.ok()) return started.error();
  // The figure of the process that is replaced, whose end is lost with it.
  peak_memory_mib_ = peak_memory_mib();
  agent.id = started.value().id;
  agent.process = std::move(started.value().process);
  return Status();
}

// It is printed for the user once automatic restarts are used up: the robots are frozen until then.
Result<std::string> AgentFleet::RestartCommand(std::size_t number) const {
  const AgentProcess& agent = agents_.at(number);
  const Result<std::vector<std::string>> arguments = ArgumentsOf(agent.group, agent.robots, Occasion::kAgain);
  if (!arguments.ok()) return arguments.error();
  return ShellQuoted(agent.host->ProgramPath("robot-agent")) + " " + ShellQuoted(arguments.value());
}

// Only the participants change: ports and addresses are those of the first service.
void AgentFleet::SetService(const std::vector<ServiceParticipant>& participants) {
  for (std::size_t group = 0; group < std::min(ready_.participants.size(), participants.size()); ++group) {
    ready_.participants[group].participant = participants[group].participant;
  }
}

// Poll is true once for each end, so that no end is reported twice.
std::vector<std::size_t> AgentFleet::PollEnded() {
  std::vector<std::size_t> ended;
  for (const AgentProcess& agent : agents_) {
    if (!agent.process->Poll()) continue;
    ended.push_back(agent.number);
    --running_;
  }
  return ended;
}

void AgentFleet::Signal(int signal) const {
  for (const AgentProcess& agent : agents_) agent.process->Signal(signal);
}

void AgentFleet::Kill() {
  for (AgentProcess& agent : agents_) agent.process->Kill();
  running_ = 0;
}

double AgentFleet::peak_memory_mib() const {
  double peak = peak_memory_mib_;
  for (const AgentProcess& agent : agents_) {
    if (agent.process->end()) peak = std::max(peak, agent.process->end()->peak_memory_mib);
  }
  return peak;
}

std::map<std::string, std::string> AgentFleet::hosts() const {
  std::map<std::string, std::string> hosts;
  for (const AgentProcess& agent : agents_) {
    if (agent.host->name().empty()) continue;
    for (const std::string& robot : agent.robots) hosts[robot] = agent.host->name();
  }
  return hosts;
}

std::optional<Error> AgentFleet::OutputFailureIn(const std::string& line, const Host& host) const {
  const std::optional<Error> failure = scans_.FailureIn(line, host);
  return failure ? failure : traces_.FailureIn(line, host);
}

void AgentFleet::NoteLostFiles(const Host& host) {
  if (!lost_hosts_.insert(&host).second) return;
  for (const AgentOutput* output : {&scans_, &traces_}) {
    if (output->empty()) continue;
    std::vector<std::string> robots;
    for (const AgentProcess& agent : agents_) {
      if (agent.host == &host) robots.insert(robots.end(), agent.robots.begin(), agent.robots.end());
    }
    if (robots.empty()) continue;
    missing_files_.push_back(
        fmt::format("{} of {} until host {} was lost", output->option(), ListText(robots), host.name()));
  }
}

// A failure does not end the copies: files of the other hosts may be complete.
Status AgentFleet::FetchOutputs(const std::function<void(const std::string&)>& tell,
                                const std::function<bool()>& goes_on) {
  std::size_t files = 0;
  for (const AgentOutput* output : {&scans_, &traces_}) files += output->files().size();
  std::size_t file = 0;
  std::size_t bytes = 0;  // of the files before
  auto next_line = std::chrono::steady_clock::now() + kCopyReportPeriod;
  Status first_failure;
  for (const AgentOutput* output : {&scans_, &traces_}) {
    for (std::size_t group = 0; group < output->files().size(); ++group, ++file) {
      Host& host = *group_sites_[group]->host;
      if (!host.connected()) continue;
      std::size_t of_file = 0;
      Status status = output->Fetch(host, group, [&](std::size_t copied) {
        of_file = copied;
        if (const auto now = std::chrono::steady_clock::now(); now >= next_line) {
          next_line = now + kCopyReportPeriod;
          tell(fmt::format("copying {} from the hosts: file {} of {}, {:.1f} MB", output->option(), file + 1, files,
                           static_cast<double>(bytes + of_file) / 1e6));
        }
        return goes_on();
      });
      bytes += of_file;
      if (!host.connected()) NoteLostFiles(host);
      // After a loss its agents may not have been started again, and have no files there.
      if (!status.ok() && first_failure.ok() && !lost_hosts_.contains(&host)) first_failure = status;
    }
  }
  return first_failure;
}

}  // namespace troupe
