// `troupe edit`: the page of the viewer as an editor of a file.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddEditCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
