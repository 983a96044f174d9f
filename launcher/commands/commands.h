// The commands of `troupe`, each in a file of its own, and what they have in common.
#pragma once

#include "common/run/network_settings.h"
#include "troupe/result.h"

namespace CLI {
class App;
}

namespace troupe {

// Each adds a command; running it sets `exit_status`.
void AddRunCommand(CLI::App& app, int& exit_status);
void AddReplayCommand(CLI::App& app, int& exit_status);
void AddCheckCommand(CLI::App& app, int& exit_status);
void AddTopCommand(CLI::App& app, int& exit_status);
void AddCtlCommand(CLI::App& app, int& exit_status);
void AddGotoCommand(CLI::App& app, int& exit_status);
void AddTeleopCommand(CLI::App& app, int& exit_status);
void AddViewCommand(CLI::App& app, int& exit_status);
void AddEditCommand(CLI::App& app, int& exit_status);
void AddSnapshotCommand(CLI::App& app, int& exit_status);
void AddExportMapCommand(CLI::App& app, int& exit_status);
void AddKeysCommand(CLI::App& app, int& exit_status);
void AddHostCommand(CLI::App& app, int& exit_status);
void AddCompletionsCommand(CLI::App& app, int& exit_status);
// After all others: it also adds examples to the help texts of theirs.
void AddHelpCommand(CLI::App& app, int& exit_status);

// Prints the error, and returns the exit status that follows from its code.
int Fail(const Error& error);

// For the discovery of a service by a tool.
inline constexpr double kDiscoverySeconds = 5.0;

// An empty session becomes the only one in the domain. The error: none was found in kDiscoverySeconds, or several.
Status SelectSession(NetworkSettings& network);

}  // namespace troupe
