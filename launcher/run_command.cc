#include "launcher/run_command.h"

#include <fmt/format.h>

#include <cstdio>

#include "launcher/check_controllers.h"
#include "launcher/command_failure.h"
#include "launcher/distributed_run.h"
#include "launcher/in_process_run.h"
#include "launcher/summary.h"
#include "world-service/service/output_file.h"

namespace troupe {
namespace {

Status WriteSummary(const std::string& path, const RunOutcome& outcome) {
  Result<OutputFile> file = OutputFile::Create(path);
  if (!file.ok()) return file.error();
  file.value().Append(SummaryJson(outcome));
  file.value().EndLine();
  return file.value().Close();
}

}  // namespace

int RunCommand(RunOptions options) {
  if (Status failure = CompleteRunOptions(options)) return Fail(kExitBadInput, *failure);
  if (Status failure = CheckControllers(options.file, options.controller)) return Fail(kExitBadInput, *failure);
  RunEnd end = options.in_process ? RunInProcess(options) : RunDistributed(options);
  if (end.error) return Fail(end.exit_status, *end.error);
  if (!end.outcome) return end.exit_status;
  fmt::print("{}", SummaryText(*end.outcome));
  std::fflush(stdout);
  if (!options.summary.empty()) {
    if (Status failure = WriteSummary(options.summary, *end.outcome)) return Fail(kExitFailed, *failure);
  }
  return end.exit_status;
}

}  // namespace troupe
