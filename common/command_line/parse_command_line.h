// Parsing, as all programs do it.
#pragma once

#include <optional>

namespace CLI {
class App;
}

namespace troupe {

// Parses into what the options were declared with. An exit status for a program that has nothing more to do: it has
// printed help or its version, or one line that says what is wrong.
std::optional<int> ParseCommandLine(CLI::App& app, int argc, const char* const* argv);

}  // namespace troupe
