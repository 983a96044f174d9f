// Real processes whose robots regain their memory: after the death of an agent, a rewind, and when a recording is
// continued.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

std::vector<pid_t> AgentsOf(const Program& run) {
  std::vector<pid_t> agents;
  for (const pid_t child : ChildrenOf(run.pid())) {
    if (CommandLineOf(child).find("robot-agent") != std::string::npos) agents.push_back(child);
  }
  return agents;
}

class MemoryOfRobotsTest : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_.Path(name); }
  std::vector<std::string> Lines(const std::string& name) const { return LinesOf(folder_.Read(name)); }
  // The pen for 100 ticks, with a hash log and a recording. Stateful controllers, sensor noise and odometry.
  void RunUndisturbed() const {
    OutputOf(RunPen({"--ticks", "100", "--hash-log", Path("whole"), "--in-process", "--record", Path("whole.mcap"),
                     "--keyframe-interval", "20"}));
    ASSERT_EQ(Lines("whole").size(), 101u);
  }
  // `troupe run` of the recording.
  Finished Continue(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"run", Path("whole.mcap"), "--speed", "max", "--headless", "--domain",
                                         std::to_string(TestDomain())});
    return Finish(Troupe(arguments));
  }
  Finished Verify(const std::string& name) const {
    return Finish(Troupe({"replay", Path(name), "--verify", "--controllers"}));
  }

  TemporaryFolder folder_;
};

TEST_F(MemoryOfRobotsTest, AgentsThatAreKilledChangeNoHash) {
  RunUndisturbed();
  Program run = RunPen({"--ticks", "100", "--speed", "4", "--hash-log", Path("killed"), "--on-agent-loss", "rebuild",
                        "--lease", "1", "--record", Path("killed.mcap"), "--session", TestSession("rebuild")});
  run.WaitForLine("ready");
  for (int i = 0; i < 3; ++i) {
    const std::vector<pid_t> agents = AgentsOf(run);
    ASSERT_FALSE(agents.empty());
    kill(agents[static_cast<std::size_t>(i) % agents.size()], SIGKILL);
    run.WaitForLineAfter("restart ");
  }
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_EQ(folder_.Read("killed"), folder_.Read("whole"));
  EXPECT_THAT(OutputOf(Verify("killed.mcap")), HasSubstr("400 proposals of controllers are equal"));
}

TEST_F(MemoryOfRobotsTest, AnAgentThatAlwaysDiesAtOneTickEndsTheRun) {
  std::ofstream(Path("abort.json")) << R"({"world": ")" << WorldPath("pen.world") << R"(", "robots": [{"name": "r2", )"
                                    << R"("controller": ")" ABORTING_LIBRARY R"("}]})";
  const std::string run =
      OutputOf(Troupe({"run", Path("abort.json"), "--ticks", "100", "--speed", "max", "--headless", "--on-agent-loss",
                       "rebuild", "--lease", "0.3", "--domain", std::to_string(TestDomain())}),
               3);
  EXPECT_THAT(run, HasSubstr("error: robot r2: the agent"));
  EXPECT_THAT(run, HasSubstr("after 3 restarts at tick 20"));
}

TEST_F(MemoryOfRobotsTest, ALiveRunIsRewound) {
  RunUndisturbed();
  const std::string session = TestSession("rewind");
  Program run = RunPen({"--ticks", "100", "--paused", "--speed", "max", "--hash-log", Path("rewound"), "--record",
                        Path("rewound.mcap"), "--session", session});
  ControlClient client(NetworkOf(session));
  ASSERT_TRUE(client.WaitForService(kSeconds).ok()) << run.output();
  run.WaitForLine("ready");
  std::vector<std::string> expected;  // lines of the hash log
  const std::vector<std::string> whole = Lines("whole");
  const auto call = [&](const control::Request& request) {
    const Result<ControlReply> reply = client.Call(request, kSeconds);
    ASSERT_TRUE(reply.ok() && reply.value().done) << (reply.ok() ? reply.value().problem : reply.error().message);
  };
  const auto expect = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i <= to; ++i) expected.push_back(whole[i]);
  };
  call(control::Step{.ticks = 60});
  expect(0, 60);
  call(control::Rewind{.tick = 25});
  call(control::Step{.ticks = 20});
  expect(25, 45);
  EXPECT_THAT(OutputOf(Troupe({"ctl", "rewind", "3", "--session", session, "--domain", std::to_string(TestDomain())})),
              HasSubstr("paused tick 3 hash " + whole[3].substr(2)));
  call(control::Play());
  expect(3, 100);
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_EQ(Lines("rewound"), expected);
  OutputOf(Verify("rewound.mcap"));
}

TEST_F(MemoryOfRobotsTest, ARecordingContinuesWithTheSameHashes) {
  RunUndisturbed();
  const std::vector<std::string> whole = Lines("whole");
  const std::vector<std::vector<std::string>> ways = {
      {"--from-tick", "37"},
      {"--from-tick", "40", "--in-process"},
      {"--from-tick", "0", "--robots-per-process", "3"},
      {"--from-tick", "63", "--robots-per-process", "4", "--faults", "loss=0.02,duplicate=0.05,reorder=0.05,seed=2"}};
  for (std::vector<std::string> arguments : ways) {
    SCOPED_TRACE(arguments[1]);
    const std::size_t from = std::stoul(arguments[1]);
    arguments.insert(arguments.end(),
                     {"--ticks", "100", "--hash-log", Path("branch"), "--record", Path("branch.mcap")});
    OutputOf(Continue(arguments));
    EXPECT_EQ(Lines("branch"),
              std::vector<std::string>(whole.begin() + static_cast<std::ptrdiff_t>(from), whole.end()));
    EXPECT_THAT(OutputOf(Verify("branch.mcap")), HasSubstr("101 states, of ticks 0 to 100, replayed"));
  }
  // From the last tick, beyond the end of the recording.
  OutputOf(Continue({"--ticks", "120", "--hash-log", Path("longer")}));
  OutputOf(RunPen({"--ticks", "120", "--hash-log", Path("reference"), "--in-process"}));
  const std::vector<std::string> expected = Lines("reference");
  EXPECT_EQ(Lines("longer"), std::vector<std::string>(expected.begin() + 100, expected.end()));
}

TEST_F(MemoryOfRobotsTest, ARecordingContinuesWithOtherControllersAndAnotherSeed) {
  RunUndisturbed();
  const std::vector<std::string> whole = Lines("whole");
  for (const std::string mode : {"--in-process", "--headless"}) {
    SCOPED_TRACE(mode);
    OutputOf(Continue({"--from-tick", "50", "--ticks", "100", "--hash-log", Path("changed"), "--record",
                       Path("changed.mcap"), "--controller", R"(r1=wander:{"speed": 0.2})", "--seed", "9", mode}));
    const std::vector<std::string> changed = Lines("changed");
    ASSERT_EQ(changed.size(), 51u);
    EXPECT_EQ(changed.front(), whole[50]);
    EXPECT_NE(changed.back(), whole[100]);
    OutputOf(Verify("changed.mcap"));
    if (mode == "--in-process") {
      std::ofstream(Path("first")) << folder_.Read("changed");
    } else {
      EXPECT_EQ(folder_.Read("changed"), folder_.Read("first"));
    }
  }
}

TEST_F(MemoryOfRobotsTest, ABadBranchIsRefused) {
  RunUndisturbed();
  const std::vector<std::pair<std::vector<std::string>, std::string>> bad = {
      {{"--from-tick", "101"}, "found tick 101, expected at most 100, the last of the recording"},
      {{"--controller", "r9=idle"},
       "option --controller: found robot 'r9', which the world does not have at that tick"},
      {{"--controller", "r1=wonder"}, "unknown controller 'wonder'"},
      {{"--from-tick", "50", "--ticks", "50"}, "option --ticks: found 50, expected more than 50"},
      {{"--record", Path("whole.mcap")}, "which the command reads"}};
  for (const auto& [arguments, problem] : bad) {
    for (const char* mode : {"--in-process", "--headless"}) {
      std::vector<std::string> all = arguments;
      all.emplace_back(mode);
      EXPECT_THAT(OutputOf(Continue(all), 2), HasSubstr(problem));
    }
  }
  EXPECT_THAT(OutputOf(RunPen({"--from-tick", "3"}), 2),
              HasSubstr("option --from-tick: found a world, expected a recording (.mcap)"));
}

}  // namespace
}  // namespace troupe::test
