// TeleopKeys: turns the keys of a terminal into commands to a robot. A terminal reports no release of a key, so that a
// key counts until its repetition has been missing for a while.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "troupe/robot_command.h"

namespace troupe {

struct TeleopSettings {
  double speed = 0.5;         // m/s
  double turn_rate = 1.0;     // rad/s
  double hold_seconds = 0.7;  // that a key counts after its last repetition
};

class TeleopKeys {
 public:
  explicit TeleopKeys(const TeleopSettings& settings) : settings_(settings) {}

  // Reads what the terminal has sent, at `now` (s, of any clock). A sequence that ends in the middle continues with the
  // next call. False: a key that ends the tool.
  bool Press(std::string_view bytes, double now);

  // The motion at `now`, in R.
  Twist TwistAt(double now) const;
  // Orders to the robot's first gripper since the last call.
  std::optional<GripperOrder> DrainOrder();

  // What the keys do.
  static const char* Help();

 private:
  enum Axis : std::size_t { kAhead, kLeft, kTurn, kAxes };

  struct Deflection {
    double value = 0.0;  // -1 to 1
    double until = 0.0;
  };

  bool PressKey(char key, double now);
  void Deflect(Axis axis, double value, double now);

  TeleopSettings settings_;
  std::array<Deflection, kAxes> axes_;
  std::optional<GripperOrder> order_;
  std::string escape_;  // an unfinished sequence
};

}  // namespace troupe
