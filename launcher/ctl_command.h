// `troupe ctl`: pauses, plays and steps a run.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddCtlCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
