// Agents and the real world service, over the memory transport.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "robot-agent/agent/agent_host.h"
#include "tests/support/small_world.h"
#include "transport/protocol/faulty_transport.h"
#include "transport/protocol/transport.h"
#include "world-service/service/run_service.h"

namespace troupe {
namespace {

class QuietObserver final : public RunObserver {
 public:
  void OnNotice(const std::string& text) override { notices.push_back(text); }
  std::vector<std::string> notices;
};

struct Outcome {
  Result<RunSummary> summary = Error{};
  std::vector<Result<AgentEnd>> agents;
  std::vector<std::string> notices;
};

// `in_order`: each agent starts when the one before it has ended.
Outcome Simulate(const WorldDescription& world, const std::vector<std::vector<std::string>>& packing,
                 const Faults& faults = {}, std::size_t agent_threads = 1, bool in_order = false) {
  std::unique_ptr<Transport> transport = MakeMemoryTransport();
  if (faults.any()) transport = MakeFaultyTransport(std::move(transport), faults);
  const std::atomic<bool> stop = false;
  Outcome outcome;
  outcome.agents.assign(packing.size(), AgentEnd::kStopped);
  std::vector<std::thread> threads;
  std::atomic<std::size_t> ended = 0;
  for (std::size_t i = 0; i < packing.size(); ++i) {
    threads.emplace_back([&, i] {
      for (std::size_t count = ended; in_order && count < i; count = ended) ended.wait(count);
      const AgentOptions options{.agent = i + 1,
                                 .robots = packing[i],
                                 .scan_log = "",
                                 .pool = std::make_shared<ThreadPool>(agent_threads),
                                 .session_timeout_seconds = 60.0};
      outcome.agents[i] = RunAgent(transport->MakeAgentEndpoint(options.agent), options, {});
      ++ended;
      ended.notify_all();
    });
  }
  const auto scene = std::make_shared<const Scene>(world);
  QuietObserver observer;
  ServiceOptions options;
  options.settings.ticks = 200;
  outcome.summary = RunService(scene, options, transport->MakeServiceEndpoint(), {&observer}, stop);
  for (std::thread& thread : threads) thread.join();
  outcome.notices = observer.notices;
  return outcome;
}

std::uint64_t HashAtTheEnd(const Outcome& outcome) {
  EXPECT_TRUE(outcome.summary.ok()) << outcome.summary.error().ToString();
  if (!outcome.summary.ok()) return 0;
  EXPECT_EQ(outcome.summary.value().ticks, 200u);
  EXPECT_EQ(outcome.summary.value().rejected, 0u);
  for (const Result<AgentEnd>& agent : outcome.agents) {
    EXPECT_TRUE(agent.ok() && agent.value() == AgentEnd::kRunOver)
        << (agent.ok() ? "stopped" : agent.error().ToString());
  }
  return outcome.summary.value().state_hash;
}

TEST(AgentRunTest, TheResultDoesNotDependOnThePacking) {
  const std::uint64_t one_agent = HashAtTheEnd(Simulate(Yard(), {{}}));
  EXPECT_NE(one_agent, 0u);
  EXPECT_EQ(HashAtTheEnd(Simulate(Yard(), {{"r3", "r0"}, {"r5", "r1", "r2", "r4"}})), one_agent);
  EXPECT_EQ(HashAtTheEnd(Simulate(Yard(), {{"r0"}, {"r1"}, {"r2"}, {"r3"}, {"r4"}, {"r5"}})), one_agent);
}

TEST(AgentRunTest, TheResultDoesNotDependOnTheNumberOfThreads) {
  const WorldDescription world = Yard(50);
  const std::uint64_t one_thread = HashAtTheEnd(Simulate(world, {{}}));
  EXPECT_EQ(HashAtTheEnd(Simulate(world, {{}}, {}, 2)), one_thread);
  EXPECT_EQ(HashAtTheEnd(Simulate(world, {{}}, {}, 3)), one_thread);
}

TEST(AgentRunTest, TheResultDoesNotDependOnFaultsOfTheTransport) {
  const std::uint64_t expected = HashAtTheEnd(Simulate(Yard(), {{}}));
  const Faults faults{
      .loss = 0.05, .duplicate = 0.1, .reorder = 0.1, .delay_probability = 0.1, .delay_seconds = 0.002, .seed = 3};
  const Outcome outcome = Simulate(Yard(), {{"r0", "r1", "r2"}, {"r3", "r4", "r5"}}, faults);
  ASSERT_TRUE(outcome.summary.ok()) << outcome.summary.error().ToString();
  EXPECT_EQ(outcome.summary.value().state_hash, expected);
}

TEST(AgentRunTest, TheSeedMatters) {
  WorldDescription other = Yard();
  other.seed = 2;
  EXPECT_NE(HashAtTheEnd(Simulate(Yard(), {{}})), HashAtTheEnd(Simulate(other, {{}})));
}

TEST(AgentRunTest, AnAgentForAnUnknownRobotDoesNotDisturbTheOthers) {
  const Outcome outcome = Simulate(Yard(), {{"unknown"}, {}}, {}, 1, true);
  HashAtTheEnd({outcome.summary, {outcome.agents[1]}, {}});
  ASSERT_FALSE(outcome.agents[0].ok());
  EXPECT_THAT(outcome.agents[0].error().message, ::testing::HasSubstr("no robot 'unknown'"));
}

}  // namespace
}  // namespace troupe
