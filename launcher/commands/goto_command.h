// `troupe goto`.
#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace troupe {

// `exit_status` receives the result when the command was chosen; it must outlive the parsing.
void AddGotoCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
