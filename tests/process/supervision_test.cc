// Supervision of processes: stops, kills and losses, and no process left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

// A run without end, after its first tick.
class LongRun {
 public:
  explicit LongRun(std::vector<std::string> arguments = {}) : program_(RunPen(WithSpeed(std::move(arguments)))) {
    program_.WaitForLine("4 robots in 4 agent processes, ready");
    children_ = ChildrenOf(program_.pid());
    EXPECT_EQ(children_.size(), 5u);
  }

  Program& program() { return program_; }
  pid_t Child(const std::string& part) const {
    for (pid_t child : children_) {
      if (CommandLineOf(child).find(part) != std::string::npos) return child;
    }
    throw std::runtime_error("no child with " + part);  // 0 would be a signal to all processes of the test
  }
  void ExpectNoProcessLeft() const {
    for (pid_t child : children_) EXPECT_TRUE(IsGoneSoon(child)) << CommandLineOf(child);
  }

 private:
  static std::vector<std::string> WithSpeed(std::vector<std::string> arguments) {
    for (const char* word : {"--speed", "10", "--lease", "0.5"}) arguments.push_back(word);
    return arguments;
  }

  Program program_;
  std::vector<pid_t> children_;
};

class StopSignal : public testing::TestWithParam<int> {};

TEST_P(StopSignal, EndsARunInOrderWithStatus130AndItsFiles) {
  TemporaryFolder folder;
  LongRun run({"--summary", folder.Path("summary"), "--hash-log", folder.Path("hashes")});
  run.program().Signal(GetParam());
  EXPECT_EQ(run.program().Wait(), 130);
  EXPECT_THAT(run.program().output(), HasSubstr("stopped before its end"));
  run.ExpectNoProcessLeft();
  nlohmann::json summary = nlohmann::json::parse(folder.Read("summary"), nullptr, false);
  EXPECT_EQ(summary["interrupted"], true);
  EXPECT_EQ(summary["lost"], nlohmann::json::array());
  // The last line is complete.
  std::string last =
      std::to_string(summary["ticks"].get<int>()) + " " + summary["state_hash"].get<std::string>() + "\n";
  EXPECT_THAT(folder.Read("hashes"), testing::EndsWith(last));
}

INSTANTIATE_TEST_SUITE_P(Signals, StopSignal, testing::Values(SIGINT, SIGTERM, SIGHUP));

TEST(Supervision, CtrlCStopsARunInProcessToo) {
  Program program = RunPen({"--in-process", "--speed", "1"});
  program.WaitForLine("4 robots in this process, ready");
  program.Interrupt();
  EXPECT_THAT(program.output(), HasSubstr("stopped before its end"));
}

// A terminal with `troupe run` of a few ticks in it, as a user has one.
class TerminalRun {
 public:
  explicit TerminalRun(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {ProgramPath("troupe"), "run", WorldPath("pen.world"), "--ticks", "2",
                                         "--domain", std::to_string(TestDomain())});
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    process_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (process_ == 0) {
      setenv("TERM", "xterm", 1);
      unsetenv("NO_COLOR");
      execv(words[0], words.data());
      _exit(127);
    }
    EXPECT_GT(process_, 0);
  }
  ~TerminalRun() {
    if (!status_) kill(process_, SIGKILL);
    close(terminal_);
  }

  // What the terminal has shown, once it has this text or the run has ended.
  std::string ShownWith(const std::string& text) {
    EXPECT_TRUE(Eventually([&] {
      pollfd waited{terminal_, POLLIN, 0};
      char bytes[4096];
      while (poll(&waited, 1, 0) == 1 && (waited.revents & POLLIN) != 0) {
        const ssize_t size = read(terminal_, bytes, sizeof bytes);
        if (size <= 0) break;
        shown_.append(bytes, static_cast<std::size_t>(size));
      }
      return shown_.find(text) != std::string::npos || HasEnded();
    })) << shown_;
    return shown_;
  }
  void TypeCtrlC() { EXPECT_EQ(write(terminal_, "\x03", 1), 1); }
  bool HasEnded() {
    int status = 0;
    if (!status_ && waitpid(process_, &status, WNOHANG) == process_) status_ = status;
    return status_.has_value();
  }
  int ExitStatus() {
    EXPECT_TRUE(Eventually([&] { return HasEnded(); }));
    return status_ && WIFEXITED(*status_) ? WEXITSTATUS(*status_) : -1;
  }

 private:
  int terminal_ = -1;
  pid_t process_ = -1;
  std::optional<int> status_;
  std::string shown_;
};

class RunOnATerminal : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(RunOnATerminal, WithAViewerStaysOpenUntilCtrlC) {
  TerminalRun run(GetParam());
  const std::string shown = run.ShownWith("its page stays open until Ctrl-C");
  EXPECT_THAT(shown, HasSubstr("2 ticks, 0.2 s simulated"));  // the summary is there already
  EXPECT_THAT(shown, HasSubstr("viewer: \033[1;4mhttp://"));
  EXPECT_FALSE(run.HasEnded());
  run.TypeCtrlC();
  EXPECT_EQ(run.ExitStatus(), 0);
}

TEST_P(RunOnATerminal, WithoutAViewerEnds) {
  std::vector<std::string> arguments = GetParam();
  arguments.emplace_back("--headless");
  TerminalRun run(arguments);
  EXPECT_EQ(run.ExitStatus(), 0);
}

INSTANTIATE_TEST_SUITE_P(Ways, RunOnATerminal,
                         testing::Values(std::vector<std::string>{}, std::vector<std::string>{"--in-process"}));

TEST(Supervision, CtrlCBeforeAllRobotsHaveJoinedStopsToo) {
  Program program = RunPen({"--faults", "loss=1,seed=1"});
  ASSERT_TRUE(Eventually([&] { return ChildrenOf(program.pid()).size() > 1; }));
  std::vector<pid_t> children = ChildrenOf(program.pid());
  program.Interrupt();
  for (pid_t child : children) EXPECT_TRUE(IsGoneSoon(child));
}

TEST(Supervision, AKilledLauncherLeavesNoProcess) {
  LongRun run;
  run.program().Signal(SIGKILL);
  EXPECT_EQ(run.program().Wait(), 128 + SIGKILL);
  run.ExpectNoProcessLeft();
}

TEST(Supervision, AKilledLauncherLeavesNoFilesButItsOutputs) {
  TemporaryFolder folder;
  LongRun run({"--scans", folder.Path("scans")});
  run.program().Signal(SIGKILL);
  run.program().Wait();
  run.ExpectNoProcessLeft();
  EXPECT_EQ(folder.size(), 0u);  // scans are written at the end
}

TEST(Supervision, AStoppedLauncherThatIsKilledLeavesNoProcess) {
  LongRun run;
  run.program().Signal(SIGSTOP);
  run.program().Signal(SIGKILL);
  run.program().Wait();
  run.ExpectNoProcessLeft();
}

TEST(Supervision, AKilledWorldServiceFailsTheRunIfTheUserWantsSo) {
  TemporaryFolder folder;
  LongRun run({"--on-service-loss", "end", "--hash-log", folder.Path("hashes")});
  ASSERT_TRUE(Eventually([&] { return LinesOf(folder.Read("hashes")).size() > 2; })) << "lines are written soon";
  kill(run.Child("world-service"), SIGKILL);
  EXPECT_EQ(run.program().Wait(), 3);
  EXPECT_THAT(run.program().output(), HasSubstr("error: the world service was killed by signal 9 (Killed)"));
  run.ExpectNoProcessLeft();
}

TEST(Supervision, AHangingAgentDoesNotPreventTheEndOfTheRun) {
  LongRun run;
  kill(run.Child("--robot=r2"), SIGSTOP);
  run.program().WaitForLine("r2 has lost its agent");
  run.program().Interrupt();
  run.ExpectNoProcessLeft();
}

TEST(AgentLoss, TheOtherRobotsContinueToTheEnd) {
  TemporaryFolder folder;
  LongRun run({"--ticks", "400", "--summary", folder.Path("summary"), "--poses", folder.Path("poses"),
               "--restart-agents", "0"});
  kill(run.Child("--robot=r1"), SIGKILL);
  EXPECT_EQ(run.program().Wait(), 5);
  EXPECT_THAT(run.program().output(), HasSubstr("was killed by signal 9 (Killed); to start it again:"));
  EXPECT_THAT(run.program().output(), HasSubstr("1 robot stood still in some ticks, without an agent"));
  EXPECT_THAT(run.program().output(), HasSubstr("without an agent at the end: r1"));
  nlohmann::json summary = nlohmann::json::parse(folder.Read("summary"), nullptr, false);
  EXPECT_EQ(summary["ticks"], 400);
  EXPECT_EQ(summary["frozen"], 1);
  EXPECT_EQ(summary["lost"], nlohmann::json::array({"r1"}));
  EXPECT_THAT(folder.Read("poses"), HasSubstr("\n400,r1,"));
  run.ExpectNoProcessLeft();
}

TEST(AgentLoss, ARobotRestartedByHandRejoins) {
  LongRun run({"--restart-agents", "0"});
  kill(run.Child("--robot=r1"), SIGKILL);
  std::string command = run.program().WaitForLineAfter("to start it again:");
  run.program().WaitForLine("r1 has lost its agent");
  Program agent({"/bin/sh", "-c", "exec " + command});
  run.program().WaitForLine("r1 has an agent");
  run.program().Interrupt();
  EXPECT_EQ(agent.Wait(), 0) << agent.output();
  run.ExpectNoProcessLeft();
}

// Every robot has scans to the end, whichever way its agent was started again.
void ExpectAllScans(const TemporaryFolder& folder) {
  std::map<std::string, int> last_tick;
  for (const std::string& line : LinesOf(folder.Read("scans"))) {
    nlohmann::json scan = nlohmann::json::parse(line);
    last_tick[scan["robot"]] = scan["tick"];
  }
  EXPECT_EQ(last_tick, (std::map<std::string, int>{{"r0", 99}, {"r1", 99}, {"r2", 99}, {"r3", 99}}));
}

TEST(AgentLoss, ScansOfARobotRestartedByHandAreInTheFile) {
  TemporaryFolder folder;
  LongRun run({"--scans", folder.Path("scans"), "--ticks", "100", "--on-agent-loss", "pause", "--restart-agents", "0"});
  kill(run.Child("--robot=r1"), SIGKILL);
  Program agent({"/bin/sh", "-c", "exec " + run.program().WaitForLineAfter("to start it again:")});
  EXPECT_EQ(run.program().Wait(), 0) << run.program().output();
  EXPECT_EQ(agent.Wait(), 0) << agent.output();
  ExpectAllScans(folder);
}

// The events joined and left of a robot in a recording.
std::vector<std::string> MembershipEventsOf(const std::string& robot, const std::string& record) {
  std::vector<std::string> events;
  for (const std::string& line : LinesOf(record)) {
    const nlohmann::json tick = nlohmann::json::parse(line);
    for (const nlohmann::json& event : tick.value("events", nlohmann::json::array())) {
      if (event.value("robot", "") != robot) continue;
      if (event["event"] == "joined" || event["event"] == "left") events.push_back(event["event"]);
    }
  }
  return events;
}

TEST(AgentLoss, AKilledAgentIsStartedAgainAndRejoins) {
  TemporaryFolder folder;
  LongRun run({"--scans", folder.Path("scans"), "--ticks", "100", "--summary", folder.Path("summary"), "--record",
               folder.Path("record"), "--on-agent-loss", "pause"});
  kill(run.Child("--robot=r1"), SIGKILL);
  EXPECT_EQ(run.program().Wait(), 0) << run.program().output();
  EXPECT_THAT(run.program().output(), HasSubstr("was killed by signal 9 (Killed); restart 1 of 3\n"));
  EXPECT_THAT(run.program().output(), testing::Not(HasSubstr("to start it again")));
  ExpectAllScans(folder);
  const nlohmann::json summary = nlohmann::json::parse(folder.Read("summary"), nullptr, false);
  EXPECT_EQ(summary["agents_restarted"], 1);
  EXPECT_EQ(summary["lost"], nlohmann::json::array());
  EXPECT_THAT(MembershipEventsOf("r1", folder.Read("record")), testing::ElementsAre("joined", "left", "joined"));
  run.ExpectNoProcessLeft();
}

// As one that a malformed message of the handshake has ended. With the usual lease: a shorter one can expire during a
// handshake, which then never completes (docs/reliability.md).
TEST(AgentLoss, WithKeysARunGoesOnAfterASegmentationFaultOfAnAgent) {
  TemporaryFolder folder;
  setenv("ASAN_OPTIONS", "handle_segv=0", 1);  // which would end it by exit()
  Program run = RunPen({"--security", "on", "--speed", "10", "--ticks", "100", "--summary", folder.Path("summary"),
                        "--hash-log", folder.Path("hashes"), "--on-agent-loss", "rebuild"});
  unsetenv("ASAN_OPTIONS");
  run.WaitForLine("4 robots in 4 agent processes, ready");
  for (const pid_t agent : ChildrenWith(run, "--robot=r1")) kill(agent, SIGSEGV);
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_THAT(run.output(), HasSubstr("was killed by signal 11 (Segmentation fault"));
  EXPECT_THAT(run.output(), HasSubstr("restart 1 of "));
  const nlohmann::json summary = nlohmann::json::parse(folder.Read("summary"), nullptr, false);
  EXPECT_EQ(summary["agents_restarted"], 1);
  EXPECT_EQ(summary["lost"], nlohmann::json::array());
  OutputOf(RunPen({"--ticks", "100", "--in-process", "--hash-log", folder.Path("undisturbed")}));
  EXPECT_EQ(folder.Read("hashes"), folder.Read("undisturbed"));
}

TEST(AgentLoss, AnAgentThatDiesBeforeTheRunBeginsIsStartedAgain) {
  Program run = RunPen({"--ticks", "5", "--lease", "0.5", "--shuffle-start", "3"});
  pid_t agent = 0;
  ASSERT_TRUE(Eventually([&] {
    for (const pid_t child : ChildrenOf(run.pid())) {
      if (CommandLineOf(child).find("robot-agent") != std::string::npos) agent = child;
    }
    return agent != 0;
  }));
  ASSERT_EQ(kill(agent, SIGKILL), 0);
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_THAT(run.output(), HasSubstr("was killed by signal 9 (Killed); restart 1 of "));
}

TEST(AgentLoss, AnAgentIsStartedAgainOnlyAsOftenAsAllowed) {
  TemporaryFolder folder;
  LongRun run({"--ticks", "400", "--summary", folder.Path("summary"), "--restart-agents", "2"});
  pid_t agent = run.Child("--robot=r2");
  for (int restart = 1; restart <= 3; ++restart) {
    kill(agent, SIGKILL);
    if (restart == 3) break;
    run.program().WaitForLine("restart " + std::to_string(restart) + " of 2");
    const pid_t before = agent;
    ASSERT_TRUE(Eventually([&] {
      for (const pid_t child : ChildrenOf(run.program().pid())) {
        if (child != before && CommandLineOf(child).find("--robot=r2") != std::string::npos) agent = child;
      }
      return agent != before;
    }));
  }
  EXPECT_EQ(run.program().Wait(), 5) << run.program().output();
  EXPECT_THAT(run.program().output(), HasSubstr("was killed by signal 9 (Killed); to start it again:"));
  EXPECT_THAT(run.program().output(), HasSubstr("without an agent at the end: r2"));
  const nlohmann::json summary = nlohmann::json::parse(folder.Read("summary"), nullptr, false);
  EXPECT_EQ(summary["agents_restarted"], 2);
  EXPECT_EQ(summary["ticks"], 400);
  run.ExpectNoProcessLeft();
}

TEST(AgentLoss, NoAgentIsStartedAgainForARebuildIfTheUserWantsNone) {
  LongRun run({"--on-agent-loss", "rebuild", "--restart-agents", "0"});
  kill(run.Child("--robot=r1"), SIGKILL);
  Program agent({"/bin/sh", "-c", "exec " + run.program().WaitForLineAfter("to start it again:")});
  run.program().WaitForLine("r1 has an agent");
  run.program().Interrupt();
  EXPECT_EQ(agent.Wait(), 0) << agent.output();
}

// Without --lease a death is known at once, and nothing else is a loss.
TEST(AgentLoss, IsKnownLongBeforeTheLeaseOfAKilledAgent) {
  TemporaryFolder folder;
  Program run = RunPen({"--speed", "10", "--ticks", "400", "--summary", folder.Path("summary")});
  run.WaitForLine("4 robots in 4 agent processes, ready");
  for (const pid_t agent : ChildrenWith(run, "--robot=r1")) kill(agent, SIGKILL);
  EXPECT_EQ(run.Wait(), 5) << run.output();
  EXPECT_THAT(run.output(), HasSubstr("its process was killed by signal 9 (Killed)"));
  EXPECT_THAT(run.output(), testing::Not(HasSubstr("without an agent at the end")));
  EXPECT_EQ(nlohmann::json::parse(folder.Read("summary"), nullptr, false)["frozen"], 1);
}

TEST(AgentLoss, AnAgentIsStartedAgainForTheRobotsThatWereNotDeleted) {
  const std::string session = TestSession("deleted");
  Program run = RunPen({"--session", session, "--speed", "10", "--lease", "0.5", "--robots-per-process", "2"});
  run.WaitForLine("4 robots in 2 agent processes, ready");
  ASSERT_EQ(Finish(Troupe({"ctl", "delete", "r0", "--domain", std::to_string(TestDomain()), "--session", session}))
                .exit_status,
            0);
  for (const pid_t child : ChildrenOf(run.pid())) {
    if (CommandLineOf(child).find("--robot=r0") != std::string::npos) kill(child, SIGKILL);
  }
  run.WaitForLine("r1 has an agent");
  run.Interrupt();
  EXPECT_THAT(run.output(), testing::Not(HasSubstr("without an agent at the end")));
}

// A robot is deleted and returns by `back`, so that it has another agent than at first. Then agents die, and the
// service.
void ExpectToSurviveDeathsAfterAReturn(const std::vector<std::string>& more, const control::Request& back) {
  const std::string session = TestSession("returned");
  std::vector<std::string> arguments = Words("--paused --speed max --ticks 40 --robots-per-process 2", {});
  arguments.insert(arguments.end(), {"--session", session});
  arguments.insert(arguments.end(), more.begin(), more.end());
  Program run = RunPen(arguments);
  run.WaitForLine("4 robots in 2 agent processes, ready");
  const auto ask = [&](const control::Request& request) {
    const ControlReply reply = CallRun(session, request);
    EXPECT_TRUE(reply.done) << reply.problem << run.output();
  };
  ask(control::Step{.ticks = 3});
  ask(control::Delete{.name = "r0"});
  ask(control::Step{.ticks = 2});
  ask(back);
  for (const char* program : {"--robot=r1", "--robot=r0", "world-service", "--robot=r0"}) {
    SCOPED_TRACE(program);
    const std::vector<pid_t> children = ChildrenWith(run, program);
    ASSERT_FALSE(children.empty()) << run.output();
    std::set<std::uint32_t> dead;
    for (const pid_t child : children) {
      kill(child, SIGKILL);
      dead.insert(static_cast<std::uint32_t>(child));
    }
    EXPECT_TRUE(Eventually([&] {
      const ControlReply reply = CallRun(session, control::Entities());
      return 4 == std::count_if(reply.entities.begin(), reply.entities.end(), [&](const EntityReport& entity) {
               return entity.agent && entity.agent->present && !dead.contains(entity.agent->pid);
             });
    })) << run.output();
    ask(control::Step{.ticks = 2});
  }
  ask(control::Play());
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_THAT(run.output(), testing::Not(HasSubstr("has an agent already")));
  EXPECT_THAT(run.output(), testing::Not(HasSubstr("without an agent at the end")));
}

TEST(AgentLoss, ARobotThatWasDeletedAndResetHasAnAgentAfterAnyDeath) {
  ExpectToSurviveDeathsAfterAReturn({"--on-agent-loss", "rebuild"}, control::Reset());
}

TEST(AgentLoss, ARobotThatWasDeletedAndRestoredHasAnAgentAfterAnyDeath) {
  // Between the death and the return of an agent its robot stands still.
  ExpectToSurviveDeathsAfterAReturn({"--on-agent-loss", "freeze"},
                                    control::Restore{.source = "r0", .name = "r0", .pose = {.x = -2.0, .y = -2.0}});
}

TEST(AgentLoss, WithKeysARobotThatWasDeletedAndRewoundHasAnAgentAfterAnyDeath) {
  ExpectToSurviveDeathsAfterAReturn({"--on-agent-loss", "rebuild", "--security", "on"}, control::Rewind{.tick = 1});
}

TEST(AgentLoss, AnAgentThatWasStoppedInOrderIsNotStartedAgain) {
  LongRun run;
  kill(run.Child("--robot=r1"), SIGTERM);
  run.program().WaitForLine("ended with exit status 130; to start it again:");
  run.program().Interrupt();
  EXPECT_THAT(run.program().output(), testing::Not(HasSubstr("; restart ")));
  run.ExpectNoProcessLeft();
}

TEST(AgentLoss, ARobotThatRejoinsWithinItsLeaseContinues) {
  LongRun run({"--on-agent-loss", "pause", "--restart-agents", "0"});
  kill(run.Child("--robot=r3"), SIGKILL);
  Program agent({"/bin/sh", "-c", "exec " + run.program().WaitForLineAfter("to start it again:")});
  run.program().WaitForLine("r3 has an agent");
  run.program().Interrupt();
  EXPECT_EQ(agent.Wait(), 0) << agent.output();
}

TEST(AgentLoss, EndsTheRunUnderThePolicyAbort) {
  LongRun run({"--on-agent-loss", "abort"});
  kill(run.Child("--robot=r0"), SIGKILL);
  EXPECT_EQ(run.program().Wait(), 3);
  EXPECT_THAT(run.program().output(), HasSubstr("error: "));
  EXPECT_THAT(run.program().output(), HasSubstr("r0"));
  EXPECT_THAT(run.program().output(), testing::Not(HasSubstr("; restart ")));
  run.ExpectNoProcessLeft();
}

}  // namespace
}  // namespace troupe::test
