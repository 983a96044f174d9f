#include "world-service/program/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "tests/support/words.h"
#include "world-service/program/prepared_run.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;

std::variant<ServiceCommandLine, int> Parse(const std::vector<std::string>& words) {
  std::vector<const char*> arguments = {"world-service"};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  return ParseServiceCommandLine(static_cast<int>(arguments.size()), arguments.data());
}

TEST(ServiceCommandLine, WithoutOptionsKeepsTheScenariosSettings) {
  const auto parsed = Parse({"a.world"});
  ASSERT_TRUE(std::holds_alternative<ServiceCommandLine>(parsed));
  const ServiceCommandLine& line = std::get<ServiceCommandLine>(parsed);
  EXPECT_EQ(line.file, "a.world");
  EXPECT_FALSE(line.faults.any());
  EXPECT_FALSE(line.report_fd);
  RunSettings settings{.ticks = 7, .mode = Mode::kRealtime, .speed = 3.0, .on_agent_loss = OnAgentLoss::kPause};
  line.run.ApplyTo(settings);
  EXPECT_EQ(settings.ticks, 7u);
  EXPECT_EQ(settings.speed, 3.0);
  EXPECT_EQ(settings.mode, Mode::kRealtime);
  EXPECT_EQ(settings.on_agent_loss, OnAgentLoss::kPause);
}

TEST(ServiceCommandLine, OverridesTheScenario) {
  const auto parsed = Parse(
      test::Words("a.world --ticks 5 --seed=9 --mode=lockstep --speed max --controller wander --session s-1 "
                  "--domain 3 --interface 10.0.0.5 --on-agent-loss abort --hash-log h --poses p --record r --lease "
                  "0.5 --start-timeout 0 --faults loss=0.5 --report-fd 4"));
  ASSERT_TRUE(std::holds_alternative<ServiceCommandLine>(parsed));
  const ServiceCommandLine& line = std::get<ServiceCommandLine>(parsed);
  RunSettings settings{.mode = Mode::kRealtime, .speed = 3.0};
  line.run.ApplyTo(settings);
  EXPECT_EQ(settings.ticks, 5u);
  EXPECT_EQ(settings.speed, std::nullopt);
  EXPECT_EQ(settings.mode, Mode::kLockstep);
  EXPECT_EQ(settings.on_agent_loss, OnAgentLoss::kAbort);
  EXPECT_EQ(line.overrides.seed, 9u);
  EXPECT_EQ(line.overrides.controller, "wander");
  EXPECT_EQ(line.network.session, "s-1");
  EXPECT_EQ(line.service.session, "s-1");
  EXPECT_EQ(line.network.domain, 3u);
  EXPECT_EQ(line.network.network_interface, "10.0.0.5");
  EXPECT_EQ(line.outputs.hash_log, "h");
  EXPECT_EQ(line.outputs.poses, "p");
  EXPECT_EQ(line.outputs.record, "r");
  EXPECT_EQ(line.service.lease_seconds, 0.5);
  EXPECT_EQ(line.service.start_timeout_seconds, 0.0);
  EXPECT_EQ(line.faults.loss, 0.5);
  EXPECT_EQ(line.report_fd, 4);
}

TEST(ServiceCommandLine, NamesTheFaultInOneLine) {
  struct Case {
    std::vector<std::string> words;
    const char* message;
  };
  const std::vector<Case> cases = {
      {{}, "FILE is required"},
      {{"a", "b"}, "b"},
      {{"a", "--what"}, "--what"},
      {{"a", "--controller", ""}, "--controller: found '', expected a name"},
      {{"a", "--ticks", "0"}, "found '0', expected a whole number from 1"},
      {{"a", "--ticks", "-1"}, "found '-1', expected a whole number"},
      {{"a", "--ticks", "1e3"}, "found '1e3', expected a whole number"},
      {{"a", "--ticks", "99999999999999999999"}, "expected a whole number"},
      {{"a", "--seed", "x"}, "found 'x', expected a whole number"},
      {{"a", "--mode", "fast"}, "found 'fast', expected one of lockstep, realtime"},
      {{"a", "--speed", "0"}, "found '0', expected a multiple of real time above 0, or max"},
      {{"a", "--speed", "nan"}, "found 'nan', expected a multiple"},
      {{"a", "--speed", "inf"}, "found 'inf', expected a multiple"},
      {{"a", "--on-agent-loss", "cry"}, "found 'cry', expected one of freeze, pause, abort"},
      {{"a", "--session", "a b"}, "found 'a b', expected 1 to 64 letters"},
      {{"a", "--session", "*"}, "expected 1 to 64 letters"},
      {{"a", "--domain", "231"}, "found '231', expected a whole number from 0 to 230"},
      {{"a", "--lease", "0"}, "found '0', expected seconds from 0.01 to 3600"},
      {{"a", "--start-timeout", "-1"}, "expected a number from 0"},
      {{"a", "--faults", "loss=2"}, "found \"loss=2\", expected a probability"},
      {{"a", "--report-fd", "x"}, "found 'x', expected a whole number"},
  };
  for (const Case& bad : cases) {
    testing::internal::CaptureStderr();
    const auto parsed = Parse(bad.words);
    const std::string said = testing::internal::GetCapturedStderr();
    ASSERT_TRUE(std::holds_alternative<int>(parsed)) << bad.message;
    EXPECT_EQ(std::get<int>(parsed), kExitBadInput);
    EXPECT_THAT(said, HasSubstr(bad.message));
    EXPECT_THAT(said, testing::StartsWith("error: "));
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  }
}

TEST(ServiceCommandLine, PrintsItsVersionAndItsOptions) {
  for (const char* word : {"--version", "--help"}) {
    testing::internal::CaptureStdout();
    const auto parsed = Parse({word});
    EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr(word[2] == 'v' ? "world-service 0." : "--hash-log"));
    ASSERT_TRUE(std::holds_alternative<int>(parsed));
    EXPECT_EQ(std::get<int>(parsed), kExitDone);
  }
}

std::string OwnSession(const std::string& name) {
  return "lock-test-" + std::to_string(getpid()) + "-" + name;
}

TEST(SessionLock, HasOneOwnerForASessionAndDomain) {
  const std::string session = OwnSession("a");
  const Result<SessionLock> first = SessionLock::Acquire(7, session);
  ASSERT_TRUE(first.ok()) << first.error().ToString();
  const Result<SessionLock> second = SessionLock::Acquire(7, session);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("pid " + std::to_string(getpid())));
  EXPECT_THAT(second.error().message, HasSubstr(session));
  EXPECT_TRUE(SessionLock::Acquire(8, session).ok());
  EXPECT_TRUE(SessionLock::Acquire(7, OwnSession("b")).ok());
}

TEST(SessionLock, IsFreeAgainWhenItsOwnerHasEnded) {
  const std::string session = OwnSession("c");
  EXPECT_TRUE(SessionLock::Acquire(7, session).ok());
  EXPECT_TRUE(SessionLock::Acquire(7, session).ok());
}

TEST(SessionLock, RefusesANameThatIsTooLong) {
  const Result<SessionLock> lock = SessionLock::Acquire(7, std::string(200, 'x'));
  ASSERT_FALSE(lock.ok());
  EXPECT_THAT(lock.error().message, HasSubstr("too long"));
}

}  // namespace
}  // namespace troupe
