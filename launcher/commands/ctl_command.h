// `troupe ctl`: pauses, resumes and steps a run, and edits its world.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddCtlCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
