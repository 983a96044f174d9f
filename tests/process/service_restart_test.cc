// The world service is killed, and another one continues the run from its journal: the files of the run are those of
// one without a kill.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

pid_t ServiceOf(const Program& run) {
  for (const pid_t child : ChildrenOf(run.pid())) {
    if (CommandLineOf(child).find("world-service") != std::string::npos) return child;
  }
  throw std::runtime_error("no world service");  // 0 would be a signal to all processes of the test
}

class ServiceRestartTest : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_.Path(name); }

  // The arguments for a run of 80 ticks with all files of the service, by a prefix of their names.
  std::vector<std::string> Arguments(const std::string& prefix) const {
    return Words("--ticks 80 --hash-log % --poses % --record %",
                 {Path(prefix + "hashes"), Path(prefix + "poses"), Path(prefix + "states.jsonl")});
  }
  void RunUndisturbed() const {
    std::vector<std::string> arguments = Arguments("whole-");
    arguments.emplace_back("--in-process");
    OutputOf(RunPen(arguments));
  }
  void ExpectFilesOfAnUndisturbedRun() const {
    RunUndisturbed();
    EXPECT_EQ(folder_.Read("run-hashes"), folder_.Read("whole-hashes"));
    EXPECT_EQ(folder_.Read("run-poses"), folder_.Read("whole-poses"));
  }

  // A run under the control of a tool.
  Program Start(std::vector<std::string> more) {
    std::vector<std::string> arguments = Arguments("run-");
    for (std::string& argument : more) arguments.push_back(std::move(argument));
    for (const std::string& argument : {std::string("--session"), session_, std::string("--lease"), std::string("1")}) {
      arguments.push_back(argument);
    }
    Program run = RunPen(arguments);
    run.WaitForLine("4 robots in 4 agent processes, ready");
    return run;
  }
  // Kills the service, and waits until the run has another.
  static void Kill(Program& run, int times = 1) {
    ASSERT_EQ(kill(ServiceOf(run), SIGKILL), 0);
    for (int i = 0; i < times; ++i) run.WaitForLineAfter("the world service has been started again");
  }
  ControlReply Call(const control::Request& request) const { return CallRun(session_, request); }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("restart");
};

TEST_F(ServiceRestartTest, ARunThatPlaysHasTheSameFiles) {
  Program run = Start({"--speed", "10", "--summary", Path("summary")});
  Kill(run);
  EXPECT_EQ(run.Wait(), 0) << run.output();
  ExpectFilesOfAnUndisturbedRun();
  const nlohmann::json summary = nlohmann::json::parse(folder_.Read("summary"), nullptr, false);
  EXPECT_EQ(summary["service_restarted"], 1);
  EXPECT_EQ(summary["agents_restarted"], 0);
  // Of both services: the run is paced.
  const double expected = summary["sim_seconds"].get<double>() / 10.0;
  EXPECT_GE(summary["wall_seconds"].get<double>(), 0.9 * expected);
  EXPECT_LE(summary["real_time_factor"].get<double>(), 11.2);
}

// Most of them before the run begins: its agents then follow a service that they have never known.
TEST_F(ServiceRestartTest, OneThatDiesAgainAndAgainWhileItStartsHasASuccessor) {
  std::vector<std::string> arguments = Arguments("run-");
  for (const char* const more : {"--session", session_.c_str(), "--lease", "1"}) arguments.emplace_back(more);
  Program run = RunPen(arguments);
  std::set<pid_t> killed;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(Eventually([&] {
      for (const pid_t child : ChildrenOf(run.pid())) {
        const bool is_service = CommandLineOf(child).find("world-service") != std::string::npos;
        if (!is_service || !killed.insert(child).second) continue;
        return kill(child, SIGKILL) == 0;
      }
      return false;
    })) << run.output();
  }
  EXPECT_EQ(run.Wait(), 0) << run.output();
  ExpectFilesOfAnUndisturbedRun();
}

TEST_F(ServiceRestartTest, TheSummaryCountsTheRobotsThatStoodStillBefore) {
  Program run = Start({"--paused", "--restart-agents", "0", "--on-agent-loss", "freeze", "--summary", Path("summary")});
  for (const pid_t child : ChildrenOf(run.pid())) {
    if (CommandLineOf(child).find("--robot=r1") == std::string::npos) continue;
    ASSERT_EQ(kill(child, SIGKILL), 0);
  }
  const std::string command = run.WaitForLineAfter("to start it again:");
  run.WaitForLine("r1 has lost its agent");
  Call(control::Step{.ticks = 3});
  Program agent({"/bin/sh", "-c", "exec " + command});
  run.WaitForLine("r1 has an agent");
  Kill(run);
  Call(control::Play());
  EXPECT_EQ(run.Wait(), 5) << run.output();
  EXPECT_EQ(agent.Wait(), 0) << agent.output();
  const nlohmann::json summary = nlohmann::json::parse(folder_.Read("summary"), nullptr, false);
  EXPECT_EQ(summary["service_restarted"], 1);
  EXPECT_EQ(summary["lost"], nlohmann::json::array());
  EXPECT_EQ(summary["frozen"], 1);
}

TEST_F(ServiceRestartTest, ARunThatContinuesARecordingHasTheSameFiles) {
  OutputOf(RunPen({"--ticks", "40", "--in-process", "--record", Path("source.mcap")}));
  const auto start = [&](const std::string& prefix, const std::string& more) {
    std::vector<std::string> arguments = {"run", Path("source.mcap")};
    for (const std::string& argument : Arguments(prefix)) arguments.push_back(argument);
    for (const std::string& argument :
         Words("--from-tick 20 --controller r0=idle --controller r1=idle --headless --domain %" + more,
               {std::to_string(TestDomain())})) {
      arguments.push_back(argument);
    }
    return Troupe(arguments);
  };
  OutputOf(start("whole-", " --in-process"));
  Program run = start("run-", " --paused --lease 5 --session " + session_);
  run.WaitForLine("4 robots in 4 agent processes, ready");
  Kill(run);  // in the state with which it begins
  Call(control::Step{.ticks = 15});
  Kill(run);
  Call(control::Play());
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_EQ(folder_.Read("run-hashes"), folder_.Read("whole-hashes"));
  EXPECT_EQ(folder_.Read("run-poses"), folder_.Read("whole-poses"));
}

TEST_F(ServiceRestartTest, APausedRunRemainsPausedAndAStepIsFinished) {
  Program run = Start({"--paused", "--speed", "max"});
  EXPECT_EQ(Call(control::Step{.ticks = 5}).tick, 5u);
  ASSERT_EQ(kill(ServiceOf(run), SIGKILL), 0);
  const ControlReply paused = Call(control::Pause());
  EXPECT_EQ(paused.state, RunState::kPaused);
  EXPECT_EQ(paused.tick, 5u);
  EXPECT_EQ(Call(control::Step{.ticks = 7}).tick, 12u);
  EXPECT_EQ(Call(control::Play()).state, RunState::kPlaying);
  EXPECT_EQ(run.Wait(), 0) << run.output();
  ExpectFilesOfAnUndisturbedRun();
}

TEST_F(ServiceRestartTest, AnEditedRunHasItsWorld) {
  Program run = Start({"--paused", "--speed", "max"});
  Call(control::Step{.ticks = 5});
  control::Delete removal{.name = "r3"};
  EXPECT_TRUE(Call(removal).done);
  Call(control::Step{.ticks = 3});
  ASSERT_EQ(kill(ServiceOf(run), SIGKILL), 0);
  const ControlReply entities = Call(control::Entities());
  EXPECT_EQ(entities.tick, 8u);
  for (const EntityReport& entity : entities.entities) EXPECT_NE(entity.name, "r3");
  // The world as loaded is in the journal, too.
  EXPECT_TRUE(Call(control::Reset()).done);
  Call(control::Step{.ticks = 10});
  ASSERT_EQ(kill(ServiceOf(run), SIGKILL), 0);
  EXPECT_EQ(Call(control::GetStatus()).edition, 2u);
  Call(control::Play());
  EXPECT_EQ(run.Wait(), 0) << run.output();
  RunUndisturbed();
  const std::string whole = folder_.Read("whole-hashes");
  EXPECT_THAT(folder_.Read("run-hashes"), testing::EndsWith(whole.substr(whole.find("\n") + 1)));
}

TEST_F(ServiceRestartTest, DeletedEntitiesCanBeRestored) {
  Program run = Start({"--paused", "--speed", "max"});
  control::Entities question;
  question.name = "r3";
  const Pose original = Call(question).entities.at(0).X_WE;
  control::Delete removal;
  removal.name = "r3";
  ASSERT_TRUE(Call(removal).done);
  Call(control::Step{.ticks = 3});
  control::Rewind rewind;
  rewind.tick = 1;
  ASSERT_TRUE(Call(rewind).done);
  ASSERT_EQ(kill(ServiceOf(run), SIGKILL), 0);
  control::Restore restoration;
  restoration.source = "r3";
  restoration.pose = original;
  const ControlReply restored = Call(restoration);
  EXPECT_TRUE(restored.done) << restored.problem;
  ASSERT_EQ(restored.entities.size(), 1u);
  EXPECT_EQ(restored.entities.front().name, "r3");
  EXPECT_EQ(Call(control::Step{.ticks = 2}).tick, 3u);
}

TEST_F(ServiceRestartTest, ARecordingIsWholeAfterwards) {
  std::vector<std::string> arguments = {
      "--ticks", "80",         "--speed",          "40",      "--record",        Path("run.mcap"),      "--session",
      session_,  "--hash-log", Path("run-hashes"), "--poses", Path("run-poses"), "--keyframe-interval", "7"};
  Program run = RunPen(arguments);
  run.WaitForLine("4 robots in 4 agent processes, ready");
  Kill(run);
  EXPECT_EQ(run.Wait(), 0) << run.output();
  ExpectFilesOfAnUndisturbedRun();
  OutputOf(Troupe({"replay", Path("run.mcap"), "--verify", "--hash-log", Path("replayed")}));
  EXPECT_EQ(folder_.Read("replayed"), folder_.Read("whole-hashes"));
  EXPECT_EQ(folder_.size(), 7u) << "the tail of the journal is left";
}

// Without a launcher: the service is continued by hand, at another port, as on another host.
TEST_F(ServiceRestartTest, AnotherServiceContinuesTheJournalOfAProcess) {
  const std::string domain = std::to_string(TestDomain());
  std::vector<std::string> service = Words(
      "% --session % --domain % --lease 5 --journal % --speed 10 --hash-log % --poses % --ticks 80 --security off",
      {ProgramPath("world-service"), session_, domain, Path("run.mcap"), Path("run-hashes"), Path("run-poses")});
  std::vector<std::string> begin = service;
  begin.insert(begin.begin() + 1, WorldPath("pen.world"));
  Program first(begin);
  Program agent({ProgramPath("robot-agent"), "--session", session_, "--domain", domain, "--lease", "5", "--robot", "r0",
                 "--robot", "r1", "--robot", "r2", "--robot", "r3", "--security", "off"});
  first.WaitForLine("all robots have agents");
  service.emplace_back("--resume");

  // A journal whose service lives cannot be continued.
  std::vector<std::string> rival = service;
  rival[2] = session_ + "-rival";
  EXPECT_THAT(OutputOf(Program(rival), 3), HasSubstr("another process writes this file"));

  first.Signal(SIGKILL);
  first.Wait();
  Program second(service);
  EXPECT_EQ(second.Wait(), 0) << second.output();
  EXPECT_EQ(agent.Wait(), 0) << agent.output();
  ExpectFilesOfAnUndisturbedRun();
}

// No user has asked for the journal.
TEST_F(ServiceRestartTest, ARunWhoseOwnJournalCannotBeWrittenContinuesWithoutIt) {
  const std::string command = "ulimit -f 200; exec " + ProgramPath("troupe") + " run " + WorldPath("pen.world") +
                              " --headless --ticks 2000 --domain " + std::to_string(TestDomain());
  EXPECT_THAT(OutputOf(Program({"/bin/sh", "-c", command})), HasSubstr("the journal of the run cannot be written"));
}

TEST_F(ServiceRestartTest, ARunEndsWhoseRecordingCannotBeContinuedForLackOfSpace) {
  const std::string command = "ulimit -f 200; exec " + ProgramPath("troupe") + " run " + WorldPath("pen.world") +
                              " --headless --ticks 2000 --domain " + std::to_string(TestDomain()) + " --record " +
                              Path("run.mcap");
  EXPECT_THAT(OutputOf(Program({"/bin/sh", "-c", command}), 3),
              AllOf(HasSubstr("run.mcap"), HasSubstr(": error: cannot write: File too large")));  // or its journal
  const Finished replay = Finish(Troupe({"replay", Path("run.mcap"), "--verify"}));
  EXPECT_THAT(replay.output, HasSubstr("state hashes are equal"));
}

TEST_F(ServiceRestartTest, ARecordingAndAnotherJournalAreRefused) {
  EXPECT_THAT(OutputOf(RunPen({"--record", Path("run.mcap"), "--journal", Path("journal.mcap")}), 2),
              HasSubstr("found --journal and a recording"));
}

TEST_F(ServiceRestartTest, AJournalWithoutARunIsNotContinued) {
  EXPECT_THAT(OutputOf(Program({ProgramPath("world-service"), "--resume", "--journal", Path("nothing.mcap")}), 2),
              HasSubstr("nothing.mcap: error: found a journal without a run, expected one to resume"));
}

}  // namespace
}  // namespace troupe::test
