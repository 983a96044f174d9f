#include "launcher/supervise/viewer_process.h"

#include <signal.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/json.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/run_again.h"

namespace troupe {

// The command line of the run travels as JSON, for the page's button that runs it again and for the command that it
// shows.
Status ViewerProcess::Start(Host& host, const RunOptions& options, const std::string& service_address,
                            const RunKeys& keys, const std::vector<std::string>& journal) {
  const NetworkSettings& network = options.network;
  std::vector<std::string> arguments = {
      "view",
      network.session,
      "--domain=" + std::to_string(network.domain),
      "--interface=" + network.network_interface,
      "--service=" + service_address,
      "--security=" + keys.ForTools(),
      "--run-command=" + JsonText(nlohmann::json(OwnCommandLine()), {.ascii = true}),
      "--scenario=" + options.file,
  };
  if (Progress::IsInteractive()) arguments.emplace_back("--runs-again");
  arguments.insert(arguments.end(), journal.begin(), journal.end());
  Result<std::unique_ptr<Child>> process = host.Start("troupe", arguments, false);
  if (!process.ok()) return process.error();
  process_ = std::move(process).value();
  return Status();
}

Status ViewerProcess::Poll() {
  if (!process_ || !process_->Poll() || stopped_) return Status();
  return Failure("the viewer " + process_->end()->ToString() + "; to start another one: troupe view");
}

void ViewerProcess::Stop() {
  stopped_ = true;
  if (process_) process_->Signal(SIGTERM);
}

void ViewerProcess::Kill() {
  stopped_ = true;
  if (process_) process_->Kill();
}

}  // namespace troupe
