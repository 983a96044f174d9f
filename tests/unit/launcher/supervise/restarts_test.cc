#include "launcher/supervise/restarts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <utility>

#include "command_line/parse_command_line.h"
#include "launcher/supervise/agent_fleet.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kKilled = 128 + SIGKILL;

TEST(AgentRestartsTest, StartsADeadAgentAgainAfterADelay) {
  AgentRestarts restarts(3);
  EXPECT_EQ(restarts.NextDue(), std::nullopt);
  EXPECT_EQ(restarts.OnEnd(7, kKilled, 50.0), 50.1);
  EXPECT_EQ(restarts.NextDue(), 50.1);
  EXPECT_THAT(restarts.DrainDue(50.05), IsEmpty());
  EXPECT_THAT(restarts.DrainDue(50.1), ElementsAre(7));
  EXPECT_THAT(restarts.DrainDue(60.0), IsEmpty());
  EXPECT_EQ(restarts.NextDue(), std::nullopt);
}

TEST(AgentRestartsTest, StartsAnAgentAgainAsOftenAsTheLimitSays) {
  AgentRestarts restarts(2);
  EXPECT_TRUE(restarts.OnEnd(0, kKilled, 0.0));
  EXPECT_TRUE(restarts.OnEnd(0, kExitFailed, 1.0));
  EXPECT_EQ(restarts.CountOf(0), 2u);
  EXPECT_FALSE(restarts.OnEnd(0, kKilled, 100.0));
  EXPECT_TRUE(restarts.OnEnd(1, kKilled, 100.0)) << "another agent has restarts of its own";
  AgentRestarts none(0);
  EXPECT_FALSE(none.OnEnd(0, kKilled, 0.0));
}

TEST(AgentRestartsTest, WaitsLongerEachTimeUpToALimit) {
  AgentRestarts restarts(1'000'000);
  double last = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double delay = restarts.OnEnd(3, kKilled, 100.0).value() - 100.0;
    EXPECT_GE(delay, last);
    EXPECT_LE(delay, 10.0 + 1e-9);
    last = delay;
  }
  EXPECT_NEAR(last, 10.0, 1e-9);
}

TEST(AgentRestartsTest, DoesNotRepeatAnEndInOrderOrABadInput) {
  AgentRestarts restarts(3);
  for (const int status : {kExitDone, kExitBadInput, kExitOutputFailed, kExitInterrupted, 127}) {
    EXPECT_FALSE(restarts.OnEnd(0, status, 0.0)) << status;
  }
  EXPECT_EQ(restarts.CountOf(0), 0u);
  for (const int status : {1, kExitFailed, 128 + SIGSEGV, kKilled}) {
    EXPECT_TRUE(AgentRestarts(1).OnEnd(0, status, 0.0)) << status;
  }
}

TEST(AgentRestartsTest, ReturnsDueAgentsByNumber) {
  AgentRestarts restarts(3);
  for (const std::size_t agent : {5u, 2u, 9u}) restarts.OnEnd(agent, kKilled, 1.0);
  restarts.OnEnd(1, kKilled, 30.0);
  EXPECT_EQ(restarts.NextDue(), 1.1);
  EXPECT_THAT(restarts.DrainDue(2.0), ElementsAre(2, 5, 9));
  EXPECT_EQ(restarts.NextDue(), 30.1);
}

TEST(AgentRestartsTest, StartsAgentsThatDiedTogetherOneAfterAnother) {
  AgentRestarts restarts(3);
  for (std::size_t agent = 0; agent < 100; ++agent) restarts.OnEnd(agent, kKilled, 10.0);
  double now = 10.0;
  int started = 0;
  while (const std::optional<double> next = restarts.NextDue()) {
    EXPECT_TRUE(started == 0 || *next > now + 0.02) << started;
    now = *next;
    const std::vector<AgentRestarts::Agent> due = restarts.DrainDue(now);
    ASSERT_EQ(due.size(), 1u);
    ++started;
  }
  EXPECT_EQ(started, 100);
  EXPECT_LT(now, 13.0);
}

TEST(AgentRestartsTest, MakesNoRestartOnceTheRunEnds) {
  AgentRestarts restarts(3);
  restarts.OnEnd(0, kKilled, 0.0);
  restarts.Cancel();
  EXPECT_EQ(restarts.NextDue(), std::nullopt);
  EXPECT_THAT(restarts.DrainDue(100.0), IsEmpty());
}

TEST(ServiceRestartsTest, TheFirstDeathAtATickIsFollowedByARestartAtOnce) {
  ServiceRestarts restarts;
  for (const StatePlace& newest : {StatePlace{0, 0}, StatePlace{0, 7}, StatePlace{0, 9}, StatePlace{1, 9}}) {
    EXPECT_EQ(restarts.OnDeath(newest, 5.0), 5.0);
    EXPECT_EQ(restarts.due(), 5.0);
    restarts.OnStart();
    EXPECT_FALSE(restarts.due());
  }
  EXPECT_EQ(restarts.count(), 4u);
}

TEST(ServiceRestartsTest, DeathsAtOneTickAreFollowedByLaterRestartsAndAnEnd) {
  ServiceRestarts restarts;
  double before = 0.0;
  std::uint32_t count = 0;
  while (const std::optional<double> due = restarts.OnDeath({0, 3}, 100.0)) {
    EXPECT_GE(*due, 100.0 + before);
    before = *due - 100.0;
    restarts.OnStart();
    ASSERT_LT(++count, 20u);
  }
  EXPECT_GT(count, 3u);
  EXPECT_TRUE(restarts.OnDeath({0, 4}, 100.0)) << "there was progress since";
}

class FakeChild final : public Child {
 public:
  pid_t pid() const override { return 1; }
  const std::optional<ProcessEnd>& end() const override { return end_; }
  bool Poll() override { return end_ && !std::exchange(reported_, true); }
  void Tell(const std::string&) override {}
  void Signal(int) override {}
  void Kill() override { end_ = ProcessEnd{137, 9, 20.0}; }

 private:
  std::optional<ProcessEnd> end_;
  bool reported_ = false;
};

// Records the requested processes.
class FakeHost final : public Host {
 public:
  explicit FakeHost(const std::string& name = "") : place(name.empty() ? "" : "/" + name), name_(name) {}
  const std::string& name() const override { return name_; }
  const std::string& folder() const override { return place; }
  bool connected() const override { return is_connected; }
  std::string ProgramPath(const std::string& program) const override { return program; }
  Result<std::unique_ptr<Child>> Start(const std::string&, const std::vector<std::string>& arguments, bool) override {
    started.push_back(arguments);
    auto child = std::make_unique<FakeChild>();
    children.push_back(child.get());
    return std::unique_ptr<Child>(std::move(child));
  }
  Result<std::string> PlaceKeys(const std::string& keys, const std::string&) override { return keys; }
  std::vector<int> descriptors() const override { return {}; }
  std::vector<std::string> ReadOutput() override { return {}; }
  std::vector<std::string> ReadReports() override { return {}; }
  Status Fetch(const std::string&, const std::string&, const FetchProgress& progress) override {
    ++fetched;
    return progress(1000) ? Status() : Failure("stopped");
  }

  std::string place;  // its folder
  bool is_connected = true;
  int fetched = 0;
  std::vector<std::vector<std::string>> started;
  std::vector<FakeChild*> children;

 private:
  const std::string name_;
};

class AgentFleetTest : public testing::Test {
 protected:
  void Start(std::size_t robots, const std::vector<ServiceParticipant>& participants = {{1, "aa"}}) {
    ReadyReport ready;
    for (std::size_t i = 0; i < robots; ++i) ready.robots.push_back("r" + std::to_string(i));
    ready.participants = participants;
    std::vector<std::string> addresses;
    for (const ServiceParticipant& one : participants) addresses.push_back("127.0.0.1:" + std::to_string(one.port));
    ASSERT_TRUE(fleet_.Start(ready, addresses, {{&host_, "lo"}}, std::vector<std::size_t>(robots, 0)).ok());
  }

  RunOptions options_;
  FakeHost host_;
  RunKeys keys_;
  AgentFleet fleet_{options_, keys_};
};

TEST_F(AgentFleetTest, StartsALimitedNumberAndOthersAsAgentsJoin) {
  Start(50);
  const std::size_t first = host_.started.size();
  EXPECT_GT(first, 0u);
  EXPECT_LT(first, 50u);
  EXPECT_EQ(fleet_.size(), 50u);
  ASSERT_TRUE(fleet_.StartAfterJoins(3).ok());
  EXPECT_EQ(host_.started.size(), first + 3);
  ASSERT_TRUE(fleet_.StartAfterJoins(3).ok());
  EXPECT_EQ(host_.started.size(), first + 3) << "no further agent has joined";
  ASSERT_TRUE(fleet_.StartAfterJoins(50).ok());
  EXPECT_EQ(host_.started.size(), 50u);
  EXPECT_NE(host_.started.front(), host_.started.back());
}

TEST_F(AgentFleetTest, WithoutMulticastStartsAsManyMoreAsHaveJoined) {
  options_.network.network_profile = "unicast";
  FakeHost far("far");
  ReadyReport ready;
  for (int i = 0; i < 20; ++i) ready.robots.push_back("r" + std::to_string(i));
  ready.participants = {{1, "aa"}};
  std::vector<std::size_t> sites(20, 0);
  std::fill(sites.begin() + 10, sites.end(), 1);
  ASSERT_TRUE(fleet_.Start(ready, {"127.0.0.1:1"}, {{&host_, "eth0"}, {&far, "eth0"}}, sites).ok());
  EXPECT_EQ(fleet_.started(), 2u);
  ASSERT_TRUE(fleet_.StartAfterJoins(2).ok());
  EXPECT_EQ(fleet_.started(), 6u);
  ASSERT_TRUE(fleet_.StartAfterJoins(6).ok());
  EXPECT_EQ(fleet_.started(), 14u);
}

TEST_F(AgentFleetTest, StartsAllOfASmallRunAtOnce) {
  Start(3);
  EXPECT_EQ(host_.started.size(), 3u);
}

TEST_F(AgentFleetTest, StartsAgentsOfNewRobotsAtOnce) {
  Start(2);
  ASSERT_TRUE(fleet_.Add(std::vector<std::string>(40, "late"), std::vector<std::size_t>(40, 0)).ok());
  EXPECT_EQ(host_.started.size(), 42u);
  EXPECT_THAT(host_.started.front(), testing::Not(testing::Contains("--skip-unavailable")));
  EXPECT_THAT(host_.started.back(), testing::Contains("--skip-unavailable")) << "they may be deleted again";
}

TEST_F(AgentFleetTest, DividesTheAgentsAmongTheParticipantsOfTheService) {
  Start(3, {{1, "aa"}, {2, "bb"}});
  for (const auto& [agent, address, participant] :
       {std::tuple(0, "127.0.0.1:1", "aa"), std::tuple(1, "127.0.0.1:2", "bb"), std::tuple(2, "127.0.0.1:1", "aa")}) {
    EXPECT_THAT(host_.started[agent], testing::Contains(std::string("--service=") + address));
    EXPECT_THAT(host_.started[agent], testing::Contains(std::string("--service-participant=") + participant));
  }
  // A service that continues the run has other participants at the same ports.
  fleet_.SetService({{1, "cc"}, {2, "dd"}});
  host_.children[1]->Kill();
  ASSERT_EQ(fleet_.PollEnded().size(), 1u);
  ASSERT_TRUE(fleet_.Restart(1).ok());
  EXPECT_THAT(host_.started[3], testing::Contains("--service=127.0.0.1:2"));
  EXPECT_THAT(host_.started[3], testing::Contains("--service-participant=dd"));
}

TEST_F(AgentFleetTest, StartsADeadAgentAgainInItsPlace) {
  Start(3);
  host_.children[1]->Kill();
  EXPECT_THAT(fleet_.PollEnded(), testing::ElementsAre(1));
  ASSERT_TRUE(fleet_.Restart(1).ok());
  ASSERT_EQ(host_.started.size(), 4u);
  std::vector<std::string> arguments = host_.started[1];
  std::vector<std::string> again = host_.started[3];
  EXPECT_THAT(arguments.back(), testing::StartsWith("--agent-id="));
  EXPECT_NE(again.back(), arguments.back()) << "it is another agent";
  arguments.back() = "--skip-unavailable";
  again.pop_back();
  EXPECT_EQ(again, arguments);
  EXPECT_EQ(fleet_.size(), 3u);
  EXPECT_TRUE(fleet_.PollEnded().empty());
  EXPECT_EQ(fleet_.peak_memory_mib(), 20.0) << "of the process that died";
  for (std::size_t child : {0u, 2u, 3u}) host_.children[child]->Kill();
  EXPECT_EQ(fleet_.PollEnded().size(), 3u);
  EXPECT_TRUE(fleet_.all_ended());
}

TEST_F(AgentFleetTest, TheFilesOfALostHostAreMissingAndThoseOfOthersAreCopied) {
  options_.scans = ::testing::TempDir() + "/fleet-scans";
  AgentFleet fleet(options_, keys_);
  FakeHost lost("lost");
  FakeHost kept("kept");
  ReadyReport ready;
  ready.robots = {"r0", "r1", "r2"};
  ready.participants = {{1, "aa"}};
  ASSERT_TRUE(fleet.Start(ready, {"127.0.0.1:1"}, {{&lost, "lo"}, {&kept, "lo"}}, {0, 0, 1}).ok());
  lost.is_connected = false;
  fleet.NoteLostFiles(lost);
  std::vector<std::string> lines;
  const auto tell = [&](const std::string& line) { lines.push_back(line); };
  EXPECT_TRUE(fleet.FetchOutputs(tell, [] { return true; }).ok());
  EXPECT_EQ(lost.fetched, 0);
  EXPECT_EQ(kept.fetched, 1);
  EXPECT_THAT(fleet.missing_files(), testing::ElementsAre("--scans of r0, r1 until host lost was lost"));
  EXPECT_FALSE(fleet.FetchOutputs(tell, [] { return false; }).ok()) << "a request to stop ends the copies";
}

TEST_F(AgentFleetTest, AnAgentOfAHostThatWasConnectedAgainHasItsNewFolder) {
  options_.scans = ::testing::TempDir() + "/fleet-scans";
  AgentFleet fleet(options_, keys_);
  FakeHost host("far");
  ReadyReport ready;
  ready.robots = {"r0"};
  ready.participants = {{1, "aa"}};
  ASSERT_TRUE(fleet.Start(ready, {"127.0.0.1:1"}, {{&host, "lo"}}, {0}).ok());
  host.children[0]->Kill();
  ASSERT_EQ(fleet.PollEnded().size(), 1u);
  host.place = "/another";
  ASSERT_TRUE(fleet.Restart(0).ok());
  EXPECT_THAT(host.started[1], testing::Contains("--scans=/another/agent--scans-0"));
  EXPECT_THAT(fleet.RestartCommand(0).value(), testing::HasSubstr("--scans=/another/agent--scans-0"));
}

TEST_F(AgentFleetTest, KeepsTheScansOfAnAgentThatIsStartedAgain) {
  options_.scans = ::testing::TempDir() + "/fleet-scans";
  options_.trace.file = ::testing::TempDir() + "/fleet-trace";
  AgentFleet fleet(options_, keys_);
  ReadyReport ready{.robots = {"r0"}, .participants = {{1, "aa"}}};
  ASSERT_TRUE(fleet.Start(ready, {"127.0.0.1:1"}, {{&host_, "lo"}}, {0}).ok());
  host_.children[0]->Kill();
  ASSERT_EQ(fleet.PollEnded().size(), 1u);
  ASSERT_TRUE(fleet.Restart(0).ok());
  EXPECT_THAT(host_.started[0], testing::Not(testing::Contains("--keep-scans")));
  EXPECT_THAT(host_.started[0], testing::Contains(testing::StartsWith("--trace=")));
  EXPECT_THAT(host_.started[1], testing::Contains("--keep-scans"));
  EXPECT_THAT(host_.started[1], testing::Contains(testing::StartsWith("--scans=")));
  EXPECT_THAT(host_.started[1], testing::Not(testing::Contains(testing::StartsWith("--trace="))));
}

}  // namespace
}  // namespace troupe
