#include "common/command_line/parse_command_line.h"

#include <CLI/CLI.hpp>
#include <iostream>

#include "common/command_line/exit_status.h"

namespace troupe {

std::optional<int> ParseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    std::cerr << "error: " << error.what() << "\n";
    return kExitBadInput;
  }
}

}  // namespace troupe
