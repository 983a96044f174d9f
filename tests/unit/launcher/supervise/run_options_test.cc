#include "launcher/supervise/run_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fstream>

#include "command_line/exclusive_options.h"
#include "launcher/commands/check_command.h"
#include "launcher/supervise/output_files.h"
#include "tests/support/files.h"
#include "tests/support/words.h"

namespace troupe {
namespace {

using testing::Contains;
using test::operator+;
using testing::HasSubstr;

struct Parsed {
  RunOptions options;
  std::string error;
};

Parsed Parse(std::vector<std::string> words) {
  Parsed parsed;
  CLI::App app;
  AddRunOptions(app, parsed.options);
  ExcludeOptions(app, "run");
  std::reverse(words.begin(), words.end());  // the order that CLI11 expects
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    parsed.error = error.what();
  }
  return parsed;
}

TEST(RunOptions, AcceptsEveryOptionOfTheManual) {
  Parsed parsed = Parse(test::Words(
      "w.world --ticks 600 --seed 7 --mode realtime --speed max --robots-per-process 2 --controller "
      "wander --session s --domain 3 --no-ros --headless --hash-log h --poses p --scans c --summary m --record r"));
  EXPECT_EQ(parsed.error, "");
  EXPECT_EQ(parsed.options.file, "w.world");
  EXPECT_EQ(parsed.options.run.ticks, 600u);
  EXPECT_EQ(parsed.options.run.robots_per_process, 2u);
  EXPECT_EQ(parsed.options.network.domain, 3u);
  EXPECT_EQ(parsed.options.run.ros, false);
}

TEST(RunOptions, StatesTheExpectedValueOfAnOption) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--ticks", "many"}, "--ticks: found 'many', expected a whole number from 1"},
      {{"--ticks", "-1"}, "expected a whole number from 1"},
      {{"--ticks", "0"}, "expected a whole number from 1"},
      {{"--ticks", "1.5"}, "expected a whole number from 1"},
      {{"--ticks", "99999999999999999999"}, "expected a whole number from 1"},
      {{"--seed", "x"}, "expected a whole number from 0"},
      {{"--mode", "fast"}, "--mode: found 'fast', expected one of lockstep, realtime"},
      {{"--speed", "0"}, "expected a multiple of real time above 0, or max"},
      {{"--speed", "nan"}, "expected a multiple of real time above 0, or max"},
      {{"--speed", "inf"}, "expected a multiple of real time above 0, or max"},
      {{"--speed", "2x"}, "expected a multiple of real time above 0, or max"},
      {{"--robots-per-process", "0"}, "expected a whole number from 1"},
      {{"--session", "a*"}, "expected 1 to 64 letters"},
      {{"--session", ""}, "expected 1 to 64 letters"},
      {{"--domain", "231"}, "expected a whole number from 0 to 230"},
      {{"--on-agent-loss", "cry"}, "expected one of freeze, pause, abort"},
      {{"--lease", "0"}, "expected seconds from 0.01 to 3600"},
      {{"--start-timeout", "-1"}, "expected a number from 0"},
      {{"--faults", "loss=2"}, "--faults: "},
      {{"--controller", ""}, "--controller: found '', expected a name"},
      {{"--ticks"}, "--ticks"},
      {{"--no-such-option"}, "--no-such-option"},
      {{"second.world"}, "second.world"},
  };
  for (const auto& [words, expected] : cases) {
    EXPECT_THAT(Parse(test::Words("w.world") + words).error, HasSubstr(expected)) << testing::PrintToString(words);
  }
  EXPECT_THAT(Parse({}).error, HasSubstr("FILE is required"));
}

TEST(RunOptions, RefusesOutputFilesThatCannotBeWritten) {
  auto complete = [](std::vector<std::string> words) {
    words.insert(words.begin(), "w.world");
    RunOptions options = Parse(words).options;
    Status failure = CheckOutputs(options);
    return !failure.ok() ? failure.error().ToString() : "";
  };
  EXPECT_THAT(complete({"--poses", "/no/such/folder/p"}),
              HasSubstr("--poses: cannot write /no/such/folder/p: No such"));
  EXPECT_THAT(complete({"--summary", "/tmp"}), HasSubstr("--summary: cannot write /tmp: Is a directory"));
  EXPECT_THAT(complete({"--poses", "same", "--record", "same"}), HasSubstr("--poses and --record name the same file"));
  EXPECT_EQ(complete({}), "");
}

TEST(RunOptions, NoOptionIsIgnoredBesideAnother) {
  const std::vector<std::pair<std::string, std::string>> pairs = {{"--in-process", "--robots-per-process 2"},
                                                                  {"--in-process", "--restart-agents 1"},
                                                                  {"--in-process", "--on-service-loss end"},
                                                                  {"--in-process", "--journal j.mcap"},
                                                                  {"--in-process", "--journal-sync"},
                                                                  {"--in-process", "--hosts a"},
                                                                  {"--in-process", "--interface lo"},
                                                                  {"--in-process", "--network lan"},
                                                                  {"--in-process", "--security on"},
                                                                  {"--in-process", "--data-sharing off"},
                                                                  {"--in-process", "--lease 1"},
                                                                  {"--in-process", "--shuffle-start 1"},
                                                                  {"--ros", "--no-ros"},
                                                                  {"--no-ros", "--ros-domain 1"},
                                                                  {"--no-ros", "--ros-lockstep a"},
                                                                  {"--no-ros", "--ros-map building"}};
  for (const auto& [first, second] : pairs) {
    const std::string error = Parse(test::Words("w.world " + first + " " + second)).error;
    EXPECT_THAT(error, HasSubstr(first)) << second;
    EXPECT_THAT(error, HasSubstr(second.substr(0, second.find(' ')))) << first;
  }
  EXPECT_THAT(Parse({"w.world", "--trace-ticks", "1:2"}).error, HasSubstr("--trace-ticks requires --trace"));
  RunOptions lines = Parse(test::Words("w.world --in-process --keyframe-interval 5 --record r.jsonl")).options;
  EXPECT_THAT(CompleteRunOptions(lines).error().ToString(), HasSubstr("--keyframe-interval: found no recording"));
}

TEST(RunOptions, GivesEachRunItsOwnSession) {
  RunOptions options = Parse({"/some/folder/my cave*.world"}).options;
  ASSERT_TRUE(CompleteRunOptions(options).ok());
  EXPECT_EQ(options.network.session, "mycave-" + std::to_string(getpid()));
}

TEST(RunOptions, HostsOfTheCommandLineReplaceThoseOfTheScenario) {
  const test::TemporaryFolder folder;
  const std::string scenario =
      folder.Write("s.json", R"({"world": "w.world", "hosts": ["alpha"], "network": "unicast"})");
  const auto complete = [&](std::vector<std::string> words) {
    words.insert(words.begin(), scenario);
    RunOptions options = Parse(words).options;
    const Status failure = CompleteRunOptions(options);
    EXPECT_TRUE(failure.ok()) << failure.error().ToString();
    return options;
  };
  EXPECT_EQ(complete({}).hosts.at(0).address, "alpha");
  EXPECT_TRUE(complete({"--in-process"}).hosts.empty());
  const RunOptions options = complete({"--hosts", "n1,n2", "--host-start", "srun -w {address} {command}"});
  ASSERT_EQ(options.hosts.size(), 2u);
  EXPECT_EQ(options.hosts[1].name, "n2");
  EXPECT_EQ(options.hosts[1].address, "n2");
  EXPECT_EQ(options.hosts[1].start, "srun -w {address} {command}");
  EXPECT_FALSE(options.hosts[0].service);
  EXPECT_EQ(options.network.network_profile, "unicast");
  EXPECT_EQ(options.network.network_interface, kAutomaticInterface);

  EXPECT_THAT(Parse({"w.world", "--hosts", "n1", "--host-start", "srun"}).error, HasSubstr("expected one, or"));
  EXPECT_THAT(Parse({"w.world", "--host-start", "srun {command}"}).error, HasSubstr("--hosts"));
  RunOptions twice = Parse({"w.world", "--hosts", "n1,n1"}).options;
  const Status failure = CompleteRunOptions(twice);
  ASSERT_FALSE(failure.ok());
  EXPECT_THAT(failure.error().ToString(), HasSubstr("found 'n1' twice"));
}

TEST(RunOptions, ARunWithAViewerIsWatched) {
  RunOptions watched = Parse({"w.world"}).options;
  ASSERT_TRUE(CompleteRunOptions(watched).ok());
  EXPECT_THAT(ServiceArguments(watched), Contains("--watched"));
  RunOptions headless = Parse({"w.world", "--headless"}).options;
  ASSERT_TRUE(CompleteRunOptions(headless).ok());
  EXPECT_THAT(ServiceArguments(headless), testing::Not(Contains("--watched")));
}

TEST(RunOptions, OverridesOnlyTheGivenSettings) {
  RunSettings settings{.ticks = 5, .speed = 2.0, .on_agent_loss = OnAgentLoss::kPause};
  Parse({"w.world"}).options.run.ApplyTo(settings);
  EXPECT_EQ(settings.ticks, 5u);
  EXPECT_EQ(settings.speed, 2.0);
  EXPECT_EQ(settings.on_agent_loss, OnAgentLoss::kPause);
  Parse({"w.world", "--ticks", "9", "--speed", "max", "--on-agent-loss", "abort"}).options.run.ApplyTo(settings);
  EXPECT_EQ(settings.ticks, 9u);
  EXPECT_FALSE(settings.speed);
  EXPECT_EQ(settings.on_agent_loss, OnAgentLoss::kAbort);
}

TEST(RunOptions, ArePassedToTheServiceAndTheAgents) {
  RunOptions options = Parse({"w.world", "--ticks", "9", "--session", "s", "--poses", "p", "--lease", "0.5",
                              "--allow-files", "worlds", "--allow-controllers", "more", "--controller", "./default.so"})
                           .options;
  ASSERT_TRUE(CheckBranchFlags(options.file, options.branch, options.load.controller).ok());
  std::vector<std::string> service = ServiceArguments(options);
  EXPECT_EQ(service.front(), "w.world");
  EXPECT_THAT(service, testing::IsSupersetOf({"--ticks=9", "--session=s", "--domain=42", "--poses=p", "--lease=0.5",
                                              "--allow-files=worlds", "--allow-controllers=more"}));
  std::vector<std::string> agent = AgentArguments(options, "127.0.0.1:7", {"r 0", "-r"}, {"own.so"}, false);
  EXPECT_THAT(agent, testing::IsSupersetOf({"--session=s", "--service=127.0.0.1:7", "--robot=r 0", "--robot=-r",
                                            "--lease=0.5", "--allow-controllers=own.so", "--allow-controllers=more",
                                            "--allow-controllers=./default.so"}));
  EXPECT_THAT(agent, testing::Not(Contains(HasSubstr("--ticks"))));
  EXPECT_THAT(agent, testing::Not(Contains(HasSubstr("--ros"))));
}

TEST(RunOptions, AgentsLookForTheServiceAsLongAsItWaitsForThem) {
  const auto session_timeout = [](const std::string& start_timeout) {
    const RunOptions options = Parse({"w.world", "--start-timeout", start_timeout}).options;
    for (const std::string& word : AgentArguments(options, "127.0.0.1:7", {"r"}, {}, false)) {
      if (word.starts_with("--session-timeout=")) return word;
    }
    return std::string();
  };
  EXPECT_EQ(session_timeout("600"), "--session-timeout=600");
  EXPECT_EQ(session_timeout("0"), "--session-timeout=0");
  EXPECT_EQ(session_timeout("5"), "");  // an agent that was cut off has its 60 s all the same
}

TEST(RunOptions, AboutRosArePassedToTheServiceAndTheAgents) {
  RunOptions options =
      Parse(
          test::Words("w.world --ros --ros-domain 7 --ros-distro humble --ros-interface lo --ros-cmd-vel both "
                      "--ros-reliable-commands --ros-command-timeout 0.25 --ros-tf namespaced --ros-participants host "
                      "--ros-clock-rate 50 --ros-rviz goal --no-ros-map-odom --no-ros-odom-base"))
          .options;
  const std::vector<std::string> common = test::Words(
      "--ros --ros-domain=7 --ros-distro=humble --ros-interface=lo --ros-tf=namespaced --ros-clock-rate=50");
  const std::vector<std::string> of_robots = {"--ros-cmd-vel=both", "--ros-reliable-commands",
                                              "--ros-command-timeout=0.25", "--no-ros-map-odom", "--no-ros-odom-base"};
  const std::vector<std::string> service = ServiceArguments(options);
  EXPECT_THAT(service, testing::IsSupersetOf(common));
  EXPECT_THAT(service, Contains("--ros-rviz=goal"));
  for (const std::string& word : of_robots) EXPECT_THAT(service, testing::Not(Contains(word)));
  const std::vector<std::string> agent = AgentArguments(options, "127.0.0.1:7", {"r"}, {}, true);
  EXPECT_THAT(agent, testing::IsSupersetOf(common));
  EXPECT_THAT(agent, testing::IsSupersetOf(of_robots));
  EXPECT_THAT(agent, testing::Not(Contains("--ros-rviz=goal")));
  RunSettings settings;
  options.run.ApplyTo(settings);
  EXPECT_TRUE(settings.ros);
}

std::string Fault(const std::string& file, const std::optional<std::string>& controller = {}) {
  const Status fault = CheckControllers(file, controller);
  return !fault.ok() ? fault.error().ToString() : "";
}

TEST(CheckControllers, NamesTheLineOfAScenariosController) {
  const std::string path = testing::TempDir() + "check_controllers_test.json";
  std::ofstream(path) << "{\"robots\": [\n  {\"model\": \"position\", \"controller\": \"wonder\"}]}";
  EXPECT_EQ(
      Fault(path),
      path +
          ":2:39: error: unknown controller 'wonder', expected one of: dynamic, expand, fasr, fasr2, fasr_plan, fetch, "
          "flock, follow, go_to, idle, lanes, lasernoise, patrol, pioneer_flocking, rasterize, script, sink, slotcar, "
          "source, vda5050, "
          "wander, "
          "or the path of a shared library (.so); did you mean 'wander'?");
}

TEST(CheckControllers, ChecksParametersToo) {
  const std::string path = testing::TempDir() + "check_controllers_test.json";
  std::ofstream(path) << R"({"controller": {"name": "script", "parameters": {"commands": []}}})";
  EXPECT_EQ(Fault(path).substr(path.size()),
            ":1:16: error: script: found no 'commands', expected a list of {\"at\": seconds, ...}");
}

// Whatever follows the name is ignored in Stage, and a warning of the loader here.
TEST(CheckControllers, LeavesAWorldsControllersToItsLoader) {
  const std::string path = testing::TempDir() + "check_controllers_test.world";
  std::ofstream(path) << "position( ctrl \"wander -1\" )\n";
  EXPECT_EQ(Fault(path), "");
}

TEST(CheckControllers, ChecksTheOption) {
  EXPECT_EQ(Fault("some.world", "idle"), "");
  EXPECT_EQ(Fault("some.world", "wonder").substr(0, 52), "error: option --controller: unknown controller 'wond");
  EXPECT_EQ(Fault("some.world", "").substr(0, 49), "error: option --controller: unknown controller ''");
}

}  // namespace
}  // namespace troupe
