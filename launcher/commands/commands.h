// The commands of `troupe`, each in a file of its own or beside its relatives, and helpers that several of them use.
//
// A command declares its options with all checks that need only their text, so that errors have the form of a command
// line's; its callback sets the exit status and prints errors to standard error. Standard output has results alone, for
// pipes.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"

namespace CLI {

class App;

}  // namespace CLI

namespace troupe {

// Each adds a command; running it sets `exit_status`.
void AddRunCommand(CLI::App& app, int& exit_status);
void AddReplayCommand(CLI::App& app, int& exit_status);
void AddTestCommand(CLI::App& app, int& exit_status);
void AddSweepCommand(CLI::App& app, int& exit_status);
void AddCheckCommand(CLI::App& app, int& exit_status);
void AddTopCommand(CLI::App& app, int& exit_status);
void AddCtlCommand(CLI::App& app, int& exit_status);
void AddGotoCommand(CLI::App& app, int& exit_status);
void AddTeleopCommand(CLI::App& app, int& exit_status);
void AddViewCommand(CLI::App& app, int& exit_status);
void AddEditCommand(CLI::App& app, int& exit_status);
void AddSnapshotCommand(CLI::App& app, int& exit_status);
void AddExportCommand(CLI::App& app, int& exit_status);
void AddExportMapCommand(CLI::App& app, int& exit_status);
void AddKeysCommand(CLI::App& app, int& exit_status);
void AddFleetCommand(CLI::App& app, int& exit_status);
void AddExportViewsCommand(CLI::App& app, int& exit_status);
void AddImportPlanCommand(CLI::App& app, int& exit_status);
void AddLoopbackCommand(CLI::App& app, int& exit_status);
void AddHostCommand(CLI::App& app, int& exit_status);
void AddCompletionsCommand(CLI::App& app, int& exit_status);
// After all others: it also adds examples to the help texts of theirs.
void AddHelpCommand(CLI::App& app, int& exit_status);

// Prints the error, and returns the exit status that follows from its code.
// For a callback: exit_status = Fail(error).
int Fail(const Error& error);

// For the discovery of a service by a tool.
inline constexpr double kDiscoverySeconds = 5.0;

// The session of a tool that is given none: sessions are discovered one after another, so the only one found may not be
// the only one there is. The choice is made after a time without news, longer the less is known.
class SessionChoice {
 public:
  // s, without a further session, until the only one is chosen.
  static constexpr double kMinQuiet = 0.5;
  static constexpr double kMaxQuiet = 2.0;

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

// Values on the command lines of several commands: poses, goals, and the address of a web server.

// A pose with the rule of scenarios: the height may be left out.
struct PoseText {
  Pose X_WE;  // z is 0 if it was left out
  bool has_height = false;
};

// Reads "X,Y,HEADING" or "X,Y,Z,HEADING", in metres and degrees.
Result<PoseText> ParsePoseText(const std::string& text);

// Reads "X,Y" of each point, and of the last one "X,Y" or "X,Y,HEADING", in metres and degrees. REQUIRES: not empty
Result<Goal> ParseGoalText(const std::vector<std::string>& points);

// Of a web server of this host.
struct ListenAddress {
  std::string address;
  std::uint16_t port = 0;
};

// "ADDRESS:PORT", with an IPv4 address.
std::optional<ListenAddress> ParseListen(const std::string& text);

// Adds --listen, which sets `listen` to a text that ParseListen reads.
void AddListenOption(CLI::App& command, std::string& listen);

}  // namespace troupe
