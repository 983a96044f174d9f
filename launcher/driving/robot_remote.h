// Driving a robot from a tool: commands over DDS, and the keys of a terminal.
//
// A command is in force for a number of ticks and then expires by itself: a tool that dies or loses its network leaves
// a robot that stops, without a watchdog in the service. The tool repeats its command more often than it expires.
// Because ticks are simulated time and the keys are wall time, the remote measures how many ticks pass in a second
// (TicksIn).
//
// Units as everywhere: m/s, rad/s, twists in the robot's frame R. One thread.
#pragma once

#include <termios.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/run/run_settings.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"

namespace troupe {

class ControlClient;

// RobotRemote: commands from a tool to one robot of a run, and its pose.
class RobotRemote {
 public:
  // Connects to the session `network.session`. The error: it was not found, or has no such robot. Throws as
  // ControlClient.
  static Result<RobotRemote> Connect(const NetworkSettings& network, const std::string& robot);
  RobotRemote(RobotRemote&& other) noexcept;
  ~RobotRemote();

  // The state of the run and, as its only entity, the robot. The error: the service is gone or does not answer, or the
  // robot does not exist any more.
  Result<ControlReply> Ask();

  // The pose of a named place of the world, in W. The error: the service is gone, or there is no such place.
  Result<Pose> FindPlace(const std::string& name);

  // Gives the robot a command for `ticks` ticks. The error: as above, or a refusal.
  Result<ControlReply> Send(const RobotCommand& command, std::uint64_t ticks);

  // The number of ticks that pass in `seconds` s of wall time, by the ticks of the replies so far; at least 2.
  std::uint64_t TicksIn(double seconds) const;

 private:
  using Clock = std::chrono::steady_clock;

  RobotRemote(std::unique_ptr<ControlClient> client, std::string robot);
  Result<ControlReply> Call(const control::Request& request);
  void NoteTick(Tick tick);

  std::unique_ptr<ControlClient> client_;
  std::string robot_;
  Tick measured_tick_ = 0;  // at the start of the present measurement
  Clock::time_point measured_at_;
  double ticks_per_second_ = 10.0;
};

struct TeleopSettings {
  double speed = 0.5;         // m/s
  double turn_rate = 1.0;     // rad/s
  double hold_seconds = 0.7;  // that a key counts after its last repetition
};

// TeleopKeys: turns the keys of a terminal into commands to a robot. A terminal reports no release of a key, so that a
// key counts until its repetition has been missing for a while.
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

// RawTerminal: a terminal whose keys arrive at once and are not shown, until the object is destroyed or the process
// ends by a signal that can be handled. Ctrl-C still sends SIGINT.
class RawTerminal {
 public:
  // The error: `descriptor` is no terminal. One at a time in a process.
  static Result<std::unique_ptr<RawTerminal>> Open(int descriptor);
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

 private:
  RawTerminal(int descriptor, const termios& before);

  int descriptor_;
  termios before_;
};

}  // namespace troupe
