// RunSettings: how a world is run. RunOverrides: the settings that a command line replaces.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "troupe/result.h"

namespace troupe {

enum class Mode : std::uint8_t { kLockstep, kRealtime };
enum class OnAgentLoss : std::uint8_t { kFreeze, kPause, kAbort, kRebuild };

// When the world service dies: another one continues the run, or the run ends.
enum class OnServiceLoss : std::uint8_t { kRestart, kEnd };
inline constexpr std::array<std::string_view, 2> kOnServiceLossWords = {"restart", "end"};

// A multiple of real time; nothing: as fast as possible.
using Speed = std::optional<double>;

// Their words in scenarios and on command lines, in the order of the values.
inline constexpr std::array<std::string_view, 2> kModeWords = {"lockstep", "realtime"};
inline constexpr std::array<std::string_view, 4> kOnAgentLossWords = {"freeze", "pause", "abort", "rebuild"};

std::string ToString(Mode mode);
std::string ToString(OnAgentLoss policy);
// "max", or the shortest number that reads back as the same value.
std::string ToString(const Speed& speed);

// Nothing for any other word.
std::optional<Mode> ParseMode(std::string_view word);
std::optional<OnAgentLoss> ParseOnAgentLoss(std::string_view word);
// Reads a finite number above 0, or "max". The message of the error states the text found and the text expected.
Result<Speed> ParseSpeed(std::string_view text);

// Wall time for all robots to join; 0: no limit.
inline constexpr double kDefaultStartTimeoutSeconds = 60.0;

// Restarts by the launcher of each agent that died.
inline constexpr std::uint32_t kDefaultRestartAgents = 3;
inline constexpr std::uint32_t kMaxRestartAgents = 1'000'000;

// Ticks from one whole state in a recording to the next.
inline constexpr std::uint64_t kDefaultKeyframeInterval = 100;

// A scenario sets these.
struct RunSettings {
  std::optional<std::uint64_t> ticks;  // nothing: until stopped
  Mode mode = Mode::kLockstep;
  Speed speed;
  OnAgentLoss on_agent_loss = OnAgentLoss::kFreeze;
  std::uint32_t robots_per_process = 1;
  std::uint32_t restart_agents = kDefaultRestartAgents;  // 0: none; none either with OnAgentLoss::kAbort
  double agent_deadline_seconds = 10.0;  // wall time that the barrier waits for a silent agent before it is lost
  bool ros = false;                      // publish the robots to ROS 2
  bool ros_infinite_ranges = true;       // there a ray of a scan without a hit reads +Inf (REP 117), else range_max
};

// Nothing: the setting keeps its value.
struct RunOverrides {
  std::optional<std::uint64_t> ticks;
  std::optional<Mode> mode;
  std::optional<Speed> speed;
  std::optional<OnAgentLoss> on_agent_loss;
  std::optional<std::uint32_t> robots_per_process;
  std::optional<bool> ros;

  void ApplyTo(RunSettings& settings) const;
};

}  // namespace troupe
