#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/model/goal_text.h"
#include "launcher/commands/commands.h"
#include "launcher/driving/robot_remote.h"
#include "launcher/process/process.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPoseMilliseconds = 100;      // ms, between two questions where the robot is
constexpr double kStill = 1e-3;             // m/s and rad/s: it stands
constexpr double kHeadingTolerance = 0.05;  // rad

// Of `troupe goto`.
struct GotoOptions {
  NetworkSettings network;  // session empty: the only one
  std::string robot;
  std::vector<std::string> points;
  bool cancel = false;
  bool no_wait = false;
  double tolerance = 0.2;  // m
  double timeout_seconds = 0.0;
};

// A command with an empty goal, for one tick: the controller goes on from where the robot is.
Status Cancel(RobotRemote& remote) {
  RobotCommand command;
  command.goal.emplace();
  const Result<ControlReply> reply = remote.Send(command, 1);
  return reply.ok() ? Status() : reply.error();
}

// Of points, and of names of places, which have no comma and a height. A point is on the level of the place before it,
// at first on that at `z` (m). `find` gives the pose of a place.
template <typename Find>
Result<Goal> FindGoal(std::vector<std::string> points, double z, Find find) {
  std::vector<double> heights;
  for (std::string& point : points) {
    if (point.find(',') == std::string::npos) {
      const Result<Pose> place = find(point);
      if (!place.ok()) return place.error();
      point = fmt::format("{},{}", place.value().x, place.value().y);  // exact
      z = place.value().z;
    }
    heights.push_back(z);
  }
  Result<Goal> goal = ParseGoalText(points);
  if (goal.ok()) goal.value().heights = std::move(heights);
  return goal;
}

// In the plane; m.
double DistanceTo(const Goal& goal, const Pose& X_WR) {
  return std::sqrt((goal.waypoints.back() - X_WR.translation()).squaredNorm());
}

// Within the tolerance at rest: a robot that passes its goal has not arrived. Points one above another are on different
// levels of a building.
bool HasArrived(const Goal& goal, const EntityReport& robot, double tolerance) {
  constexpr double kLevel = 1.0;  // m
  if (DistanceTo(goal, robot.X_WE) > tolerance) return false;
  if (std::abs(goal.heights.back() - robot.X_WE.z) > kLevel) return false;
  if (goal.heading && std::abs(WrapAngle(*goal.heading - robot.X_WE.heading)) > kHeadingTolerance) return false;
  const Twist& twist = robot.twist;
  return std::abs(twist.vx) < kStill && std::abs(twist.vy) < kStill && std::abs(twist.wz) < kStill;
}

// The reason for which the robot's controller gave a goal up after tick `sent`; nothing: it did not.
std::optional<std::string> ReasonToGiveUp(const EntityReport& robot, Tick sent) {
  const std::string begin = fmt::format("\n{} ", kSaidLine);  // the last line, behind those of its rows
  const std::size_t at = robot.signals.rfind(begin);
  if (at == std::string::npos) return std::nullopt;
  const nlohmann::json said = nlohmann::json::parse(robot.signals.substr(at + begin.size()), nullptr, false);
  if (!said.is_object() || said.value("tick", Tick{0}) <= sent) return std::nullopt;
  const std::string text = said.value("text", std::string());
  return text.starts_with(kGaveUpGoal) ? std::optional(text) : std::nullopt;
}

// The state is asked for and not observed: an observer would receive the states of all robots. `sent`: the tick of the
// reply to the goal.
int AwaitArrival(const GotoOptions& options, const Goal& goal, Tick sent, RobotRemote& remote, SignalWatch& signals) {
  const Clock::time_point begin = Clock::now();
  for (;;) {
    const Result<ControlReply> reply = remote.Ask();
    if (!reply.ok()) return Fail(reply.error());
    const EntityReport& robot = reply.value().entities.front();
    if (HasArrived(goal, robot, options.tolerance)) {
      fmt::print("{} is at {:.3f},{:.3f},{:.2f} (tick {})\n", options.robot, robot.X_WE.x, robot.X_WE.y,
                 RadiansToDegrees(robot.X_WE.heading), reply.value().tick);
      return kExitDone;
    }
    if (const std::optional<std::string> reason = ReasonToGiveUp(robot, sent)) {
      if (const Status failure = Cancel(remote); !failure.ok()) return Fail(failure.error());
      return Fail(Failure(fmt::format("{} {}", options.robot, *reason)));
    }
    if (signals.ReadStopRequest()) {
      if (const Status failure = Cancel(remote); !failure.ok()) return Fail(failure.error());
      return kExitInterrupted;
    }
    const double passed = std::chrono::duration<double>(Clock::now() - begin).count();
    if (options.timeout_seconds > 0.0 && passed > options.timeout_seconds) {
      if (const Status failure = Cancel(remote); !failure.ok()) return Fail(failure.error());
      return Fail(Failure(fmt::format("{} has not arrived within {:g} s: it is {:.2f} m away", options.robot,
                                      options.timeout_seconds, DistanceTo(goal, robot.X_WE))));
    }
    pollfd waited = {signals.descriptor(), POLLIN, 0};
    poll(&waited, 1, kPoseMilliseconds);
  }
}

// A goal that is not reached is cancelled, by Ctrl-C or the timeout: the robot must not drive on without its user.
int Goto(GotoOptions options) {
  if (options.cancel == !options.points.empty()) {
    return Fail({{},
                 options.cancel ? "found points together with --cancel, expected one of them"
                                : "found no point, expected X,Y, X,Y,HEADING or a place",
                 ErrorCode::kBadInput});
  }
  if (!options.cancel) {  // what is wrong without a run
    const Result<Goal> trial = FindGoal(options.points, 0.0, [](const std::string&) { return Result<Pose>(Pose()); });
    if (!trial.ok()) return Fail(trial.error());
  }
  SignalWatch signals;
  try {
    if (const Status problem = SelectSession(options.network); !problem.ok()) return Fail(problem.error());
    Result<RobotRemote> remote = RobotRemote::Connect(options.network, options.robot);
    if (!remote.ok()) return Fail(remote.error());
    if (options.cancel) {
      const Status failure = Cancel(remote.value());
      return failure.ok() ? kExitDone : Fail(failure.error());
    }
    const Result<ControlReply> robot = remote.value().Ask();
    if (!robot.ok()) return Fail(robot.error());
    const Result<Goal> goal = FindGoal(options.points, robot.value().entities.front().X_WE.z,
                                       [&](const std::string& name) { return remote.value().FindPlace(name); });
    if (!goal.ok()) return Fail(goal.error());
    RobotCommand command;
    command.goal = goal.value();
    const Result<ControlReply> reply = remote.value().Send(command, kMaxCommandTicks);
    if (!reply.ok()) return Fail(reply.error());
    return options.no_wait ? kExitDone
                           : AwaitArrival(options, goal.value(), reply.value().tick, remote.value(), signals);
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

constexpr double kCommandPeriod = 0.1;    // s, between two commands
constexpr double kValid = 0.5;            // s of wall time that a command is in force: it ends soon after the tool
constexpr std::uint64_t kOrderTicks = 2;  // a gripper keeps what it was ordered

// Of `troupe teleop`.
struct TeleopOptions {
  NetworkSettings network;  // session empty: the only one
  std::string robot;
  TeleopSettings settings;
};

double Now() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

// Why the driving ends: not yet, by the user's key, or by a signal or a lost terminal.
enum class End : std::uint8_t { kNone, kKey, kSignal };

// Waits for keys until `until`.
End ReadKeys(TeleopKeys& keys, SignalWatch& signals, double until) {
  for (;;) {
    const double left = until - Now();
    std::array<pollfd, 2> waited = {pollfd{STDIN_FILENO, POLLIN, 0}, pollfd{signals.descriptor(), POLLIN, 0}};
    const int ready = poll(waited.data(), waited.size(), left > 0.0 ? static_cast<int>(1000.0 * left) + 1 : 0);
    if (signals.ReadStopRequest()) return End::kSignal;
    if (ready < 0 && errno != EINTR) return End::kSignal;
    if (ready > 0 && waited[0].revents != 0) {
      std::array<char, 256> bytes{};
      const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
      if (count == 0 || (count < 0 && errno != EINTR)) return End::kSignal;  // the terminal is gone
      if (count > 0 && !keys.Press({bytes.data(), static_cast<std::size_t>(count)}, Now())) return End::kKey;
    }
    if (Now() >= until) return End::kNone;
  }
}

void Show(const std::string& robot, const Twist& twist, const ControlReply& reply) {
  const char* const paused = reply.state == RunState::kPaused ? ", paused" : "";
  fmt::print("\r\033[K{}: ahead {:.2f} m/s, left {:.2f} m/s, turn {:.2f} rad/s (tick {}{})", robot, twist.vx, twist.vy,
             twist.wz, reply.tick, paused);
  std::fflush(stdout);
}

// The twist is repeated in each period though no key has changed: a command is in force for kValid, so that a tool that
// dies stops the robot.
Result<End> Drive(const TeleopOptions& options, RobotRemote& remote, TeleopKeys& keys, SignalWatch& signals) {
  for (;;) {
    const double begin = Now();
    const Twist twist = keys.TwistAt(begin);
    RobotCommand command;
    command.twist = twist;
    const Result<ControlReply> reply = remote.Send(command, remote.TicksIn(kValid));
    if (!reply.ok()) return reply.error();
    if (const std::optional<GripperOrder> order = keys.DrainOrder()) {
      RobotCommand to_gripper;
      to_gripper.grippers.push_back(*order);
      if (const auto refused = remote.Send(to_gripper, kOrderTicks); !refused.ok()) return refused.error();
    }
    Show(options.robot, twist, reply.value());
    if (const End end = ReadKeys(keys, signals, begin + kCommandPeriod); end != End::kNone) return end;
  }
}

int Teleop(TeleopOptions options) {
  SignalWatch signals;
  if (isatty(STDIN_FILENO) == 0) {
    return Fail({{}, "the standard input is no terminal, expected one for the keys", ErrorCode::kBadInput});
  }
  try {
    if (const Status problem = SelectSession(options.network); !problem.ok()) return Fail(problem.error());
    Result<RobotRemote> remote = RobotRemote::Connect(options.network, options.robot);
    if (!remote.ok()) return Fail(remote.error());
    fmt::print("driving {} of {}:\n{}", options.robot, options.network.session, TeleopKeys::Help());
    std::fflush(stdout);
    TeleopKeys keys(options.settings);
    Result<End> end = End::kNone;
    {
      // Within this block only, so that errors are printed on a terminal that is as it was.
      const Result<std::unique_ptr<RawTerminal>> terminal = RawTerminal::Open(STDIN_FILENO);
      if (!terminal.ok()) return Fail(terminal.error());
      end = Drive(options, remote.value(), keys, signals);
    }
    fmt::print("\n");
    std::fflush(stdout);
    if (!end.ok()) return Fail(end.error());
    // The robot stands for a tick, and its controller continues.
    RobotCommand stop;
    stop.twist.emplace();
    if (const auto stopped = remote.value().Send(stop, 1); !stopped.ok()) return Fail(stopped.error());
    return end.value() == End::kSignal ? kExitInterrupted : kExitDone;
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

}  // namespace

void AddGotoCommand(CLI::App& app, int& exit_status) {
  CLI::App* const command =
      app.add_subcommand("goto", "Send a robot of a live run to a point, and wait until it is there");
  const auto options = std::make_shared<GotoOptions>();
  command->add_option("ROBOT", options->robot, "Name of the robot; its controller accepts goals (go_to, patrol, lanes)")
      ->required();
  command
      ->add_option("POINT", options->points,
                   "Where to, in the world frame, in metres and degrees, or the name of a place; of several, one after "
                   "another")
      ->type_name("X,Y[,HEADING]|PLACE");
  command->add_flag("--cancel", options->cancel, "End the goal; the controller continues");
  command->add_flag("--no-wait", options->no_wait, "Send the goal and exit");
  command->add_option("--tolerance", options->tolerance, "Metres within which it has arrived (default: 0.2)")
      ->check(PositiveNumber())
      ->type_name("METRES");
  command
      ->add_option("--timeout", options->timeout_seconds, "Seconds until the goal is cancelled; 0: no limit (default)")
      ->check(NumberFromZero())
      ->type_name("SECONDS");
  AddSessionFlag(*command, options->network, "Session of the run (default: the only one in the domain)");
  AddToolNetworkFlags(*command, options->network);
  command->final_callback([options, &exit_status] { exit_status = Goto(*options); });
}

void AddTeleopCommand(CLI::App& app, int& exit_status) {
  CLI::App* const command = app.add_subcommand("teleop", "Drive a robot of a live run by the keys of the terminal");
  const auto options = std::make_shared<TeleopOptions>();
  command->add_option("ROBOT", options->robot, "Name of the robot")->required();
  command->add_option("--speed", options->settings.speed, "m/s ahead, back and sideways (default: 0.5)")
      ->check(NumberFromZero())
      ->type_name("SPEED");
  command->add_option("--turn-rate", options->settings.turn_rate, "rad/s of turns (default: 1)")
      ->check(NumberFromZero())
      ->type_name("RATE");
  command
      ->add_option(
          "--hold", options->settings.hold_seconds,
          "Seconds that a key counts after its last repetition, for terminals report no release (default: 0.7)")
      ->check(PositiveNumber())
      ->type_name("SECONDS");
  AddSessionFlag(*command, options->network, "Session of the run (default: the only one in the domain)");
  AddToolNetworkFlags(*command, options->network);
  command->footer(std::string("Keys:\n") + TeleopKeys::Help() +
                  "While the tool runs, the robot stands unless a key moves it; then its controller continues.");
  command->final_callback([options, &exit_status] { exit_status = Teleop(*options); });
}

}  // namespace troupe
