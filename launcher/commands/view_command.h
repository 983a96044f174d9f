// `troupe view`: shows a run in a browser.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddViewCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
