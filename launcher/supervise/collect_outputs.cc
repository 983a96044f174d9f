#include "launcher/supervise/collect_outputs.h"

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "common/trace/tick_trace.h"
#include "launcher/supervise/output_files.h"

namespace troupe {

// Copies come before merges, which read the copied parts.
Status CollectOutputs(const RunOptions& options, const RunHosts& hosts, ServiceProcess& service, AgentFleet& agents,
                      SignalWatch& signals, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kCopyLinePeriod = std::chrono::seconds(5);
  Status first;
  // The first failure is usually the cause of the others.
  const auto keep = [&first](Status status) {
    if (first.ok()) first = std::move(status);
  };
  if (!options.hosts.empty()) {
    bool stops = false;
    const auto goes_on = [&] {
      stops = signals.ReadStopRequest() || stops;
      return !stops;
    };
    keep(service.FetchOutputs([&, next_line = Clock::now() + kCopyLinePeriod](std::size_t bytes) mutable {
      if (Clock::now() >= next_line) {
        next_line = Clock::now() + kCopyLinePeriod;
        progress.Tell(fmt::format("copying a file of the world service from host {}: {:.1f} MB",
                                  hosts.service_host().name(), static_cast<double>(bytes) / 1e6));
      }
      return goes_on();
    }));
    keep(agents.FetchOutputs([&](const std::string& line) { progress.Tell(line); }, goes_on));
  }
  // kFree: the parts are not read again, and the disk may not have room for scans twice.
  if (!options.scans.empty()) keep(MergeScans(agents.scan_files(), options.scans, LineFile::Space::kFree));
  if (!options.trace.file.empty()) {
    std::vector<std::string> parts = {service.trace_file()};
    parts.insert(parts.end(), agents.trace_files().begin(), agents.trace_files().end());
    keep(MergeTraces(parts, options.trace.file));
  }
  return first;
}

}  // namespace troupe
