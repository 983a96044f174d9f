// ParseCommandLine: the same for all programs.
#pragma once

#include <optional>

namespace CLI {
class App;
}

namespace troupe {

// Parses into the variables with which the options were declared. Nothing: the program continues. An exit status: the
// program ends with it; its help, its version, or an error of one line has been printed.
std::optional<int> ParseCommandLine(CLI::App& app, int argc, const char* const* argv);

}  // namespace troupe
