// `troupe help`, and what the help texts have beyond the options: examples, environment, exit statuses. The manual
// pages are made from these texts.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "command_line/parse_command_line.h"
#include "common/base/text.h"
#include "launcher/commands/commands.h"

namespace troupe {
namespace {

struct Example {
  const char* command;  // the path of a command without "troupe"
  const char* line;
  const char* purpose;
};

// Each is run by tests/docs/command_line.py, in a folder with the files that they name.
constexpr Example kExamples[] = {
    {"run", "troupe run office.world", "watch it in the browser until Ctrl-C"},
    {"run", "troupe run office.world --ticks 600 --headless --poses poses.csv", "a minute, as fast as possible"},
    {"run", "troupe run office.world --ticks 600 --headless --record run.mcap", "keep a recording"},
    {"run", "troupe run office.world --robot rover.urdf@2,-0.4,90", "with a robot of URDF"},
    {"run", "troupe run run.mcap --from-tick 300 --controller wander --headless --ticks 400", "branch off from it"},
    {"replay", "troupe replay run.mcap", "step it again, and compare every state"},
    {"replay", "troupe replay run.mcap --from 200 --to 300 --poses part.csv", "the poses of some ticks"},
    {"test", "troupe test office.test.json", "the cases of a test, and what fails"},
    {"test", "troupe test office.test.json --junit results.xml --report report",
     "files for a build server, and a page"},
    {"sweep", "troupe sweep office.test.json -o sweep", "its metrics as tables and plots"},
    {"export", "troupe export run.mcap --format foxglove -o foxglove.mcap", "for Foxglove, Lichtblick and Rerun"},
    {"export", "troupe export run.mcap --format ros2 -o bag", "for 'ros2 bag play bag'"},
    {"export", "troupe export run.mcap --format csv -o tables", "for pandas and spreadsheets"},
    {"check", "troupe check office.world", "its map, models and robots, and warnings"},
    {"top", "troupe top --once", "one table of all running sessions"},
    {"ctl", "troupe ctl pause", "hold the only running session"},
    {"ctl", "troupe ctl step 10", "ten ticks"},
    {"ctl", "troupe ctl spawn chair --pose 5,-0.4,90", "a model of the run's world, in metres and degrees"},
    {"ctl", "troupe ctl set-pose r0 --pose 0,-0.4,0", "move a robot"},
    {"goto", "troupe goto r0 2,-0.4,90", "drive a robot to a pose, and wait until it is there"},
    {"teleop", "troupe teleop r0", "drive it by the keys"},
    {"view", "troupe view run.mcap", "a recording in the browser"},
    {"view", "troupe view --listen 0.0.0.0:8470 --view-only", "the running session, for other hosts"},
    {"edit", "troupe edit office.world", "change a world by mouse"},
    {"snapshot", "troupe snapshot office.world -o office.png", "the world from above"},
    {"snapshot", "troupe snapshot office.world --tick 100 --rays --view side -o side.svg", "after 100 ticks"},
    {"export-map", "troupe export-map office.world -o office.yaml", "for ROS's map_server"},
    {"export-views", "troupe export-views office.world -o office", "for rviz2 -d office.rviz, and Foxglove"},
    {"import-plan", "troupe import-plan hall.svg -o hall.world --unit cm", "the walls of a drawing"},
    {"loopback", "troupe loopback hall.yaml --robot rover.urdf --pose 2,1,90", "in place of nav2_loopback_sim"},
    {"fleet", "troupe fleet check --vda5050 mqtt://localhost --for 60 --junit results.xml",
     "a minute of a fleet at a broker"},
    {"fleet", "troupe fleet check fleet.jsonl", "a log of its messages"},
    {"keys", "troupe keys make keys --robots r0,r1", "for a run over an open network"},
    {"completions", "troupe completions bash > troupe.bash", "for 'source troupe.bash'"},
};

constexpr const char* kEnvironmentAndStatus = R"(Environment:
  TROUPE_SESSION              Name of the session, where --session does not give it
  TROUPE_DOMAIN               DDS domain, where --domain does not give it
  NO_COLOR                    Not empty: no colours, on a terminal neither
  STAGEPATH                   Folders, separated by colons, in which worlds look for files to include
  GZ_SIM_RESOURCE_PATH        And the other variables of Gazebo: folders of models and packages for its files
  ROS_DOMAIN_ID               And the other variables of ROS 2, with --ros: defaults of its options

Exit status:
  0                           Done
  1                           Of 'test': an expectation failed; of 'fleet check': a rule is broken
  2                           Bad input or usage; one line states the text found and the text expected
  3                           The run failed; one line states the reason
  130                         Stopped in order by Ctrl-C, SIGTERM or SIGHUP
)";

// Null: there is none of this name.
CLI::App* Subcommand(CLI::App& command, const std::string& name) {
  for (CLI::App* child : command.get_subcommands([](CLI::App*) { return true; })) {
    if (child->get_name() == name) return child;
  }
  return nullptr;
}

// Prints the help text of the command with this path.
int HelpCommand(CLI::App& app, const std::vector<std::string>& path) {
  CLI::App* command = &app;
  std::string around;
  for (const std::string& name : path) {
    CLI::App* const child = Subcommand(*command, name);
    if (child == nullptr) {
      return Fail(Error{{}, "found no command '" + name + "'" + DidYouMean(name, CommandNames(*command))});
    }
    around += (around.empty() ? "" : " ") + command->get_name();
    command = child;
  }
  std::fputs(command->help(around).c_str(), stdout);
  return kExitDone;
}

}  // namespace

void AddHelpCommand(CLI::App& app, int& exit_status) {
  CLI::App* help = app.add_subcommand("help", "Print the help text of troupe or of one of its commands");
  const auto path = std::make_shared<std::vector<std::string>>();
  help->add_option("COMMAND", *path, "Name of a command, and of one of its commands");
  help->final_callback([path, &app, &exit_status] { exit_status = HelpCommand(app, *path); });

  std::map<std::string, std::string> footers;
  for (const Example& example : kExamples) {
    std::string& footer = footers[example.command];
    if (footer.empty()) footer = "Examples:\n";
    footer += std::string("  ") + example.line + "\n                              " + example.purpose + "\n";
  }
  for (const auto& [command, footer] : footers) Subcommand(app, command)->footer(footer);
  app.footer(kEnvironmentAndStatus);
}

}  // namespace troupe
