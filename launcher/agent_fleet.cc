#include "launcher/agent_fleet.h"

#include <algorithm>
#include <utility>

#include "common/base/random.h"
#include "launcher/network_address.h"

namespace troupe {
namespace {

constexpr double kLongestStartDelay = 0.5;  // s, with --shuffle-start

// The order in which to start `count` agents: as they come, or shuffled (Fisher and Yates).
std::vector<std::size_t> StartOrder(std::size_t count, const std::optional<std::uint64_t>& shuffle) {
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i;
  for (std::size_t i = count; shuffle && i > 1; --i) {
    std::swap(order[i - 1], order[RandomBits({*shuffle, 0, i}) % i]);
  }
  return order;
}

// A word as a shell reads it.
std::string Quoted(const std::string& word) {
  auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("/.,:=_+-").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string quoted = "'";
  for (char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

AgentFleet::AgentFleet(const RunOptions& options, std::string program)
    : options_(options), program_(std::move(program)), scan_parts_(options.scans) {}

Status AgentFleet::Start(const ReadyReport& ready, int output) {
  std::string address = LocalAddress(options_.network_interface) + ":" + std::to_string(ready.port);
  std::size_t packing = options_.robots_per_process.value_or(std::max(1u, ready.robots_per_process));
  std::size_t groups = (ready.robots.size() + packing - 1) / packing;
  for (std::size_t group = 0; group < groups && !options_.scans.empty(); ++group) {
    Result<std::string> file = scan_parts_.Add();
    if (!file.ok()) return file.error();
    scan_files_.push_back(file.value());
  }
  for (std::size_t group : StartOrder(groups, options_.shuffle_start)) {
    auto first = ready.robots.begin() + static_cast<std::ptrdiff_t>(group * packing);
    auto last =
        ready.robots.begin() + static_cast<std::ptrdiff_t>(std::min(ready.robots.size(), (group + 1) * packing));
    std::vector<std::string> robots(first, last);
    std::vector<std::string> command = {program_};
    for (std::string& word : AgentArguments(options_, address, robots, ready.ros)) command.push_back(std::move(word));
    if (!scan_files_.empty()) command.push_back("--scans=" + scan_files_[group]);
    std::string restart_command;
    for (const std::string& word : command) restart_command += (restart_command.empty() ? "" : " ") + Quoted(word);
    if (!scan_files_.empty()) restart_command += " --keep-scans";
    if (options_.shuffle_start) {
      double delay = kLongestStartDelay * RandomUniform({*options_.shuffle_start, 1, group});
      command.push_back("--start-delay=" + std::to_string(delay));
    }
    Result<Process> process = Process::Start(command, output);
    if (!process.ok()) return process.error();
    agents_.push_back({std::move(process).value(), std::move(robots), std::move(restart_command)});
    ++running_;
  }
  return std::nullopt;
}

std::vector<const AgentProcess*> AgentFleet::TakeEnded() {
  std::vector<const AgentProcess*> ended;
  for (AgentProcess& agent : agents_) {
    if (!agent.process.Poll()) continue;
    ended.push_back(&agent);
    --running_;
  }
  return ended;
}

void AgentFleet::Signal(int signal) const {
  for (const AgentProcess& agent : agents_) agent.process.Signal(signal);
}

void AgentFleet::Kill() {
  for (AgentProcess& agent : agents_) agent.process.Kill();
  running_ = 0;
}

double AgentFleet::peak_memory_mib() const {
  double peak = 0.0;
  for (const AgentProcess& agent : agents_) {
    if (agent.process.end()) peak = std::max(peak, agent.process.end()->peak_memory_mib);
  }
  return peak;
}

}  // namespace troupe
