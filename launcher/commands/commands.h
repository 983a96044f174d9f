// The commands of `troupe`, each in a file of its own, and what they have in common.
#pragma once

#include <set>
#include <string>

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

// Which session is meant by a tool that is given none: sessions are discovered one after another.
class SessionChoice {
 public:
  // s, without a further session, until the only one is chosen.
  static constexpr double kShortestQuiet = 0.3;
  static constexpr double kLongestQuiet = 1.5;

  // The sessions that are discovered now; `all_known`: others than those are not expected. `now`: s since the begin.
  void Update(const std::set<std::string>& found, bool all_known, double now);
  bool is_made() const { return is_made_; }
  const std::set<std::string>& sessions() const { return sessions_; }  // several: none of them is meant

 private:
  std::set<std::string> sessions_;
  double changed_at_ = 0.0;
  bool is_made_ = false;
};

// An empty session becomes the only one in the domain. The error: none was found in kDiscoverySeconds, or several.
Status SelectSession(NetworkSettings& network);

}  // namespace troupe
