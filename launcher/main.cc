// The program troupe: runs, checks, observes and draws simulations. docs/running.md is its manual.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>

#include "command_line/exclusive_options.h"
#include "command_line/parse_command_line.h"
#include "common/base/identity.h"
#include "common/base/system_error.h"
#include "launcher/commands/commands.h"

namespace troupe {
namespace {

// Standard output that is lost, as on a full disk, fails the command. A reader that has seen enough, or none from the
// start, does not.
int CheckStandardOutput(int exit_status) {
  if (std::fflush(stdout) == 0 || errno == EPIPE || errno == EBADF) return exit_status;
  const int failed = Fail(SystemError("cannot write to standard output"));
  return exit_status == kExitDone ? failed : exit_status;
}

// Each command sets the status in its callback; without a command the help is printed.
int Main(int argc, const char* const* argv) {
  CLI::App app("Troupe, a distributed 2.5D multi-robot simulator", "troupe");
  app.set_version_flag("--version", std::string("troupe ") + VersionText());
  app.require_subcommand(0, 1);
  int exit_status = kExitDone;
  AddRunCommand(app, exit_status);
  AddReplayCommand(app, exit_status);
  AddTestCommand(app, exit_status);
  AddSweepCommand(app, exit_status);
  AddCheckCommand(app, exit_status);
  AddTopCommand(app, exit_status);
  AddCtlCommand(app, exit_status);
  AddGotoCommand(app, exit_status);
  AddTeleopCommand(app, exit_status);
  AddViewCommand(app, exit_status);
  AddEditCommand(app, exit_status);
  AddSnapshotCommand(app, exit_status);
  AddExportCommand(app, exit_status);
  AddExportMapCommand(app, exit_status);
  AddFleetCommand(app, exit_status);
  AddKeysCommand(app, exit_status);
  AddExportViewsCommand(app, exit_status);
  AddImportPlanCommand(app, exit_status);
  AddLoopbackCommand(app, exit_status);
  AddHostCommand(app, exit_status);
  AddCompletionsCommand(app, exit_status);
  AddHelpCommand(app, exit_status);
  for (CLI::App* const command : app.get_subcommands([](CLI::App*) { return true; })) {
    ExcludeOptions(*command, command->get_name());
  }
  if (const std::optional<int> ended = ParseCommandLine(app, argc, argv)) return CheckStandardOutput(*ended);
  if (app.get_subcommands().empty()) fmt::print("{}", app.help());
  return CheckStandardOutput(exit_status);
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  return troupe::RunProgram(troupe::Main, argc, argv);
}
