// The program troupe: runs, checks, observes and draws simulations. docs/running.md is its manual.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <optional>

#include "command_line/exit_status.h"
#include "command_line/parse_command_line.h"
#include "common/base/version.h"
#include "launcher/commands/commands.h"

namespace troupe {
namespace {

int Main(int argc, const char* const* argv) {
  CLI::App app("Troupe, a distributed 2.5D multi-robot simulator", "troupe");
  app.set_version_flag("--version", std::string("troupe ") + VersionText());
  app.require_subcommand(0, 1);
  int exit_status = kExitDone;
  AddRunCommand(app, exit_status);
  AddReplayCommand(app, exit_status);
  AddCheckCommand(app, exit_status);
  AddTopCommand(app, exit_status);
  AddCtlCommand(app, exit_status);
  AddGotoCommand(app, exit_status);
  AddTeleopCommand(app, exit_status);
  AddViewCommand(app, exit_status);
  AddEditCommand(app, exit_status);
  AddSnapshotCommand(app, exit_status);
  AddExportMapCommand(app, exit_status);
  AddKeysCommand(app, exit_status);
  AddHostCommand(app, exit_status);
  AddCompletionsCommand(app, exit_status);
  AddHelpCommand(app, exit_status);
  try {
    if (const std::optional<int> ended = ParseCommandLine(app, argc, argv)) return *ended;
    if (app.get_subcommands().empty()) fmt::print("{}", app.help());
    return exit_status;
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  std::signal(SIGXFSZ, SIG_IGN);   // a write beyond the limit fails, as on a full disk
  return troupe::Main(argc, argv);
}
