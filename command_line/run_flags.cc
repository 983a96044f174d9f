#include "command_line/run_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "command_line/parse_command_line.h"

namespace troupe {
namespace {

// An option that replaces a setting if it is given. `parse` is called with texts that passed the check.
template <typename Value, typename Parse>
CLI::Option* AddOverride(CLI::App& app, const char* name, std::optional<Value>& target, Parse parse,
                         const std::string& help) {
  return app.add_option_function<std::string>(
      name, [&target, parse](const std::string& text) { target.emplace(parse(text)); }, help);
}

CLI::Option* AddOutput(CLI::App& app, const char* name, std::string& file, const char* help, const std::string& group) {
  return app.add_option(name, file, help)->check(NotEmpty())->type_name("FILE")->group(group);
}

void AddDomainFlag(CLI::App& app, NetworkSettings& settings, const std::string& group) {
  const std::string help =
      fmt::format("DDS domain of the simulation, 0 to {} (default: {})", kMaxDomain, settings.domain);
  app.add_option("--domain", settings.domain, help)
      ->check(DdsDomain())
      ->type_name("D")
      ->envname("TROUPE_DOMAIN")
      ->group(group);
}

void AddInterfaceFlag(CLI::App& app, NetworkSettings& settings, const std::string& default_interface,
                      const std::string& group) {
  const std::string help =
      "Name or IPv4 address of the network interface; auto: chosen by DDS (default: " + default_interface + ")";
  app.add_option("--interface", settings.network_interface, help)
      ->check(InterfaceValue())
      ->type_name("NAME")
      ->group(group);
}

void AddSecurityFlag(CLI::App& app, NetworkSettings& settings, const std::string& automatic, const std::string& group) {
  app.add_option("--security", settings.security,
                 "Folder of keys (see 'troupe keys'); off: any program of the network is a peer; auto: " + automatic +
                     " (default: auto)")
      ->check(NotEmpty())
      ->type_name("DIR|on|auto|off")
      ->group(group);
}

// A word in place of a flag: both values can be passed on to child processes.
void AddDataSharingFlag(CLI::App& app, NetworkSettings& settings, const std::string& group) {
  const auto set = [&settings](const std::string& text) { settings.data_sharing = text == "on"; };
  app.add_option_function<std::string>("--data-sharing", set,
                                       "Frames and proposals between processes of one machine: on: in shared memory; "
                                       "off: over the network (default: on)")
      ->check(OneOf({"on", "off"}))
      ->type_name("on|off")
      ->group(group);
}

// Where Gazebo looks for models, and so do the readers of its files (worldfile/gazebo/model_files.h).
constexpr const char* kModelPathVariable = "GZ_SIM_RESOURCE_PATH";

}  // namespace

CLI::Option* AddWorldFile(CLI::App& app, std::string& file) {
  app.add_option_function<std::vector<std::string>>(
         "--model-path",
         [](const std::vector<std::string>& folders) {
           // A variable, so that processes that are started have it, too, as they have the user's own.
           const char* const known = std::getenv(kModelPathVariable);
           std::string path = known != nullptr ? known : "";
           for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) {
             std::string absolute = std::filesystem::absolute(*folder).lexically_normal().string();
             if (!path.empty()) absolute.append(":").append(path);
             path = std::move(absolute);
           }
           setenv(kModelPathVariable, path.c_str(), 1);
         },
         "A folder with models of Gazebo or packages of ROS, before those of GZ_SIM_RESOURCE_PATH; repeatable")
      ->check(NotEmpty())
      ->type_name("DIR")
      ->allow_extra_args(false);
  return app
      .add_option(
          "FILE", file,
          "A Stage world (.world), a world, model or robot of Gazebo or ROS (.sdf, .world, .urdf, .xacro), a scenario "
          "or a layout (LIF) (.json), a building (.building.yaml), a ROS map (.yaml), a map of cells (.map, .pogema) "
          "or a problem of paths on one (.scen, .json of the League)")
      ->required()
      ->check(NotEmpty())
      ->type_name("");
}

void AddRobotFilesFlag(CLI::App& app, std::vector<std::string>& robots, const std::string& group) {
  app.add_option(
         "--robot", robots,
         "A robot that is added to the world, a file of URDF, xacro or SDF, at the origin or at X,Y and HEADING "
         "(m, degrees); repeatable")
      ->check(NotEmpty())
      ->type_name("FILE[@X,Y[,HEADING]]")
      ->allow_extra_args(false)
      ->group(group);
}

void AddSeedFlag(CLI::App& app, std::optional<std::uint64_t>& seed, const std::string& group) {
  app.add_option("--seed", seed, "Seed of all random numbers (default: the scenario's, or 0)")
      ->check(WholeNumber(0))
      ->type_name("S")
      ->group(group);
}

void AddControllerFlag(CLI::App& app, std::optional<std::string>& controller, const std::string& group) {
  app.add_option("--controller", controller,
                 "Controller of the robots without one in the file: idle (default), wander, expand, or the path of a "
                 "shared library")
      ->check(NotEmpty())
      ->type_name("NAME")
      ->group(group);
}

void AddBranchFlags(CLI::App& app, BranchFlags& flags, const std::string& group) {
  app.add_option("--controller", flags.controllers,
                 "Controller of the robots without one in the file: idle (default), wander, expand, or the path of a "
                 "shared library. With a recording also ROBOT=CONTROLLER, for one robot, repeatable, each with "
                 ":{...} for its parameters")
      ->check(NotEmpty())
      ->type_name("NAME")
      ->group(group)
      ->allow_extra_args(false);
  app.add_option("--from-tick", flags.from_tick,
                 "With a recording: the tick from which the run continues (default: the last)")
      ->check(WholeNumber(0))
      ->type_name("TICK")
      ->group(group);
}

// A value with '=' is an assignment to a robot unless a '/' comes first: a path may have any characters.
Status CheckBranchFlags(const std::string& file, BranchFlags& flags, std::optional<std::string>& controller) {
  if (file.ends_with(".mcap")) return {};
  if (flags.from_tick) return Error{{}, "option --from-tick: found a world, expected a recording (.mcap)"};
  if (flags.controllers.empty()) return {};
  const std::string& last = flags.controllers.back();
  const std::size_t equals = last.find('=');
  if (flags.controllers.size() > 1 || (equals != std::string::npos && last.find('/') > equals)) {
    return Error{{},
                 "option --controller: found '" + last +
                     "', expected one controller: only a run that continues from a recording has others for some "
                     "robots"};
  }
  controller = std::exchange(flags.controllers, {}).front();
  return {};
}

void AddAllowControllersFlag(CLI::App& app, std::vector<std::string>& paths, const std::string& group) {
  app.add_option("--allow-controllers", paths,
                 "Controller library or Python file, or a folder with such, that a world loaded during the run may "
                 "name; repeatable. "
                 "The libraries of the run's own file are allowed")
      ->check(NotEmpty())
      ->type_name("PATH")
      ->group(group)
      ->allow_extra_args(false);
}

void AddAllowFilesFlag(CLI::App& app, std::vector<std::string>& paths, const std::string& group) {
  app.add_option("--allow-files", paths,
                 "World file, or a folder with such, that may be loaded or spawned from during the run, by troupe ctl "
                 "or ROS 2; repeatable. The folder of the run's own file and the installed worlds are allowed")
      ->check(NotEmpty())
      ->type_name("PATH")
      ->group(group)
      ->allow_extra_args(false);
}

void AddRunFlags(CLI::App& app, RunOverrides& overrides, const std::string& group) {
  app.add_option("--ticks", overrides.ticks,
                 "Stop after N ticks, from 1 (default: the scenario's, or run until stopped)")
      ->check(WholeNumber(1))
      ->type_name("N")
      ->group(group);
  AddOverride(
      app, "--mode", overrides.mode, [](const std::string& word) { return *FindByName<Mode>(word); },
      "lockstep (default): each tick waits for all robots, and every run gives the same result; realtime: no tick "
      "waits "
      "for a late robot")
      ->check(OneOf(AllNames<Mode>()))
      ->type_name("MODE")
      ->group(group);
  AddOverride(
      app, "--speed", overrides.speed, [](const std::string& text) { return ParseSpeed(text).value(); },
      "Multiple of real time; max: as fast as possible (default: the file's, else 1 with a viewer, max without)")
      ->check(SpeedValue())
      ->type_name("X|max")
      ->group(group);
  AddOverride(
      app, "--on-agent-loss", overrides.on_agent_loss,
      [](const std::string& word) { return *FindByName<OnAgentLoss>(word); },
      "When a robot's process is lost: freeze the robot (default), pause the run until the robot rejoins, abort the "
      "run, or rebuild the memory of the robot's controller and continue as if nothing had happened")
      ->check(OneOf(AllNames<OnAgentLoss>()))
      ->type_name("POLICY")
      ->group(group);
}

// The inverse of AddRunFlags, AddRobotsPerProcessFlag and the flags of ROS.
std::vector<std::string> RunArguments(const RunOverrides& overrides) {
  std::vector<std::string> arguments;
  if (overrides.ticks) arguments.push_back(fmt::format("--ticks={}", *overrides.ticks));
  if (overrides.mode) arguments.push_back(std::string("--mode=") + NameOf(*overrides.mode));
  if (overrides.speed) arguments.push_back("--speed=" + ToString(*overrides.speed));
  if (overrides.is_watched) arguments.emplace_back("--watched");
  if (overrides.on_agent_loss) arguments.push_back(std::string("--on-agent-loss=") + NameOf(*overrides.on_agent_loss));
  if (overrides.robots_per_process) {
    arguments.push_back(fmt::format("--robots-per-process={}", *overrides.robots_per_process));
  }
  if (overrides.ros) arguments.emplace_back(*overrides.ros ? "--ros" : "--no-ros");
  return arguments;
}

void AddRobotsPerProcessFlag(CLI::App& app, std::optional<std::uint32_t>& robots, const std::string& group) {
  app.add_option("--robots-per-process", robots,
                 "Number of robots in one agent process (default: the scenario's, or 1)")
      ->check(WholeNumber(1, 100000))
      ->type_name("K")
      ->group(group);
}

void AddPausedFlag(CLI::App& app, bool& paused, const std::string& group) {
  app.add_flag("--paused", paused, "Start paused at tick 0, until troupe ctl or ROS 2 resumes the run")->group(group);
}

void AddThreadsFlag(CLI::App& app, std::optional<std::uint32_t>& threads, const std::string& automatic,
                    const std::string& group) {
  app.add_option(
         "--threads", threads,
         "Threads that divide the work of a tick; the result does not depend on it (default: " + automatic + ")")
      ->check(WholeNumber(1, 1024))
      ->type_name("N")
      ->group(group);
}

void AddStartTimeoutFlag(CLI::App& app, double& seconds, const std::string& group) {
  app.add_option("--start-timeout", seconds,
                 fmt::format("Seconds to wait for all robots to join; 0: no limit (default: {})", seconds))
      ->check(NumberFromZero())
      ->type_name("SECONDS")
      ->group(group);
}

void AddHashLogFlag(CLI::App& app, std::string& hash_log, const std::string& group) {
  AddOutput(app, "--hash-log", hash_log, "Write a line 'tick hash' for each tick", group);
}

void AddPosesFlag(CLI::App& app, std::string& poses, const std::string& group) {
  AddOutput(app, "--poses", poses,
            "Write CSV: tick,robot,x,y,z,heading,stalled (metres, radians); in a world with more than robots also "
            "kind,position,mode,on",
            group);
}

void AddRecordFlags(CLI::App& app, std::string& record, std::uint64_t& keyframe_interval, const std::string& group) {
  AddOutput(app, "--record", record,
            "FILE.mcap: write a recording, which 'troupe replay' steps again. Any other ending: write the states and "
            "events of all ticks as JSON lines",
            group);
  app.add_option(
         "--keyframe-interval", keyframe_interval,
         fmt::format("A recording has the whole state every TICKS ticks (default: {})", kDefaultKeyframeInterval))
      ->check(WholeNumber(1))
      ->type_name("TICKS")
      ->group(group);
}

void AddScansFlag(CLI::App& app, std::string& scans, const std::string& group) {
  AddOutput(app, "--scans", scans, "Write all ranger scans as JSON lines: tick, robot, sensor, ranges (metres)", group);
}

void AddFaultsFlag(CLI::App& app, std::string& faults) {
  app.add_option("--faults", faults,
                 "Simulate network faults: loss=P,duplicate=P,reorder=P,delay=P:SECONDS,latency=SECONDS:JITTER,"
                 "seed=N (P: probability)")
      ->check(FaultsValue())
      ->type_name("SPEC")
      ->group("Testing");
}

CLI::Option* AddSessionFlag(CLI::App& app, NetworkSettings& settings, const std::string& help,
                            const std::string& group) {
  return app.add_option("--session", settings.session, help)
      ->check(SessionName())
      ->type_name("NAME")
      ->envname("TROUPE_SESSION")
      ->group(group);
}

void AddServiceAddressFlag(CLI::App& app, NetworkSettings& settings, const std::string& help) {
  const auto check = [](const std::string& text) -> std::string {
    const bool is_ipv6 = std::count(text.begin(), text.end(), ':') > 1 || text.starts_with('[');
    return is_ipv6 ? "found '" + text + "', expected an IPv4 address or a name, and perhaps a port" : std::string();
  };
  app.add_option("--service", settings.service_address, help)
      ->check(CLI::Validator(check, ""))
      ->type_name("HOST[:PORT]");
}

void AddProcessNetworkFlags(CLI::App& app, NetworkSettings& settings, const std::string& default_interface,
                            const std::string& security, const std::string& group) {
  AddDomainFlag(app, settings, group);
  AddInterfaceFlag(app, settings, default_interface, group);
  app.add_option("--network", settings.network_profile,
                 "Network profile: one-host, lan (with multicast) or unicast (default: one-host on the loopback "
                 "interface, lan on others)")
      ->check(NetworkName())
      ->type_name("NAME")
      ->group(group);
  AddSecurityFlag(app, settings, security, group);
  AddDataSharingFlag(app, settings, group);
  app.add_option(
         "--lease", settings.lease_seconds,
         fmt::format("Seconds without a sign of life after which a process is lost, from {} to {} (default: {} on the "
                     "loopback interface, else {}, and a launcher waits for processes that live)",
                     kMinLeaseSeconds, kMaxLeaseSeconds, kDefaultLeaseSeconds, kDefaultNetworkLeaseSeconds))
      ->check(LeaseValue())
      ->type_name("SECONDS")
      ->group(group);
}

void AddToolNetworkFlags(CLI::App& app, NetworkSettings& settings) {
  AddDomainFlag(app, settings, "Options");
  AddInterfaceFlag(app, settings, settings.network_interface, "Options");
  AddServiceAddressFlag(app, settings, "Address of a world service that multicast does not reach");
  AddSecurityFlag(app, settings, "the keys of your own runs on this host, if they have any", "Options");
}

void AddTraceFlags(CLI::App& app, TraceOptions& trace, const std::string& group) {
  app.add_option("--trace", trace.file,
                 "Write the phases of all ticks as Chrome trace JSON, for ui.perfetto.dev or chrome://tracing")
      ->check(NotEmpty())
      ->type_name("FILE")
      ->group(group);
  const auto set = [&trace](const std::string& text) {
    const TraceOptions ticks = ParseTraceTicks(text).value();
    trace.first = ticks.first;
    trace.last = ticks.last;
  };
  app.add_option_function<std::string>("--trace-ticks", set,
                                       "Ticks that --trace covers; either end may be left out (default: all)")
      ->check(TraceTicksValue())
      ->type_name("FIRST:LAST")
      ->group(group);
}

// The file is another one for each process (its part).
std::vector<std::string> TraceArguments(const TraceOptions& trace, const std::string& file) {
  std::vector<std::string> arguments = {"--trace=" + file};
  if (trace.first > 0 || trace.last) {
    const std::string last = trace.last ? std::to_string(*trace.last) : "";
    arguments.push_back("--trace-ticks=" + std::to_string(trace.first) + ":" + last);
  }
  return arguments;
}

}  // namespace troupe
