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

// The exit status of a program: that of `run`, or that of a failure, which is printed as one line, if it throws.
int RunProgram(int (*run)(int argc, const char* const* argv), int argc, const char* const* argv);

}  // namespace troupe
