#include "command_line/exclusive_options.h"

#include <CLI/CLI.hpp>
#include <vector>

#include "command_line/parse_command_line.h"

namespace troupe {
namespace {

struct Exclusion {
  std::string_view command;
  const char* option;
  std::vector<const char*> others;  // "--ros-*": all that begin so
};

const std::vector<Exclusion>& Exclusions() {
  static const std::vector<Exclusion> rows = {
      // One process has no agents, no host and no network.
      {"run",
       "--in-process",
       {"--robots-per-process", "--restart-agents", "--on-service-loss", "--journal", "--journal-sync", "--hosts",
        "--interface", "--network", "--security", "--data-sharing", "--lease", "--shuffle-start"}},
      {"run", "--no-ros", {"--ros", "--ros-*"}},
      // The options of a picture of the world do not concern a camera's.
      {"snapshot", "--camera", {"--view", "--rays", "--center", "--meters", "--heights", "--width"}},
      // Without a wait there is no arrival.
      {"goto", "--no-wait", {"--tolerance", "--timeout", "--cancel"}},
      {"goto", "--cancel", {"--tolerance", "--timeout"}},
      // A recorded run is one case, which has been run.
      {"test", "--on", {"--case", "--search", "--shard", "--jobs", "--processes", "--no-shrink", "--case-timeout"}},
      // The cases of a search follow from each other, and are none of the design.
      {"test", "--search", {"--case", "--shard"}},
      // Reports are joined, and no case is run.
      {"sweep", "--merge", {"FILE", "--shard", "--jobs", "--case-timeout"}},
      // A page in a file has no server and follows no run. (--domain may come from the environment.)
      {"view",
       "--static",
       {"--listen", "--token-file", "--view-only", "--journal", "--interface", "--service", "--security"}},
  };
  return rows;
}

}  // namespace

void ExcludeOptions(CLI::App& command, std::string_view name) {
  for (const Exclusion& row : Exclusions()) {
    if (row.command != name) continue;
    CLI::Option* const option = &FindOption(command, row.option);
    for (const std::string_view other : row.others) {
      if (!other.ends_with('*')) {
        option->excludes(&FindOption(command, std::string(other)));
        continue;
      }
      for (CLI::Option* const each : command.get_options()) {
        if (each->get_name().starts_with(other.substr(0, other.size() - 1))) option->excludes(each);
      }
    }
  }
}

}  // namespace troupe
