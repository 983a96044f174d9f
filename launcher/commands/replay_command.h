// `troupe replay`: steps a recorded run again, and compares it with the recording.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddReplayCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
