#include "launcher/supervise/summary.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/base/json_text.h"
#include "common/base/utf8.h"

namespace troupe {
namespace {

std::string HashText(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

std::string ListText(const std::vector<std::string>& names) {
  return PlainLine(fmt::format("{}", fmt::join(names, ", ")));
}

}  // namespace

std::string SummaryText(const RunOutcome& outcome) {
  const RunSummary& run = outcome.run;
  std::string text;
  if (run.interrupted) text += "stopped before its end\n";
  text += fmt::format("{} ticks, {:.1f} s simulated in {:.2f} s: {:.1f} x real time\n", run.ticks, run.sim_seconds,
                      run.wall_seconds, run.real_time_factor);
  text += fmt::format("{} robots, {} {}, first tick after {:.2f} s\n", run.robots, outcome.processes,
                      outcome.processes == 1 ? "process" : "processes", run.startup_seconds);
  text += fmt::format("{} stalls, state hash {}\n", run.stalls, HashText(run.state_hash));
  if (run.rejected > 0) text += fmt::format("{} proposals rejected\n", run.rejected);
  // One process has no network, and its robots take turns: nothing is late.
  const bool distributed = outcome.processes > 1;
  if (distributed && run.frames_repeated > 0) text += fmt::format("{} frames resent\n", run.frames_repeated);
  text += fmt::format("peak memory: {:.1f} MiB", outcome.service_peak_memory_mib);
  if (distributed) {
    text += fmt::format(" the world service, {:.1f} MiB the largest agent", outcome.agent_peak_memory_mib);
  }
  text += "\n";
  if (distributed && !run.slowest.empty()) {
    std::vector<std::string> slowest;
    for (const SlowRobot& slow : run.slowest) {
      auto host = outcome.hosts.find(slow.robot);
      std::string name = slow.robot + (host == outcome.hosts.end() ? "" : " on " + host->second);
      slowest.push_back(fmt::format("{} (last {} times, {:.3f} s)", name, slow.times_last, slow.waited_seconds));
    }
    text += "slowest robots: " + ListText(slowest) + "\n";
  }
  if (run.record_waited_seconds > 0.0) {
    text += fmt::format("ticks waited {:.2f} s for the recording to be written\n", run.record_waited_seconds);
  }
  if (outcome.service_restarted > 0) {
    text += fmt::format("{} {} of the world service, which died\n", outcome.service_restarted,
                        outcome.service_restarted == 1 ? "restart" : "restarts");
  }
  if (outcome.agents_restarted > 0) {
    text += fmt::format("{} {} of agents that died\n", outcome.agents_restarted,
                        outcome.agents_restarted == 1 ? "restart" : "restarts");
  }
  for (const std::string& missing : outcome.missing_files) text += "missing: " + missing + "\n";
  if (!run.lost.empty()) text += "without an agent at the end: " + ListText(run.lost) + "\n";
  return text;
}

std::string SummaryJson(const RunOutcome& outcome) {
  const RunSummary& run = outcome.run;
  nlohmann::ordered_json slowest = nlohmann::ordered_json::array();
  for (const SlowRobot& slow : run.slowest) {
    slowest.push_back(
        {{"robot", slow.robot}, {"times_last", slow.times_last}, {"waited_seconds", slow.waited_seconds}});
    if (auto host = outcome.hosts.find(slow.robot); host != outcome.hosts.end()) slowest.back()["host"] = host->second;
  }
  nlohmann::ordered_json json = {
      {"ticks", run.ticks},
      {"sim_seconds", run.sim_seconds},
      {"wall_seconds", run.wall_seconds},
      {"real_time_factor", run.real_time_factor},
      {"robots", run.robots},
      {"processes", outcome.processes},
      {"agents_restarted", outcome.agents_restarted},
      {"service_restarted", outcome.service_restarted},
      {"startup_seconds", run.startup_seconds},
      {"stalls", run.stalls},
      {"rejected", run.rejected},
      {"frames_repeated", run.frames_repeated},
      {"state_hash", HashText(run.state_hash)},
      {"service_peak_memory_mib", outcome.service_peak_memory_mib},
      {"agent_peak_memory_mib", outcome.agent_peak_memory_mib},
      {"slowest_robots", slowest},
      {"lost", run.lost},
      {"missing_files", outcome.missing_files},
      {"interrupted", run.interrupted},
      {"record_waited_seconds", run.record_waited_seconds},
  };
  return JsonText(json, {.indent = 2});
}

}  // namespace troupe
