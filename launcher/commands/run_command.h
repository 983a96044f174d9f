// `troupe run`: a world service and its agents, from start to summary.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddRunCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
