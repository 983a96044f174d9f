// RunSettings: how a world is run. RunOverrides: the settings that a command line replaces.
//
// Nothing of a setting changes what happens in a tick: a world has the same states in lockstep and in real time, with
// one robot per process or with all of them in one, as long as every agent is in time. What decides on results is in
// the world description (tick length, seed).
//
// Words of users ("lockstep", "freeze") are listed beside their enumerators, in the order of the values, so that
// parser, printer and help agree. A setting of a command line replaces one of the scenario, which replaces the default.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/enum_names.h"
#include "troupe/result.h"

namespace troupe {

enum class Mode : std::uint8_t { kLockstep, kRealtime };
constexpr auto NamesOf(Mode) {
  return std::array{"lockstep", "realtime"};
}

enum class OnAgentLoss : std::uint8_t { kFreeze, kPause, kAbort, kRebuild };
constexpr auto NamesOf(OnAgentLoss) {
  return std::array{"freeze", "pause", "abort", "rebuild"};
}

// When the world service dies: another one continues the run, or the run ends.
enum class OnServiceLoss : std::uint8_t { kRestart, kEnd };
constexpr auto NamesOf(OnServiceLoss) {
  return std::array{"restart", "end"};
}

// A multiple of real time; nothing: as fast as possible.
using Speed = std::optional<double>;

// "max", or the shortest number that reads back as the same value.
std::string ToString(const Speed& speed);

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
  Speed watched_speed = 1.0;  // instead of it if the run is watched
  bool is_watched = false;    // a viewer shows the run
  OnAgentLoss on_agent_loss = OnAgentLoss::kFreeze;
  std::uint32_t robots_per_process = 1;
  std::uint32_t restart_agents = kDefaultRestartAgents;  // 0: none; none either with OnAgentLoss::kAbort
  // Wall time without an answer after which an agent is lost though its process lives; 0: it is waited for.
  double agent_deadline_seconds = 0.0;
  bool ros = false;                 // publish the robots to ROS 2
  bool ros_infinite_ranges = true;  // there a ray of a scan without a hit reads +Inf (REP 117), else range_max

  const Speed& pace() const { return is_watched ? watched_speed : speed; }
};

// Nothing: the setting keeps its value.
struct RunOverrides {
  std::optional<std::uint64_t> ticks;
  std::optional<Mode> mode;
  std::optional<Speed> speed;  // whether the run is watched or not
  bool is_watched = false;     // true replaces the setting
  std::optional<OnAgentLoss> on_agent_loss;
  std::optional<std::uint32_t> robots_per_process;
  std::optional<bool> ros;

  void ApplyTo(RunSettings& settings) const;
};

// Values of NetworkSettings::network_interface, beside the names and IPv4 addresses of interfaces.
inline constexpr const char* kLoopbackInterface = "lo";     // this host only
inline constexpr const char* kAutomaticInterface = "auto";  // the middleware chooses one
inline constexpr std::uint32_t kMaxDomain = 230;            // the last domain whose ports are valid
// Values of NetworkSettings::security, beside folders of keys.
inline constexpr const char* kSecurityAuto = "auto";
inline constexpr const char* kSecurityOff = "off";
// Wall times. A shorter lease expires between two signs of life, and DDS counts none below a nanosecond; it has no
// longer one either.
inline constexpr double kDefaultLeaseSeconds = 2.0;          // on the loopback interface
inline constexpr double kDefaultNetworkLeaseSeconds = 10.0;  // on others, which lose and delay packets
inline constexpr double kMinLeaseSeconds = 0.01;
inline constexpr double kMaxLeaseSeconds = 3600.0;

// A participant of a world service, for the agents that it serves.
struct ServiceParticipant {
  std::uint16_t port = 0;   // UDP, for NetworkSettings::service_address
  std::string participant;  // for NetworkSettings::service_participant

  bool operator==(const ServiceParticipant&) const = default;
};

// NetworkSettings: how the processes of a run find each other, and when they consider each other lost.
struct NetworkSettings {
  std::uint32_t domain = 42;  // DDS domain of the simulation, 0 to kMaxDomain; ROS 2 uses another one
  std::string session;        // DDS partition: runs in different sessions are isolated; without '*' and '?'
  std::string network_interface = kLoopbackInterface;  // a name, an IPv4 address, or "auto"
  std::string network_profile;  // transport/dds/binding/domain_config.h has the names; empty: chosen by the interface
  std::string service_address;  // of the world service, "host" or "host:port"; empty: this host
  // The participant of the world service, as 24 hexadecimal digits, for an agent: no other participant is one. Empty:
  // the participant that announces a run is the service of that run.
  std::string service_participant;
  // A folder of keys (docs/security.md), "off", or "auto": of a launcher, keys for its run alone; of any other program,
  // the keys that the user's run of this session has published, if it has any.
  std::string security = kSecurityAuto;
  // Frames and proposals between the service and agents of its machine travel through shared memory.
  bool data_sharing = true;
  // A process without a sign of life for longer is lost. Nothing: the default, and a process that a launcher knows to
  // live is not lost by that, so that a loaded machine does not change the result of a run.
  std::optional<double> lease_seconds;

  double lease() const {
    const bool is_loopback = network_interface == kLoopbackInterface || network_interface.starts_with("127.");
    return lease_seconds.value_or(is_loopback ? kDefaultLeaseSeconds : kDefaultNetworkLeaseSeconds);
  }
};

// HostSettings: the hosts of a scenario.
struct HostSettings {
  std::string name;     // in messages
  std::string address;  // by which the other hosts reach it
  // Shell command that starts a process there; docs/scenarios.md has its placeholders. Empty: by ssh.
  std::string start;
  std::string programs;           // the folder of Troupe's programs there; empty: the same as here
  std::string network_interface;  // name, address or "auto"; empty: the interface of `address`
  bool service = false;           // the world service runs there
  // The robots there: the robots of these names (with wildcards * and ?), or this number of the robots that no host
  // names. Neither: an equal share of the other robots.
  std::vector<std::string> robot_names;
  std::optional<std::uint32_t> robot_count;
  SourceLocation where;
};

// The distribution of a scenario over hosts.
struct HostsOfScenario {
  std::vector<HostSettings> hosts;  // none: this host only
  std::string network;              // a profile of transport/dds/binding/domain_config.h; empty: the default
};

}  // namespace troupe
