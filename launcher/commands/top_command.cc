#include "launcher/commands/top_command.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <utility>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/source_text.h"
#include "common/base/text.h"
#include "launcher/commands/commands.h"
#include "launcher/process/process.h"
#include "transport/protocol/message_texts.h"
#include "troupe/deterministic_math.h"
#include "troupe/enum_names.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kDiscoveryTime = std::chrono::milliseconds(1500);  // for the discovery of sessions and their status
constexpr double kRefreshSeconds = 0.5;

struct TopOptions {
  NetworkSettings network;  // session empty: all sessions
  bool once = false;        // print one table and end
};

// The sessions of that name; all for an empty name.
std::vector<SessionInfo> SelectSessions(std::vector<SessionInfo> sessions, const std::string& name) {
  if (!name.empty()) std::erase_if(sessions, [&](const SessionInfo& info) { return info.session != name; });
  return sessions;
}

// Discovery has no end: the table has what was found in kDiscoveryTime. Reading the sessions takes their samples, which
// would end each wait at once.
void PrintOnce(SessionMonitor& monitor, const TopOptions& options) {
  std::vector<SessionInfo> sessions;
  for (auto end = Clock::now() + kDiscoveryTime; Clock::now() < end;) {
    monitor.WaitForChange(0.1);
    sessions = monitor.Sessions();
  }
  fmt::print("{}", SessionTable(SelectSessions(std::move(sessions), options.network.session)));
}

void WaitForRefresh(SignalWatch& signals) {
  pollfd waited = {signals.descriptor(), POLLIN, 0};
  poll(&waited, 1, static_cast<int>(1000.0 * kRefreshSeconds));
}

// The cursor moves to the top in place of new lines, so that the terminal shows one table.
void PrintUntilStopped(SessionMonitor& monitor, const TopOptions& options, SignalWatch& signals) {
  while (!signals.ReadStopRequest()) {
    fmt::print("\033[H\033[J{}\nCtrl-C ends this.\n",
               SessionTable(SelectSessions(monitor.Sessions(), options.network.session)));
    std::fflush(stdout);
    WaitForRefresh(signals);
  }
}

// Lines of the terminal.
std::size_t TerminalRows() {
  winsize size{};
  constexpr std::size_t kUsual = 40;
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 ? size.ws_row : kUsual;
}

// The observer's thread fills `top`; this one draws it at its own rate, however fast the ticks are.
int ShowRobots(const TopOptions& options, SignalWatch& signals) {
  SessionTop top;
  const Result<std::unique_ptr<SessionObserver>> observer = ObserveSession(options.network, top);
  if (!observer.ok()) return Fail(observer.error());
  constexpr std::size_t kFooter = 2;
  while (!signals.ReadStopRequest()) {
    fmt::print("\033[H\033[J{}: {}\nCtrl-C ends this.\n", options.network.session, top.Text(TerminalRows() - kFooter));
    std::fflush(stdout);
    WaitForRefresh(signals);
  }
  return kExitDone;
}

int TopCommand(const TopOptions& options) {
  SignalWatch signals;
  try {
    if (!options.once && !options.network.session.empty()) return ShowRobots(options, signals);
    SessionMonitor monitor(options.network);
    if (options.once) {
      PrintOnce(monitor, options);
    } else {
      PrintUntilStopped(monitor, options, signals);
    }
  } catch (const std::exception& exception) {
    return Fail(Failure(exception.what()));
  }
  return kExitDone;
}

constexpr double kNoticeable = 1e-9;  // m/s and rad/s

// In the order of the attention that they need.
enum class State : std::uint8_t { kLost, kLate, kStalled, kMoving, kIdle };
constexpr auto NamesOf(State) {
  return std::array{"no agent", "late", "stalled", "moving", "idle"};
}

using Row = std::array<std::string, 8>;

Row RowOf(const SessionInfo& session) {
  Row row = {session.session,
             session.world,
             fmt::format("{}:{}", session.host, session.pid),
             "-",
             "-",
             "-",
             fmt::format("-/{}", session.robots),
             "-"};
  if (!session.status) return row;
  const StatusMessage& status = *session.status;
  row[3] =
      status.target_ticks > 0 ? fmt::format("{}/{}", status.tick, status.target_ticks) : std::to_string(status.tick);
  row[4] = fmt::format("{:.1f}", status.sim_seconds);
  row[5] = fmt::format("{:.2f}", status.real_time_factor);
  row[6] = fmt::format("{}/{}", status.agents, status.robots);
  if (!status.waiting_for.empty()) row[7] = WaitingText(status);
  return row;
}

}  // namespace

void AddTopCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("top", "Show the running sessions, and the robots for which they wait");
  const auto options = std::make_shared<TopOptions>();
  AddSessionFlag(*command, options->network, "Show the robots of this session (default: all sessions)");
  AddToolNetworkFlags(*command, options->network);
  command->add_flag("--once", options->once, "Print one table and exit");
  command->final_callback([options, &exit_status] { exit_status = TopCommand(*options); });
}

// The last column is not padded: it has texts of any length.
std::string SessionTable(const std::vector<SessionInfo>& sessions) {
  std::vector<Row> rows = {
      {"SESSION", "WORLD", "SERVICE", "TICK", "SIM SECONDS", "X REAL TIME", "AGENTS/ROBOTS", "WAITING FOR"}};
  for (const SessionInfo& session : sessions) rows.push_back(RowOf(session));
  std::array<std::size_t, std::tuple_size_v<Row>> widths{};
  for (Row& row : rows) {
    for (std::string& cell : row) cell = PlainLine(cell);  // any host of the network may write them
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i) text += fmt::format("{:<{}}  ", row[i], widths[i]);
    text += row.back() + "\n";
  }
  return text;
}

void SessionTop::OnSession(const SessionMessage& session) {
  const std::lock_guard lock(mutex_);
  if (session_ && session_->run != session.run) Reset();
  session_ = std::make_shared<const SessionMessage>(session);
}

// Frames of another edition of the world than the known description are left out until that one arrives.
void SessionTop::OnFrame(const SharedFrame& frame) {
  const std::lock_guard lock(mutex_);
  if (!session_ || frame->run != session_->run || frame->world_edition != session_->world_edition) return;
  for (const Event& event : frame->events) {
    if (!event.robot || event.robot->index() >= session_->world->robots.size()) continue;
    const std::string& name = session_->world->robot(*event.robot).name;
    if (event.type == EventType::kLeft) lost_.insert(name);
    if (event.type == EventType::kJoined) lost_.erase(name);
  }
  shown_ = session_;
  frame_ = frame;
}

void SessionTop::OnStatus(const StatusMessage& status) {
  const std::lock_guard lock(mutex_);
  if (session_ && status.run == session_->run) status_ = status;
}

void SessionTop::OnServiceGone() {
  const std::lock_guard lock(mutex_);
  Reset();
}

void SessionTop::Reset() {
  session_.reset();
  shown_.reset();
  frame_.reset();
  status_.reset();
  lost_.clear();
}

bool SessionTop::IsLate(const std::string& robot) const {
  return status_ &&
         std::find(status_->waiting_for.begin(), status_->waiting_for.end(), robot) != status_->waiting_for.end();
}

// Phases are shown only where the service measures them.
std::string SessionTop::RunText(double ticks_per_second, std::size_t lost) const {
  const FrameMessage& frame = *frame_;
  const char* const state = frame.last ? "over" : frame.paused && !frame.holds ? "paused" : "playing";
  std::string text =
      fmt::format("{} on {}:{}, {}, tick {} ({:.1f} s)", shown_->world->name, shown_->host, shown_->pid, state,
                  frame.state.tick, static_cast<double>(frame.state.tick) * shown_->world->interval_seconds());
  if (!status_) return text + "\n";
  text += fmt::format("\n{:.1f} ticks a second, {:.2f} x real time, {}, {}, {} without an agent", ticks_per_second,
                      status_->real_time_factor, CountText(status_->robots, "robot"),
                      CountText(status_->agents, "agent"), lost);
  if (const PhaseSeconds& phases = status_->phases; phases != PhaseSeconds()) {
    text += fmt::format("\nphases of a tick: wait {:.2f} ms, step {:.2f} ms, record {:.2f} ms, publish {:.2f} ms",
                        1e3 * phases.wait, 1e3 * phases.step, 1e3 * phases.record, 1e3 * phases.publish);
  }
  if (!status_->waiting_for.empty()) text += "\nthe tick waits for " + WaitingText(*status_);
  return text + "\n";
}

// The rate is that of the ticks between two calls; it is 0 after a reset or an edit that set the run back.
std::string SessionTop::Text(std::size_t rows) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - counted_at_).count();
  if (!frame_) return "waiting for a run in the session\n";
  const Tick tick = frame_->state.tick;
  const double rate =
      tick >= counted_tick_ && seconds > 0.0 ? static_cast<double>(tick - counted_tick_) / seconds : 0.0;
  counted_tick_ = tick;
  counted_at_ = now;

  const WorldDescription& world = shown_->world;
  std::vector<std::pair<State, std::size_t>> robots;
  for (std::size_t i = 0; i < frame_->state.robots.size() && i < world.robots.size(); ++i) {
    if (!RobotExists(world, RobotId(i))) continue;
    const RobotState& robot = frame_->state.robots[i];
    const bool moves = std::abs(robot.twist.vx) + std::abs(robot.twist.vy) + std::abs(robot.twist.wz) > kNoticeable;
    robots.emplace_back(lost_.contains(world.robots[i].name) ? State::kLost
                        : IsLate(world.robots[i].name)       ? State::kLate
                        : robot.stalled                      ? State::kStalled
                        : moves                              ? State::kMoving
                                                             : State::kIdle,
                        i);
  }
  // Those that need attention first, the others in the order of their ids.
  std::stable_sort(robots.begin(), robots.end(), [](const auto& a, const auto& b) {
    return std::min(a.first, State::kMoving) < std::min(b.first, State::kMoving);
  });
  const auto lost =
      std::count_if(robots.begin(), robots.end(), [](const auto& robot) { return robot.first == State::kLost; });
  std::string text = RunText(rate, static_cast<std::size_t>(lost));
  text += fmt::format("\n{:<20} {:<9} {:>9} {:>9} {:>8} {:>7}  {}\n", "ROBOT", "STATE", "X", "Y", "HEADING", "M/S",
                      "CONTROLLER");
  std::size_t used = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (++used > rows && i + 1 < robots.size()) {
      text += fmt::format("and {} more\n", robots.size() - i);
      break;
    }
    const auto& [state, index] = robots[i];
    const RobotState& robot = frame_->state.robots[index];
    text += fmt::format("{:<20} {:<9} {:>9.3f} {:>9.3f} {:>8.1f} {:>7.2f}  {}\n", world.robots[index].name,
                        NameOf(state), robot.X_WR.x, robot.X_WR.y, RadiansToDegrees(robot.X_WR.heading),
                        std::hypot(robot.twist.vx, robot.twist.vy), world.robots[index].controller.name);
  }
  return text;
}

}  // namespace troupe
