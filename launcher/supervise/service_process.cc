#include "launcher/supervise/service_process.h"

#include <filesystem>
#include <utility>

#include "launcher/supervise/output_failure.h"

namespace troupe {

ServiceProcess::ServiceProcess(const RunOptions& options, const RunHosts& hosts)
    : options_(options), hosts_(hosts), trace_parts_(options.trace.file, "--trace") {}

RunOptions ServiceProcess::OptionsThere() const {
  RunOptions options = options_;
  options.trace.file = trace_file_;
  const HostSettings* settings = hosts_.service_settings();
  if (settings == nullptr) return options;
  options.network.network_interface = InterfaceOf(*settings);
  options.file = std::filesystem::absolute(options.file).lexically_normal().string();
  const std::string folder = hosts_.service_host().folder() + "/service-";
  if (!options.hash_log.empty()) options.hash_log = folder + "hashes";
  if (!options.poses.empty()) options.poses = folder + "poses";
  // The ending selects the format.
  if (!options.record.empty()) {
    options.record = folder + "record" + std::filesystem::path(options.record).extension().string();
  }
  if (!options.trace.file.empty()) options.trace.file = folder + "trace";
  return options;
}

Status ServiceProcess::Start(const RunKeys& keys) {
  if (!options_.trace.file.empty()) {
    Result<std::string> part = trace_parts_.Add();
    if (!part.ok()) return part.error();
    trace_file_ = std::move(part).value();
  }
  Result<std::string> security = keys.ForService(hosts_.service_host());
  if (!security.ok()) return security.error();
  RunOptions options = OptionsThere();
  options.network.security = std::move(security).value();
  Result<std::unique_ptr<Child>> process =
      hosts_.service_host().Start("world-service", ServiceArguments(options), true);
  if (!process.ok()) return process.error();
  process_ = std::move(process).value();
  return Status();
}

std::vector<std::pair<std::string, std::string>> ServiceProcess::Outputs() const {
  const RunOptions there = OptionsThere();
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

Status ServiceProcess::FetchOutputs() const {
  if (hosts_.service_settings() == nullptr) return Status();
  for (const auto& [there, here] : Outputs()) {
    if (here.empty()) continue;
    const std::string& target = here == options_.trace.file ? trace_file_ : here;
    if (Status status = hosts_.service_host().Fetch(there, target); !status.ok()) return status;
  }
  return Status();
}

}  // namespace troupe
