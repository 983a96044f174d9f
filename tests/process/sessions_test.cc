// Several runs on one network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

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
