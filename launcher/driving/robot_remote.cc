#include "launcher/driving/robot_remote.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include "transport/dds/tools/control_client.h"
#include "transport/dds/tools/session_monitor.h"

namespace troupe {
namespace {

constexpr double kReplySeconds = 10.0;
constexpr double kDiscoverySeconds = 5.0;
constexpr double kMeasureSeconds = 0.3;

constexpr char kEscape = '\033';
constexpr char kEndOfInput = '\004';  // Ctrl-D
constexpr double kFaster = 1.25;      // of one press
constexpr double kMaxSpeed = 100.0;   // m/s and rad/s

// For the signal handler, which has no object.
int restored_descriptor = -1;
termios restored{};

// That end a process at once, by default; the program stops by the others in an orderly way.
constexpr std::array<int, 6> kDeadly = {SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};

void RestoreAndDie(int signal) {
  tcsetattr(restored_descriptor, TCSANOW, &restored);
  std::signal(signal, SIG_DFL);
  raise(signal);
}

}  // namespace

// Asks once, so that a wrong name is an error here and not at the first command.
Result<RobotRemote> RobotRemote::Connect(const NetworkSettings& network, const std::string& robot) {
  auto client = std::make_unique<ControlClient>(network);
  if (Status missing = client->WaitForService(kDiscoverySeconds); !missing.ok()) {
    return Failure(missing.error().message + SimilarSession(network));
  }
  RobotRemote remote(std::move(client), robot);
  const Result<ControlReply> reply = remote.Ask();
  if (!reply.ok()) return reply.error();
  if (reply.value().entities.front().kind != EntityKind::kRobot) return Failure("'" + robot + "' is no robot");
  return remote;
}

RobotRemote::RobotRemote(std::unique_ptr<ControlClient> client, std::string robot)
    : client_(std::move(client)), robot_(std::move(robot)), measured_at_(Clock::now()) {}
RobotRemote::RobotRemote(RobotRemote&& other) noexcept = default;
RobotRemote::~RobotRemote() = default;

Result<ControlReply> RobotRemote::Ask() {
  Result<ControlReply> reply = Call(control::Entities{.name = robot_});
  if (reply.ok() && reply.value().entities.size() != 1) return Failure("the world has no robot '" + robot_ + "'");
  return reply;
}

Result<Pose> RobotRemote::FindPlace(const std::string& name) {
  const Result<ControlReply> reply = Call(control::Entities{.name = name});
  if (reply.ok() && reply.value().entities.size() == 1 && reply.value().entities.front().type == "place") {
    return reply.value().entities.front().X_WE;
  }
  // The service's reason has the most similar name.
  return reply.ok() ? Failure("'" + name + "' is no place") : reply.error();
}

Result<ControlReply> RobotRemote::Send(const RobotCommand& command, std::uint64_t ticks) {
  return Call(control::CommandRobot{robot_, std::clamp<std::uint64_t>(ticks, 1, kMaxCommandTicks), command.twist,
                                    command.grippers, command.goal});
}

// A refusal is an error with the service's reason.
Result<ControlReply> RobotRemote::Call(const control::Request& request) {
  Result<ControlReply> reply = client_->Call(request, kReplySeconds);
  if (!reply.ok()) return reply;
  if (!reply.value().done) return Failure(reply.value().problem);
  if (reply.value().state == RunState::kOver) return Failure("the run is over");
  NoteTick(reply.value().tick);
  return reply;
}

// A new measurement begins after kMeasureSeconds, so that the rate follows a change of speed, or at once when the run
// was set back.
void RobotRemote::NoteTick(Tick tick) {
  const Clock::time_point now = Clock::now();
  const double passed = std::chrono::duration<double>(now - measured_at_).count();
  if (measured_tick_ != 0 && passed < kMeasureSeconds && tick >= measured_tick_) return;
  if (measured_tick_ != 0 && tick >= measured_tick_) {
    ticks_per_second_ = static_cast<double>(tick - measured_tick_) / passed;
  }
  measured_tick_ = std::max<Tick>(tick, 1);
  measured_at_ = now;
}

std::uint64_t RobotRemote::TicksIn(double seconds) const {
  const double ticks = std::ceil(seconds * ticks_per_second_);
  return static_cast<std::uint64_t>(std::clamp(ticks, 2.0, static_cast<double>(kMaxCommandTicks)));
}

const char* TeleopKeys::Help() {
  return "  w, up     ahead          a, left   turn left      q   sideways to the left\n"
         "  s, down   back           d, right  turn right     e   sideways to the right\n"
         "  space     stop           + -       faster, slower\n"
         "  o c       open, close the gripper                 r f lift up, down\n"
         "  x, Ctrl-C end\n";
}

bool TeleopKeys::Press(std::string_view bytes, double now) {
  for (const char byte : bytes) {
    if (escape_.empty() && byte != kEscape) {
      if (!PressKey(byte, now)) return false;
      continue;
    }
    // ESC [ A or, of some terminals, ESC O A
    escape_ += byte;
    if (escape_.size() == 2 && byte != '[' && byte != 'O') escape_.clear();
    if (escape_.size() < 3) continue;
    const bool is_end = byte >= '@' && byte <= '~';
    if (escape_.size() == 3) {
      if (byte == 'A') Deflect(kAhead, 1.0, now);
      if (byte == 'B') Deflect(kAhead, -1.0, now);
      if (byte == 'C') Deflect(kTurn, -1.0, now);
      if (byte == 'D') Deflect(kTurn, 1.0, now);
    }
    if (is_end || escape_.size() > 16) escape_.clear();
  }
  return true;
}

// Letters repeat the arrows, since some terminals send no sequences for these. '=' is '+' without the shift key.
bool TeleopKeys::PressKey(char key, double now) {
  const auto scale = [&](double factor) {
    settings_.speed = std::min(settings_.speed * factor, kMaxSpeed);
    settings_.turn_rate = std::min(settings_.turn_rate * factor, kMaxSpeed);
  };
  switch (key) {
    case 'w':
      Deflect(kAhead, 1.0, now);
      break;
    case 's':
      Deflect(kAhead, -1.0, now);
      break;
    case 'a':
      Deflect(kTurn, 1.0, now);
      break;
    case 'd':
      Deflect(kTurn, -1.0, now);
      break;
    case 'q':
      Deflect(kLeft, 1.0, now);
      break;
    case 'e':
      Deflect(kLeft, -1.0, now);
      break;
    case ' ':
      axes_ = {};
      break;
    case '+':
    case '=':
      scale(kFaster);
      break;
    case '-':
      scale(1.0 / kFaster);
      break;
    case 'o':
    case 'c':
    case 'r':
    case 'f':
      if (!order_) order_.emplace();
      if (key == 'o' || key == 'c') order_->opening = key == 'o' ? 100.0 : 0.0;
      if (key == 'r' || key == 'f') order_->lift = key == 'r' ? 100.0 : 0.0;
      break;
    case 'x':
    case kEndOfInput:
      return false;
    default:
      break;
  }
  return true;
}

void TeleopKeys::Deflect(Axis axis, double value, double now) {
  axes_[axis] = {value, now + settings_.hold_seconds};
}

Twist TeleopKeys::TwistAt(double now) const {
  const auto at = [&](Axis axis) { return now < axes_[axis].until ? axes_[axis].value : 0.0; };
  return {at(kAhead) * settings_.speed, at(kLeft) * settings_.speed, at(kTurn) * settings_.turn_rate};
}

std::optional<GripperOrder> TeleopKeys::DrainOrder() {
  return std::exchange(order_, std::nullopt);
}

Result<std::unique_ptr<RawTerminal>> RawTerminal::Open(int descriptor) {
  termios before{};
  if (tcgetattr(descriptor, &before) != 0) {
    return Error{{}, "the standard input is no terminal, expected one for the keys", ErrorCode::kBadInput};
  }
  return std::unique_ptr<RawTerminal>(new RawTerminal(descriptor, before));
}

// VMIN 1 and VTIME 0: read returns with the first byte.
RawTerminal::RawTerminal(int descriptor, const termios& before) : descriptor_(descriptor), before_(before) {
  restored_descriptor = descriptor;
  restored = before;
  for (const int signal : kDeadly) std::signal(signal, RestoreAndDie);
  termios raw = before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  raw.c_cc[VSUSP] = _POSIX_VDISABLE;  // a stopped tool cannot steer, and would leave the terminal raw
  tcsetattr(descriptor, TCSANOW, &raw);
}

RawTerminal::~RawTerminal() {
  tcsetattr(descriptor_, TCSANOW, &before_);
  for (const int signal : kDeadly) std::signal(signal, SIG_DFL);
}

}  // namespace troupe
