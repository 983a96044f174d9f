// `troupe snapshot`: draws a world.
#pragma once

#include <CLI/CLI.hpp>

namespace troupe {

// Declares the command; it sets `exit_status` when it is run.
void AddSnapshotCommand(CLI::App& app, int& exit_status);

}  // namespace troupe
