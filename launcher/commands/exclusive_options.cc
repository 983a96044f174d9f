// Which options of these commands exclude each other; run, snapshot, goto and teleop say it beside their options.
#include <CLI/CLI.hpp>

#include "launcher/commands/commands.h"

namespace troupe {

const std::vector<ExclusiveOptions>& ExclusivePairs() {
  static const std::vector<ExclusiveOptions> pairs = {
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
  return pairs;
}

void ExcludeOptions(CLI::App& app) {
  for (const ExclusiveOptions& row : ExclusivePairs()) {
    CLI::App* const command = app.get_subcommand(row.command);
    for (const char* const other : row.others) command->get_option(row.option)->excludes(command->get_option(other));
  }
}

}  // namespace troupe
