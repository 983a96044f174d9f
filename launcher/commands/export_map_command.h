// `troupe export-map`: the map of a world as files for ROS's map_server.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddExportMapCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
