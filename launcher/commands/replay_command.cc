#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/distinct_files.h"
#include "common/base/file.h"
#include "common/base/text.h"
#include "common/base/thread_pool.h"
#include "launcher/commands/commands.h"
#include "robot-agent/agent/replica.h"
#include "troupe/result.h"
#include "world-service/core/step.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/replay/run_replay.h"

namespace troupe {
namespace {

// ControllerCheck: runs the controllers of a recorded run again, on the recorded states, and compares their proposals
// with the recorded ones. docs/recording.md says which robots are compared.
class ControllerCheck {
 public:
  // The error is a run in which proposals do not follow from the states: mode realtime.
  static Result<ControllerCheck> Create(const Recording& recording);

  // Lets the robots decide on the state of `world`, and compares with `next`, which follows it. Call it with each state
  // from the start of the run. Returns the first difference. The error is a controller that cannot be made.
  Result<std::optional<std::string>> Check(const ReplayedWorld& world, const RecordedTick& next);

  std::uint64_t compared() const { return compared_; }  // proposals
  // Robots whose agents were lost: their controllers are not compared from then on. By name.
  const std::set<std::string>& lost() const { return lost_; }

 private:
  explicit ControllerCheck(const Recording& recording) : settings_(recording.run().settings) {}

  // Changes the replicas as the agents of the run did.
  Status Follow(const ReplayedWorld& world);
  Status AddReplica(const ReplayedWorld& world, const std::vector<std::string>& robots);
  void NoteLosses(const WorldDescription& world, const RecordedTick& next);
  std::optional<std::string> Compare(const ReplayedWorld& world, const RecordedTick& next);

  const RunSettings& settings_;
  // A robot that an edit adds has an agent of its own.
  std::vector<std::unique_ptr<Replica>> replicas_;
  const std::shared_ptr<ThreadPool> pool_ = std::make_shared<ThreadPool>(std::thread::hardware_concurrency());
  std::shared_ptr<const Scene> scene_;  // of the replicas
  Edition edition_ = 0;                 // of the state
  Edition followed_edition_ = 0;        // by the replicas
  Edition fresh_edition_ = 0;
  std::set<std::string> absent_;   // robots without an agent
  std::set<std::string> unknown_;  // robots whose agents were lost since they were made
  std::set<std::string> lost_;
  std::uint64_t compared_ = 0;
};

struct Number {
  std::string name;
  double value = 0.0;
};

// The numbers of a proposal.
// With names, so that a difference is told in the terms of the robot.
std::vector<Number> NumbersOf(const WorldDescription& world, const Proposal& proposal) {
  std::vector<Number> numbers = {{"vx", proposal.twist.vx}, {"vy", proposal.twist.vy}, {"wz", proposal.twist.wz}};
  std::size_t joint = 0;
  for (const JointDescription& description : world.joints) {
    if (description.robot != proposal.robot || joint == proposal.joint_velocities.size()) continue;
    numbers.push_back({"velocity of joint " + description.name, proposal.joint_velocities[joint++]});
  }
  return numbers;
}

// Empty if both are equal.
// Compared exactly: any difference at all shows that the controller is not a function of its inputs.
std::string DifferenceOf(const WorldDescription& world, const Proposal& found, const Proposal& expected) {
  const std::vector<Number> mine = NumbersOf(world, found);
  const std::vector<Number> recorded = NumbersOf(world, expected);
  for (std::size_t i = 0; i < std::min(mine.size(), recorded.size()); ++i) {
    if (mine[i].value == recorded[i].value) continue;
    return fmt::format("the {} is {}, expected {}", mine[i].name, mine[i].value, recorded[i].value);
  }
  if (mine.size() == recorded.size()) return {};
  return fmt::format("the number of joint velocities is {}, expected {}", found.joint_velocities.size(),
                     expected.joint_velocities.size());
}

// Deleted robots stay in the description, as ids are places in its lists.
std::vector<std::string> RobotsOf(const WorldDescription& world) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i))) names.push_back(world.robots[i].name);
  }
  return names;
}

Result<ControllerCheck> ControllerCheck::Create(const Recording& recording) {
  if (recording.run().settings.mode == Mode::kRealtime) {
    return Error{{recording.name()},
                 "found a recording of mode realtime, in which late robots repeat proposals; expected one of mode "
                 "lockstep to run the controllers again"};
  }
  return ControllerCheck(recording);
}

Status ControllerCheck::AddReplica(const ReplayedWorld& world, const std::vector<std::string>& robots) {
  if (robots.empty()) return {};
  RobotOptions options;
  options.libraries = AllowedPaths::All();  // as of the user's own scenario
  Result<std::unique_ptr<Replica>> replica = Replica::Create(world.scene(), robots, options, pool_);
  if (!replica.ok()) return replica.error();
  replicas_.push_back(std::move(replica).value());
  return {};
}

// An edit may replace the world, set robots elsewhere or restart the run: the replicas follow as agents do.
Status ControllerCheck::Follow(const ReplayedWorld& world) {
  const bool fresh = world.fresh_edition() != fresh_edition_;
  const bool is_first = scene_ == nullptr;
  if (fresh) unknown_.clear();
  fresh_edition_ = world.fresh_edition();
  for (const auto& replica : replicas_) {
    Status changed;
    if (world.scene() != scene_) {
      changed = replica->ChangeWorld(world.scene(), fresh, fresh_edition_);
    } else if (fresh) {
      changed = replica->Renew(fresh_edition_);
    }
    if (!changed.ok()) return changed;
    if (edition_ != followed_edition_) replica->Relocate(world.state());
  }
  followed_edition_ = edition_;
  if (world.scene() == scene_) return {};
  scene_ = world.scene();
  std::erase_if(replicas_, [](const auto& replica) { return !replica->has_robots(); });
  std::set<std::string> known;
  for (const auto& replica : replicas_) {
    for (const std::string& name : replica->RobotNames()) known.insert(name);
  }
  std::vector<std::string> others = RobotsOf(world.world());
  std::erase_if(others, [&](const std::string& name) { return known.contains(name); });
  if (!is_first) {
    for (const std::string& name : others) unknown_.erase(name);
  }
  return AddReplica(world, others);
}

void ControllerCheck::NoteLosses(const WorldDescription& world, const RecordedTick& next) {
  if (settings_.on_agent_loss == OnAgentLoss::kRebuild) return;  // its memory is restored
  for (const Event& event : next.events) {
    if (!event.robot || event.robot->index() >= world.robots.size()) continue;
    const std::string& name = world.robot(*event.robot).name;
    if (event.type == EventType::kJoined) absent_.erase(name);
    if (event.type != EventType::kLeft) continue;
    absent_.insert(name);
    unknown_.insert(name);
  }
}

// A record is a step, whose proposals are compared, or an edit, before which agents are paused.
Result<std::optional<std::string>> ControllerCheck::Check(const ReplayedWorld& world, const RecordedTick& next) {
  if (next.number == 0) return std::optional<std::string>();
  if (Status problem = Follow(world); !problem.ok()) return problem.error();
  NoteLosses(world.world(), next);
  if (next.is_step()) return Compare(world, next);
  for (const auto& replica : replicas_) replica->Pause(world.state());  // an edit follows
  edition_ = next.edition;
  return std::optional<std::string>();
}

// Both lists are in the order of robots, and are compared in one pass.
std::optional<std::string> ControllerCheck::Compare(const ReplayedWorld& world, const RecordedTick& next) {
  std::vector<Proposal> decided;
  for (const auto& replica : replicas_) {
    for (Proposal& proposal : replica->Retrace(world.state(), next.commands)) decided.push_back(std::move(proposal));
  }
  std::sort(decided.begin(), decided.end(), [](const Proposal& a, const Proposal& b) { return a.robot < b.robot; });
  auto recorded = next.proposals.begin();
  for (const Proposal& proposal : decided) {
    while (recorded != next.proposals.end() && recorded->robot < proposal.robot) ++recorded;
    const bool is_recorded = recorded != next.proposals.end() && recorded->robot == proposal.robot;
    const std::string& name = world.world().robot(proposal.robot).name;
    if (unknown_.contains(name) || (absent_.contains(name) && !is_recorded)) {
      lost_.insert(name);
      continue;
    }
    // The service refused a proposal that is not valid.
    const bool is_valid = ValidateProposal(*world.scene(), world.state(), proposal).ok();
    std::string difference;
    if (is_valid != is_recorded) {
      difference =
          is_valid ? "the proposal is valid, expected none that is" : "the proposal is not valid, expected one";
    } else if (is_recorded) {
      difference = DifferenceOf(world.world(), proposal, *recorded);
    }
    ++compared_;
    if (difference.empty()) continue;
    return fmt::format("tick {}: robot {}: {}{}", next.tick, name, difference,
                       settings_.ros ? "; a command of ROS 2 may be the cause, which a recording does not have" : "");
  }
  return std::nullopt;
}

using Clock = std::chrono::steady_clock;

struct ReplayArguments {
  std::string file;
  bool verify = false;
  bool controllers = false;
  bool force = false;
  std::optional<std::uint64_t> from;
  std::optional<std::uint64_t> to;
  OutputFiles outputs;
  std::string scans;
};

// A status line on a terminal, for replays that take longer than a moment.
class ReplayProgress {
 public:
  ~ReplayProgress() {
    if (shown_) fmt::print(stderr, "\r\033[K");
  }
  void Update(Tick tick, double share) {
    if (!terminal_ || Clock::now() < next_) return;
    next_ = Clock::now() + std::chrono::milliseconds(500);
    shown_ = true;
    fmt::print(stderr, "\r\033[Ktick {}, {:.0f} %", tick, 100.0 * share);
    std::fflush(stderr);
  }

 private:
  const bool terminal_ = isatty(STDERR_FILENO) == 1;
  bool shown_ = false;
  Clock::time_point next_ = Clock::now() + std::chrono::milliseconds(500);
};

Status CheckOutputs(const ReplayArguments& arguments) {
  const std::vector<OutputName> outputs = {
      {"--hash-log", arguments.outputs.hash_log}, {"--poses", arguments.outputs.poses}, {"--scans", arguments.scans}};
  const auto inputs = [&] { return std::vector{arguments.file}; };
  if (Status problem = CheckDistinct(outputs, inputs); !problem.ok()) return problem;
  for (const auto& [option, path] : outputs) {
    if (path.empty()) continue;
    if (const Status status = CheckWritable(path); !status.ok()) {
      return Error{{path}, "cannot write: " + status.error().message};
    }
  }
  return {};
}

// "601 states, of ticks 0 to 600"
std::string StatesText(const ReplayReport& report) {
  if (report.states == 0) return "no state";
  return fmt::format("{} states, of ticks {} to {},", report.states, report.first, report.last);
}

std::string ControllersText(const ControllerCheck& check) {
  std::string text = fmt::format("{} proposals of controllers are equal\n", check.compared());
  if (!check.lost().empty()) {
    text += fmt::format("not compared since their agents were lost: {}\n",
                        PlainLine(fmt::format("{}", fmt::join(check.lost(), ", "))));
  }
  return text;
}

// A difference is a failure and not bad input: the file is in order, the step is not deterministic or another one.
int ReplayCommand(const ReplayArguments& arguments) {
  if (const Status problem = CheckOutputs(arguments); !problem.ok()) return Fail(problem.error());
  const Result<Recording> recording = Recording::Open(arguments.file);
  if (!recording.ok()) return Fail(recording.error());
  if (const Status other = CheckStepVersion(recording.value()); !other.ok() && !arguments.force) {
    Error error = other.error();
    error.message += "; --force replays it, and names the first difference";
    return Fail(error);
  }
  ReplayOptions options;
  options.from = arguments.from;
  options.to = arguments.to;
  options.compare_events = arguments.verify;
  options.outputs = arguments.outputs;
  options.scans = arguments.scans;
  std::optional<ControllerCheck> controllers;
  if (arguments.controllers) {
    Result<ControllerCheck> check = ControllerCheck::Create(recording.value());
    if (!check.ok()) return Fail(check.error());
    controllers.emplace(std::move(check).value());
    options.check = [&](const ReplayedWorld& world, const RecordedTick& next) {
      return controllers->Check(world, next);
    };
  }
  auto progress = std::make_unique<ReplayProgress>();
  options.on_progress = [&progress](Tick tick, double share) { progress->Update(tick, share); };
  const Clock::time_point begin = Clock::now();
  const Result<ReplayReport> replayed = RunReplay(recording.value(), options).Run();
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  progress.reset();
  if (!replayed.ok()) return Fail(replayed.error());

  const ReplayReport& report = replayed.value();
  const char* outcome = report.difference ? " before the first difference"
                        : report.damage   ? " before the damage: their state hashes are equal"
                                          : ": all state hashes are equal";
  fmt::print("{} replayed in {:.2f} s{}\n", StatesText(report), seconds, outcome);
  if (report.states > 0) fmt::print("state hash of tick {}: {:016x}\n", report.last, report.state_hash);
  std::fflush(stdout);
  if (report.difference) return Fail({{arguments.file}, *report.difference, ErrorCode::kFailure});
  if (report.damage) return Fail({{arguments.file}, *report.damage, ErrorCode::kFailure});
  if (!arguments.verify) return kExitDone;
  if (const Status damaged = recording.value().CheckData(); !damaged.ok()) return Fail(damaged.error());
  fmt::print("all recorded events are equal, and the file is whole\n");
  if (controllers) fmt::print("{}", ControllersText(*controllers));
  return kExitDone;
}

}  // namespace

void AddReplayCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("replay", "Step a recorded run again, and compare every state with it");
  const auto arguments = std::make_shared<ReplayArguments>();  // lives as long as the command
  command->add_option("FILE", arguments->file, "A recording of 'troupe run --record FILE.mcap'")
      ->required()
      ->check(NotEmpty())
      ->type_name("");
  CLI::Option* const verify =
      command->add_flag("--verify", arguments->verify, "Compare the events, too, and check the CRC of the whole file");
  command
      ->add_flag("--controllers", arguments->controllers,
                 "Run the controllers again, too, from the start of the run, and compare their proposals: names the "
                 "first robot, tick and number that differs")
      ->needs(verify);
  command->add_flag("--force", arguments->force, "Replay a recording of another version of the step, too");
  command->add_option("--from", arguments->from, "First tick; stepping starts at the keyframe before (default: 0)")
      ->check(WholeNumber(0))
      ->type_name("TICK");
  command->add_option("--to", arguments->to, "Last tick (default: the last of the recording)")
      ->check(WholeNumber(0))
      ->type_name("TICK");
  const char* group = "Output files, as those of the run";
  AddHashLogFlag(*command, arguments->outputs.hash_log, group);
  AddPosesFlag(*command, arguments->outputs.poses, group);
  AddScansFlag(*command, arguments->scans, group);
  command->final_callback([arguments, &exit_status] { exit_status = ReplayCommand(*arguments); });
}

}  // namespace troupe
