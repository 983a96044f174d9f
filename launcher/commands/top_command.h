// `troupe top`: the sessions of a domain and their progress.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddTopCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
