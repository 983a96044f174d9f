// Pausing and stepping real runs, with the ControlClient and with `troupe ctl`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "common/base/identity.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

// Hashes by tick.
std::vector<std::uint64_t> HashesInLog(const std::string& log) {
  std::vector<std::uint64_t> hashes;
  std::istringstream lines(log);
  std::string tick;
  for (std::uint64_t hash = 0; lines >> tick >> std::hex >> hash;) hashes.push_back(hash);
  return hashes;
}

TEST(Control, SteppingGivesTheSameHashesAsRunning) {
  TemporaryFolder folder;
  ASSERT_EQ(Finish(RunPen({"--ticks", "120", "--hash-log", folder.Path("hashes")})).exit_status, 0);
  const std::vector<std::uint64_t> hashes = HashesInLog(folder.Read("hashes"));
  ASSERT_EQ(hashes.size(), 121u);

  const std::string session = TestSession("step");
  Program run = RunPen({"--paused", "--session", session, "--speed", "50"});
  ControlClient client(NetworkOf(session));
  ASSERT_TRUE(client.WaitForService(kSeconds).ok());
  for (Tick tick = 0; tick < 120;) {
    const std::uint64_t ticks = tick < 100 ? 1 : 10;
    const Result<ControlReply> reply = client.Call(control::Step{.ticks = ticks}, kSeconds);
    ASSERT_TRUE(reply.ok()) << reply.error().message;
    ASSERT_TRUE(reply.value().done) << reply.value().problem;
    tick += ticks;
    EXPECT_EQ(reply.value().tick, tick);
    EXPECT_EQ(reply.value().state, RunState::kPaused);
    ASSERT_EQ(reply.value().state_hash, hashes[tick]) << tick;
  }
  run.Interrupt();
}

TEST(Control, TheCommandLinePausesStepsAndResumes) {
  const std::string session = TestSession("ctl");
  Program run = RunPen({"--session", session, "--speed", "10"});
  run.WaitForLine("ready");
  const auto ctl = [&](std::vector<std::string> action) {
    return Finish(Troupe(Words("ctl --domain % --session %", {std::to_string(TestDomain()), session}) + action));
  };
  EXPECT_THAT(ctl({"step"}).output, testing::HasSubstr("error: the run is playing; only a paused one can step"));
  const std::string paused = OutputOf(ctl({"pause"}));
  EXPECT_THAT(paused, testing::StartsWith("paused tick "));
  EXPECT_EQ(ctl({"status"}).output, paused);
  const Finished stepped = ctl({"step", "3"});
  EXPECT_EQ(std::stoull(stepped.output.substr(12)), std::stoull(paused.substr(12)) + 3);
  EXPECT_THAT(ctl({"play"}).output, testing::StartsWith("playing tick "));
  const std::string agents = OutputOf(ctl({"agents"}));
  EXPECT_THAT(agents, testing::StartsWith("ROBOT                AGENT    HOST "));
  EXPECT_THAT(agents, testing::ContainsRegex("\nr0 +present +" + HostName() + " +[0-9]+ +[0-9]+\\.[0-9]{2} +[0-9]+\n"));
  run.Interrupt();
}

// Several runs on one network.

using testing::HasSubstr;
using testing::Not;

TEST(Sessions, ASecondServiceInASessionIsRefusedAndTheFirstContinues) {
  std::string session = TestSession("taken");
  Program first = RunPen({"--session", session, "--speed", "10"});
  first.WaitForLine("4 robots in 4 agent processes, ready");
  const std::string second = OutputOf(RunPen({"--session", session, "--ticks", "10"}), 3);
  EXPECT_THAT(second, HasSubstr("error: "));
  EXPECT_THAT(second, HasSubstr(session));
  first.Interrupt();
  EXPECT_THAT(first.output(), Not(HasSubstr("error")));
}

TEST(Sessions, TwoRunsAtOnceInADomainDoNotMix) {
  TemporaryFolder folder;
  std::vector<Program> programs;
  for (std::string name : {"a", "b", "c"}) {
    std::string seed = name == "c" ? "5" : "4";
    programs.push_back(RunPen({"--ticks", "300", "--speed", "max", "--seed", seed, "--hash-log", folder.Path(name)}));
  }
  for (Program& program : programs) EXPECT_EQ(program.Wait(), 0) << program.output();
  EXPECT_EQ(folder.Read("a"), folder.Read("b"));
  EXPECT_NE(folder.Read("a"), folder.Read("c"));
}

TEST(Sessions, TopListsTheRunningSessions) {
  std::string session = TestSession("listed");
  Program run = RunPen({"--session", session, "--speed", "10"});
  run.WaitForLine("4 robots in 4 agent processes, ready");
  EXPECT_THAT(OutputOf(Troupe({"top", "--once", "--domain", std::to_string(TestDomain())})),
              testing::ContainsRegex(session + " +pen +[^ ]+:[0-9]+ +[0-9]+ .*4/4"));
  Finished other = Finish(Troupe({"top", "--once", "--domain", std::to_string(TestDomain()), "--session", "none"}));
  EXPECT_THAT(other.output, Not(HasSubstr(session)));
  run.Interrupt();
}

}  // namespace
}  // namespace troupe::test
