#include "launcher/supervise/service_process.h"

#include <filesystem>
#include <utility>

#include "launcher/supervise/output_files.h"

namespace troupe {

ServiceProcess::ServiceProcess(const RunOptions& options, const RunHosts& hosts)
    : options_(options), hosts_(hosts), journal_parts_("", "--journal"), trace_parts_(options.trace.file, "--trace") {}

RunOptions ServiceProcess::OptionsThere() const {
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
  const RunOptions there = OptionsThere();
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

Status ServiceProcess::Start(const RunKeys& keys) {
  if (!options_.trace.file.empty()) {
    Result<std::string> part = trace_parts_.Add();
    if (!part.ok()) return part.error();
    trace_file_ = std::move(part).value();
  }
  if (Status failure = MakeJournal(); !failure.ok()) return failure;
  return StartProcess(keys, {});
}

Status ServiceProcess::Restart(const RunKeys& keys, const std::vector<std::uint16_t>& ports, bool begun) {
  std::vector<std::string> more = {"--resume"};
  for (const std::uint16_t port : ports) more.push_back("--port=" + std::to_string(port));
  has_begun_ = begun;
  return StartProcess(keys, more);
}

Status ServiceProcess::StartProcess(const RunKeys& keys, const std::vector<std::string>& more) {
  Result<std::string> security = keys.ForService(hosts_.service_host());
  if (!security.ok()) return security.error();
  RunOptions options = OptionsThere();
  options.network.security = std::move(security).value();
  // A run that has begun is in the journal alone.
  if (has_begun_) options.file.clear();
  if (can_restart() && options.record.ends_with(".mcap")) options.record.clear();
  std::vector<std::string> arguments = ServiceArguments(options);
  arguments.insert(arguments.end(), journal_.begin(), journal_.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  Result<std::unique_ptr<Child>> process = hosts_.service_host().Start("world-service", arguments, true);
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

Status ServiceProcess::FetchOutputs(const FetchProgress& progress) const {
  if (hosts_.service_settings() == nullptr) return Status();
  for (const auto& [there, here] : Outputs()) {
    if (here.empty()) continue;
    const std::string& target = here == options_.trace.file ? trace_file_ : here;
    if (Status status = hosts_.service_host().Fetch(there, target, progress); !status.ok()) return status;
  }
  return Status();
}

}  // namespace troupe
