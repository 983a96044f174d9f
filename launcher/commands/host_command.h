// `troupe host`: the remote end of a RemoteHost (launcher/hosts); starts processes here for a launcher on another host.
#pragma once

namespace CLI {
class App;
}

namespace troupe {

// Adds the command; running it sets `exit_status`.
void AddHostCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
