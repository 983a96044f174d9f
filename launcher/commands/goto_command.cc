#include <fmt/format.h>
#include <poll.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <vector>

#include "command_line/exit_status.h"
#include "command_line/network_flags.h"
#include "command_line/option_checks.h"
#include "launcher/commands/arguments.h"
#include "launcher/commands/commands.h"
#include "launcher/driving/robot_remote.h"
#include "launcher/process/signal_watch.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPoseMilliseconds = 100;      // ms, between two questions where the robot is
constexpr double kStill = 1e-3;             // m/s and rad/s: it stands
constexpr double kHeadingTolerance = 0.05;  // rad

struct GotoOptions {
  NetworkSettings network;  // session empty: the only one
  std::string robot;
  std::vector<std::string> points;
  bool cancel = false;
  bool no_wait = false;
  double tolerance = 0.2;  // m
  double timeout_seconds = 0.0;
};

Status Cancel(RobotRemote& remote) {
  RobotCommand command;
  command.goal.emplace();
  const Result<ControlReply> reply = remote.Send(command, 1);
  return reply.ok() ? Status() : reply.error();
}

double DistanceTo(const Goal& goal, const Pose& X_WR) {
  return std::sqrt((goal.waypoints.back() - X_WR.translation()).squaredNorm());
}

bool HasArrived(const Goal& goal, const EntityReport& robot, double tolerance) {
  if (DistanceTo(goal, robot.X_WE) > tolerance) return false;
  if (goal.heading && std::abs(WrapAngle(*goal.heading - robot.X_WE.heading)) > kHeadingTolerance) return false;
  const Twist& twist = robot.twist;
  return std::abs(twist.vx) < kStill && std::abs(twist.vy) < kStill && std::abs(twist.wz) < kStill;
}

int AwaitArrival(const GotoOptions& options, const Goal& goal, RobotRemote& remote, SignalWatch& signals) {
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

int Goto(GotoOptions options) {
  if (options.cancel == !options.points.empty()) {
    return Fail({{},
                 options.cancel ? "found points together with --cancel, expected one of them"
                                : "found no point, expected X,Y or X,Y,HEADING",
                 ErrorCode::kBadInput});
  }
  Result<Goal> goal = options.cancel ? Goal{} : ParseGoalText(options.points);
  if (!goal.ok()) return Fail(goal.error());
  SignalWatch signals;
  try {
    if (const Status problem = SelectSession(options.network); !problem.ok()) return Fail(problem.error());
    Result<RobotRemote> remote = RobotRemote::Connect(options.network, options.robot);
    if (!remote.ok()) return Fail(remote.error());
    if (options.cancel) {
      const Status failure = Cancel(remote.value());
      return failure.ok() ? kExitDone : Fail(failure.error());
    }
    RobotCommand command;
    command.goal = goal.value();
    const Result<ControlReply> reply = remote.value().Send(command, kMostCommandTicks);
    if (!reply.ok()) return Fail(reply.error());
    return options.no_wait ? kExitDone : AwaitArrival(options, goal.value(), remote.value(), signals);
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

}  // namespace

void AddGotoCommand(CLI::App& app, int& exit_status) {
  CLI::App* const command =
      app.add_subcommand("goto", "Send a robot of a live run to a point, and wait until it is there");
  const auto options = std::make_shared<GotoOptions>();
  command->add_option("ROBOT", options->robot, "Name of the robot; its controller accepts goals (go_to, patrol)")
      ->required();
  command
      ->add_option("POINT", options->points,
                   "Where to, in the world frame, in metres and degrees; of several, one after another")
      ->type_name("X,Y[,HEADING]");
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

}  // namespace troupe
