// `troupe keys`: the keys of secured runs.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddKeysCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
