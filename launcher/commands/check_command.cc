#include "launcher/commands/check_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <set>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/json_tree.h"
#include "common/base/print.h"
#include "common/base/source_text.h"
#include "launcher/commands/commands.h"
#include "recording/recording.h"
#include "robot-agent/controller/create_controller.h"
#include "testing/cases/case_run.h"
#include "testing/cases/test_file.h"
#include "world-service/program/grid_flags.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/sites/site.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Names of the file are printed as plain text here and below: no escape sequence of a world reaches the terminal.
std::string DescribeRobot(const RobotDescription& robot) {
  std::string text =
      fmt::format("  {}: {} drive, controller {}", robot.name, NameOf(robot.drive.type), robot.controller.name);
  for (const SensorDescription& sensor : robot.sensors) {
    text += fmt::format(", {}", sensor.name);
    const std::string summary = SummaryOf(sensor.parameters);
    if (!summary.empty()) text += fmt::format(" ({})", summary);
  }
  return PlainLine(text) + "\n";
}

std::string DescribeJoint(const JointDescription& joint) {
  const bool turns = joint.type == JointType::kRevolute;
  return fmt::format("    joint {}: {} from {:g} to {:g} {}, at most {:g} {}/s\n", joint.name,
                     turns ? "turns" : "shifts", joint.position.min, joint.position.max, turns ? "rad" : "m",
                     joint.max_speed, turns ? "rad" : "m");
}

std::string DescribeGripper(const WorldDescription& world, const GripperDescription& gripper) {
  const std::string lift = gripper.lift ? "lift " + world.joint(*gripper.lift).name : std::string("no lift");
  const std::string text =
      fmt::format("    gripper {}: fingers {} and {}, {}, {}{}", gripper.name, world.joint(gripper.left).name,
                  world.joint(gripper.right).name, lift, CountText(gripper.beams.size(), "beam"),
                  gripper.autosnatch ? ", autosnatch" : "");
  return PlainLine(text) + "\n";
}

std::string DescribeManipulation(const WorldDescription& world, RobotId robot) {
  std::string text;
  for (const JointDescription& joint : world.joints) {
    if (joint.robot == robot) text += DescribeJoint(joint);
  }
  for (const GripperDescription& gripper : world.grippers) {
    if (gripper.robot == robot) text += DescribeGripper(world, gripper);
  }
  return text;
}

// Nothing for a world without objects.
std::string DescribeObjects(const WorldDescription& world) {
  if (world.objects.empty()) return "";
  std::string text = fmt::format("objects: {} (gravity {} m/s^2)\n", world.objects.size(), world.gravity);
  for (ModelId id : world.objects) {
    const ModelDescription& model = world.model(id);
    text +=
        fmt::format("  {}: {:g} x {:g} x {:g} m\n", PlainLine(model.name), model.size_x, model.size_y, model.size_z);
  }
  return text;
}

// Nothing for a world without people.
std::string DescribePeople(const WorldDescription& world) {
  if (world.people.empty()) return "";
  std::set<PersonId> leaders;
  for (const PersonDescription& person : world.people) {
    if (person.leader) leaders.insert(*person.leader);
  }
  return fmt::format("people: {}{}\n", world.people.size(),
                     leaders.empty() ? "" : ", " + CountText(leaders.size(), "group"));
}

// The settings as they will be in a run, defaults included, since a scenario rarely names them all.
std::string DescribeSettings(const LoadedWorld& loaded) {
  const RunSettings& settings = loaded.settings;
  std::string ticks = settings.ticks ? CountText(*settings.ticks, "tick") : "without end";
  const auto text = [](const Speed& speed) {
    return speed ? fmt::format("{} x real time", *speed) : std::string("as fast as possible");
  };
  std::string speed = text(settings.speed);
  if (settings.speed != settings.watched_speed)
    speed += fmt::format(", {} with a viewer", text(settings.watched_speed));
  return fmt::format("run: {}, {} s a tick, seed {}, {}, {}, on_agent_loss {}, {} per process\n", ticks,
                     static_cast<double>(loaded.world.interval_ns) / 1e9, loaded.world.seed, NameOf(settings.mode),
                     speed, NameOf(settings.on_agent_loss), CountText(settings.robots_per_process, "robot"));
}

std::string DescribeLevel(const SiteLevel& level) {
  std::set<std::uint32_t> graphs;
  for (const SiteLane& lane : level.lanes) graphs.insert(lane.graph);
  std::string text = fmt::format("  level {}: elevation {:g} m", level.name, level.elevation);
  if (!level.drawing.empty()) text += fmt::format(", drawing {} of {:.5g} m a pixel", level.drawing, level.scale);
  text += fmt::format(", {}, {}, {}, {} in {}, {}", CountText(level.walls.size(), "wall"),
                      CountText(level.doors.size(), "door"), CountText(level.floors.size(), "floor"),
                      CountText(level.lanes.size(), "lane"), CountText(graphs.size(), "graph"),
                      fmt::format("{} vertices", level.vertices.size()));
  if (!level.human_lanes.empty()) text += ", " + CountText(level.human_lanes.size(), "lane") + " of people";
  return PlainLine(text) + "\n";
}

// The levels and lifts of a building, and its places by their roles; nothing for other worlds.
std::string DescribeSite(const LoadedWorld& loaded) {
  if (loaded.site == nullptr) return "";
  const Site& site = *loaded.site;
  std::string text = PlainLine(fmt::format("building: {}, {}, {}", site.name, CountText(site.levels.size(), "level"),
                                           CountText(site.lifts.size(), "lift"))) +
                     "\n";
  for (const SiteLevel& level : site.levels) text += DescribeLevel(level);
  for (const SiteLift& lift : site.lifts) {
    std::string line = fmt::format("  lift {}: {:g} x {:g} m, at", lift.name, lift.width, lift.depth);
    for (std::size_t i = 0; i < site.levels.size(); ++i) {
      if (!lift.doors_at[i].empty()) line += " " + site.levels[i].name;
    }
    text += PlainLine(line) + "\n";
  }
  std::map<std::string, std::size_t> roles;
  for (const NamedPlace& place : loaded.world.places) {
    for (std::size_t i = 1; i < place.tags.size(); ++i) ++roles[place.tags[i].substr(0, place.tags[i].find(':'))];
  }
  std::string places = fmt::format("  places: {}", loaded.world.places.size());
  for (const auto& [role, count] : roles) places += fmt::format(", {} {}", count, role);
  text += PlainLine(places) + "\n";
  if (site.crowd.people() > 0) {
    text += fmt::format("  crowd: {} people in {}{}\n", site.crowd.people(),
                        CountText(site.crowd.groups.size(), "group"), site.crowd.is_enabled ? "" : ", off");
  }
  return text;
}

// The lanes of a map of cells, and the agents of its problem; nothing for other worlds.
std::string DescribeGrid(const LoadedWorld& loaded) {
  if (loaded.site != nullptr || loaded.world.lane_graphs.empty()) return "";
  const LaneGraph& graph = loaded.world.lane_graphs.front();
  std::string text =
      fmt::format("cells: {} free, {} between them\n", graph.vertices.size(), CountText(graph.lanes.size(), "lane"));
  const std::vector<LaneTrip>& trips = loaded.world.lane_trips;
  if (trips.empty()) return text;
  std::size_t goals = 0;
  std::size_t moves = 0;
  std::uint32_t steps = 0;
  for (const LaneTrip& trip : trips) {
    goals += trip.goals.size();
    moves += trip.path.empty() ? 0 : trip.path.size() - 1;
    steps = std::max(steps, trip.steps.empty() ? 0U : trip.steps.back());
  }
  text += fmt::format("agents: {}, {}", trips.size(), CountText(goals, "goal"));
  if (!trips.front().path.empty())
    text += fmt::format(", paths of {} in {}", CountText(moves, "move"), CountText(steps, "step"));
  return text + "\n";
}

// Models, robots, objects and settings.
std::string DescribeContent(const LoadedWorld& loaded) {
  const WorldDescription& world = loaded.world;
  std::size_t rectangles = 0;
  std::size_t blocks = 0;
  for (const ModelDescription& model : world.models) {
    const Shape& shape = world.shape(model.shape);
    rectangles += shape.area ? shape.area->cover().count() : shape.rectangles.size();
    blocks += shape.blocks.size();
  }
  std::string text = fmt::format("models: {} ({}, {} from bitmaps)\n", world.models.size(), CountText(blocks, "block"),
                                 CountText(rectangles, "rectangle"));
  text += fmt::format("robots: {}\n", world.robots.size());
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    text += DescribeRobot(world.robots[i]) + DescribeManipulation(world, RobotId(i));
  }
  return text + DescribeObjects(world) + DescribePeople(world) + DescribeSettings(loaded);
}

// Seconds of simulated time.
double SecondsOf(const Recording& recording) {
  return static_cast<double>(recording.end_time()) / 1e9;
}

// The damage is printed after the description: the ticks before it can be replayed.
int CheckRecording(const std::string& file) {
  const Result<Recording> opened = Recording::Open(file);
  if (!opened.ok()) return Fail(opened.error());
  const Recording& recording = opened.value();
  const RecordedRun& run = recording.run();
  PrintPlain(stdout, "recording: of troupe {}, step version {}, {}\n", run.program_version, run.step_version, run.file);
  fmt::print("recorded: ticks 0 to {}, {} s simulated, {}, {}, {} bytes\n", recording.spans().greatest(),
             SecondsOf(recording), CountText(recording.spans().all().size() - 1, "edit"),
             CountText(recording.keyframes(), "keyframe"), recording.size());
  LoadedWorld begin;
  begin.world = run.world;
  begin.settings = run.settings;
  for (const NamedExpectation& each : run.expectations) {
    PrintPlain(stdout, "  expect {}: {}\n", each.name, each.text);
  }
  PrintPlain(stdout, "world: {}\n", run.world.name);
  fmt::print("{}", DescribeContent(begin));
  std::fflush(stdout);
  if (recording.damage()) return Fail({{file}, recording.damage()->problem, ErrorCode::kFailure});
  if (const Status damaged = recording.CheckData(); !damaged.ok()) return Fail(damaged.error());
  return kExitDone;
}

// A file with keys of tests, in JSON that can be parsed.
// A scenario and a test may both be .json files; the keys decide. A file that cannot be read or parsed is left to the
// loader, which has the better error.
bool IsTest(const std::string& file) {
  if (file.ends_with(".test.json")) return true;
  if (!file.ends_with(".json")) return false;
  const Result<std::string> text = ReadTextFile(file, {file, 0, 0});
  if (!text.ok()) return false;
  const Result<JsonTree> tree = JsonTree::Parse(text.value(), file);
  if (!tree.ok() || !tree.value().root().is_object()) return false;
  const JsonNode& root = tree.value().root();
  return root.Find("expect") != nullptr || root.Find("cover") != nullptr || root.Find("metrics") != nullptr;
}

// The test, and the world of its first case. Every value of a list is checked in the place of that of the first case.
int CheckTest(const std::string& file) {
  constexpr std::uint64_t kMaxValues = 50;  // of each list
  const Result<TestFile> read = TestFile::Read(file);
  if (!read.ok()) return Fail(read.error());
  const TestFile& test = read.value();
  const CaseWorlds worlds(test);
  const CaseDesign& design = test.design();
  const TestCase first = design.At(0);
  if (const Status status = worlds.Check(first); !status.ok()) return Fail(status.error());
  std::vector<std::string> lines;
  lines.push_back(fmt::format("test: {} ({})", test.name(), CountText(design.size(), "case")));
  for (std::size_t i = 0; i < design.variations().size(); ++i) {
    const Variation& variation = design.variations()[i];
    lines.push_back(fmt::format("  vary {}: {}", variation.path(), variation.Describe()));
    for (std::uint64_t value = 0; value < std::min(variation.size(), kMaxValues); ++value) {
      TestCase draws = first;
      draws[i].value = variation.At(value);
      if (draws == first || !design.MeetsConstraints(draws)) continue;
      if (const Status status = worlds.Check(draws); !status.ok()) return Fail(status.error());
    }
  }
  const LoadedWorld loaded = worlds.Load(first).value();  // Check has loaded it
  const CaseMonitors monitors = CaseMonitors::Make(test, loaded.world, loaded.regions).value();
  for (std::size_t i = 0; i < test.expect().size(); ++i) {
    const std::string formula = monitors.expectations()[i].expectation().formula();
    lines.push_back(fmt::format("  expect {}: {}", test.expect()[i].name, formula));
  }
  for (const TestClause& clause : test.cover())
    lines.push_back(fmt::format("  cover {}: {}", clause.name, clause.text));
  for (std::size_t i = 0; i < test.metrics().size(); ++i) {
    const Metric& metric = monitors.metrics()[i].metric();
    const std::string unit = metric.unit().empty() ? "" : " (" + metric.unit() + ")";
    lines.push_back(fmt::format("  metric {}{}: {}", test.metrics()[i].name, unit, metric.formula()));
  }
  for (const HeatKind kind : test.heat().kinds) {
    lines.push_back(fmt::format("  heat {0}: cells of {1} m x {1} m", NameOf(kind), test.heat().cell));
  }
  for (const std::string& line : lines) PrintPlain(stdout, "{}\n", line);
  fmt::print("{}", DescribeWorld(loaded));
  return kExitDone;
}

int CheckCommand(const std::string& file, const GridOptions& grid, const std::vector<std::string>& robots) {
  if (IsRecordingPath(file)) return CheckRecording(file);
  if (IsTest(file)) return CheckTest(file);
  if (const Status status = CheckControllers(file); !status.ok()) return Fail(status.error());
  LoadOverrides overrides;
  overrides.check_controller = CheckController;  // also of what a scenario adds to a world
  overrides.check_in_world = CheckControllerNeeds;
  overrides.grid = grid;
  overrides.robots = robots;
  const Result<LoadedWorld> loaded = LoadWorld(file, overrides);
  if (!loaded.ok()) return Fail(loaded.error());
  fmt::print("{}", DescribeWorld(loaded.value()));
  return kExitDone;
}

}  // namespace

std::string DescribeWorld(const LoadedWorld& loaded) {
  std::string text = fmt::format("world: {} ({})\n", loaded.world.name, CountText(loaded.files.size(), "file"));
  text += loaded.map_width == 0 ? std::string("map: none\n")
                                : fmt::format("map: {} x {} pixels\n", loaded.map_width, loaded.map_height);
  text += DescribeSite(loaded);
  text += DescribeGrid(loaded);
  text += DescribeContent(loaded);
  text += fmt::format("warnings: {}\n", loaded.warnings.size());
  for (const Warning& warning : loaded.warnings) text += "  " + warning.ToString() + "\n";
  return text;
}

void AddCheckCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("check", "Load a world and describe it, without running it");
  const auto file = std::make_shared<std::string>();
  const auto grid = std::make_shared<GridOptions>();
  const auto robots = std::make_shared<std::vector<std::string>>();
  AddWorldFile(*command, *file);
  AddRobotFilesFlag(*command, *robots);
  AddGridFlags(*command, *grid);
  command->final_callback([=, &exit_status] { exit_status = CheckCommand(*file, *grid, *robots); });
}

Status CheckControllers(const std::string& file, const std::optional<std::string>& controller) {
  if (controller) {
    if (const Status status = CheckController(*controller, "{}"); !status.ok()) {
      return Error{{}, "option --controller: " + status.error().message};
    }
  }
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  return file.ends_with(".json") ? CheckScenario(file, overrides) : Status();
}

}  // namespace troupe
