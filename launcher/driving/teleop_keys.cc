#include "launcher/driving/teleop_keys.h"

#include <algorithm>
#include <utility>

namespace troupe {
namespace {

constexpr char kEscape = '\033';
constexpr char kEndOfInput = '\004';  // Ctrl-D
constexpr double kFaster = 1.25;      // of one press
constexpr double kMostSpeed = 100.0;  // m/s and rad/s

}  // namespace

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

bool TeleopKeys::PressKey(char key, double now) {
  const auto scale = [&](double factor) {
    settings_.speed = std::min(settings_.speed * factor, kMostSpeed);
    settings_.turn_rate = std::min(settings_.turn_rate * factor, kMostSpeed);
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

}  // namespace troupe
