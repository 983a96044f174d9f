// What the programs' command lines have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

namespace troupe {

// Exit statuses of all programs.
inline constexpr int kExitDone = 0;
inline constexpr int kExitBadInput = 2;  // of files or usage
inline constexpr int kExitFailed = 3;
inline constexpr int kExitInterrupted = 130;

// Parses into what the options were declared with. An exit status for a program that has nothing more to do: it has
// printed help or its version, or one line that says what is wrong.
std::optional<int> ParseCommandLine(CLI::App& app, int argc, const char* const* argv);

}  // namespace troupe
