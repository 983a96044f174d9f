// troupe export-views: the configurations of RViz and Foxglove for a world.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/distinct_files.h"
#include "common/base/file.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "launcher/export/view_files.h"
#include "ros/messages/names.h"
#include "world-service/service/requested_file.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

constexpr const char* kRvizEnding = ".rviz";
constexpr const char* kFoxgloveEnding = ".foxglove.json";

struct ExportViewsOptions {
  std::string file;
  std::string output;
  std::vector<std::string> robots;
  bool plain = false;
};

int ExportViewsCommand(const ExportViewsOptions& options) {
  const std::string rviz = options.output + kRvizEnding;
  const std::string foxglove = options.output + kFoxgloveEnding;
  LoadOverrides overrides;
  overrides.robots = options.robots;
  const auto inputs = [&] { return InputFilesOf(options.file, overrides); };
  if (Status problem = CheckDistinct({{"-o", rviz}, {"-o", foxglove}}, inputs); !problem.ok()) {
    return Fail(problem.error());
  }
  const Result<LoadedWorld> loaded = LoadWorld(options.file, overrides);
  if (!loaded.ok()) return Fail(loaded.error());
  const WorldDescription& world = loaded.value().world;
  const ros::RosOptions ros = ros::OptionsFromEnvironment();
  if (!ros.faults.domain.empty()) return Fail({{}, ros.faults.domain});
  const ros::RosNames names{.plain = options.plain};
  if (Status problem = ros::CheckDomains(world, ros.network.domain, names, {}); !problem.ok()) {
    return Fail(problem.error());
  }
  std::vector<std::string> left_out;
  const std::string rviz_text = RvizText(world, ros.network.domain, names, left_out);
  if (Status failure = WriteWholeFile(rviz, rviz_text); !failure.ok()) return Fail(failure.error());
  if (Status failure = WriteWholeFile(foxglove, FoxgloveLayoutText(world)); !failure.ok()) return Fail(failure.error());
  if (!left_out.empty()) {
    PrintPlain(stdout, "not in {}, which has at most {} robots, of the domain {}: {}\n", rviz, kMostShownRobots,
               ros.network.domain, fmt::join(left_out, ", "));
  }
  PrintPlain(stdout, "rviz2 -d {}; Foxglove: Import layout from file, {}\n", rviz, foxglove);
  return kExitDone;
}

}  // namespace

void AddExportViewsCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("export-views", "Write configurations of RViz and Foxglove for a world");
  auto options = std::make_shared<ExportViewsOptions>();
  AddWorldFile(*command, options->file);
  command->add_option("-o,--output", options->output, "Name of the files: NAME.rviz and NAME.foxglove.json are written")
      ->required()
      ->check(NotEmpty())
      ->type_name("NAME");
  AddRobotFilesFlag(*command, options->robots, "");
  command->add_flag("--plain", options->plain, "For a run with --ros-names plain");
  command->final_callback([options, &exit_status] { exit_status = ExportViewsCommand(*options); });
}

}  // namespace troupe
