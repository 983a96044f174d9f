// Nodes that are slow, silent, or answer nonsense, and the longer runs of ticks that wait for nodes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <regex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/process/lockstep_node.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

class RosLockstepTrials : public LockstepRunTest {};

// Lines of a log of hashes.
std::string FirstLines(const std::string& text, std::size_t count) {
  std::size_t end = 0;
  for (std::size_t line = 0; line < count && end < text.size(); ++line) end = text.find('\n', end) + 1;
  return text.substr(0, end);
}

// The outcomes are those of docs/ros2-lockstep.md. LOCKSTEP_TRIALS: another number of trials.
TEST_F(RosLockstepTrials, NoNodeThatMisbehavesMakesAWrongTick) {
  enum Kind { kSlow, kHalted, kReplaced, kWrong, kSilent, kSilentWithoutEnd, kKinds };
  const std::string& reference = Reference();
  const char* const trials = std::getenv("LOCKSTEP_TRIALS");
  std::mt19937 random(36);
  for (int trial = 0; trial < (trials != nullptr ? std::atoi(trials) : 200); ++trial) {
    const int kind = trial % kKinds;
    const Tick at = std::uniform_int_distribution<Tick>(2, 50)(random);
    SCOPED_TRACE("trial " + std::to_string(trial) + " of kind " + std::to_string(kind) + " at tick " +
                 std::to_string(at));
    const std::string prefix = "trial" + std::to_string(trial) + "-";
    const NodeOptions options{.most_delay = kind == kSlow ? 30 : 2, .seed = static_cast<unsigned>(trial)};
    std::optional<LockstepNode> driver(options);
    if (kind == kWrong) driver->SendWrongAnswers();
    if (kind == kHalted || kind >= kSilent) driver->HaltAt(at);
    std::vector<std::string> more = {"--ros-lockstep", "driver", "--ros-lockstep-limit", kind < kSilent ? "0" : "0.5"};
    if (kind == kSilentWithoutEnd) more = more + Words("--ros-lockstep-at-limit continue");
    Program run = RunPen(Arguments(prefix, more));
    if (kind == kHalted) {
      EXPECT_TRUE(Eventually([&] { return driver->answered() == at - 1; }));
      driver->Continue();
    } else if (kind == kReplaced) {
      EXPECT_TRUE(Eventually([&] { return driver->answered() >= at; }));
      driver.reset();
      driver.emplace(options);
    }
    EXPECT_EQ(run.Wait(), kind == kSilent ? 3 : 0) << run.output();
    const std::string hashes = folder_.Read(prefix + "hashes");
    if (kind < kSilent) {
      EXPECT_EQ(hashes, reference);
    } else if (kind == kSilent) {
      EXPECT_THAT(run.output(), HasSubstr(" s for driver of ROS"));
      EXPECT_EQ(hashes, reference.substr(0, hashes.size()));
    } else {
      const std::string output = run.output();
      std::smatch continues;
      ASSERT_TRUE(std::regex_search(output, continues, std::regex("tick ([0-9]+) continues after"))) << output;
      const std::size_t equal = std::stoul(continues[1]) + 1;
      EXPECT_EQ(FirstLines(hashes, equal), FirstLines(reference, equal));
    }
  }
}

// Starver: stops one random process of a group after another for a random time, as a busy machine does.
class Starver {
 public:
  // `processes`: those that are there when it is called.
  Starver(unsigned seed, std::function<std::vector<pid_t>()> processes)
      : random_(seed), processes_(std::move(processes)), thread_([this] { Run(); }) {}
  ~Starver() {
    stop_ = true;
    thread_.join();
  }
  Starver(const Starver&) = delete;
  Starver& operator=(const Starver&) = delete;

 private:
  void Run() {
    while (!stop_) {
      const std::vector<pid_t> all = processes_();
      if (!all.empty()) {
        const pid_t victim = all[std::uniform_int_distribution<std::size_t>(0, all.size() - 1)(random_)];
        kill(victim, SIGSTOP);
        Sleep(300);
        kill(victim, SIGCONT);
      }
      Sleep(60);
    }
  }
  void Sleep(int most_ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(std::uniform_int_distribution<int>(1, most_ms)(random_)));
  }

  std::mt19937 random_;
  const std::function<std::vector<pid_t>()> processes_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

// LOCKSTEP_TRIALS: another number of trials; LOCKSTEP_SEED: of the first one.
TEST_F(RosLockstepTrials, RunsRepeatWhileAllProcessesAreStarved) {
  const std::vector<std::vector<NodeOptions>> kinds = {
      {{.way = Way::kCounter, .most_delay = 30}},
      {{.way = Way::kProtocol, .most_delay = 30}},
      {{.way = Way::kCounter, .name = "first", .most_delay = 300},
       {.way = Way::kProtocol, .name = "second", .space = "/r1", .most_delay = 20},
       {.way = Way::kCounter, .name = "third", .space = "/r2", .most_delay = 50}},
  };
  const char* const trials = std::getenv("LOCKSTEP_TRIALS");
  const char* const first = std::getenv("LOCKSTEP_SEED");
  std::vector<std::string> references(kinds.size());
  for (int trial = 0; trial < (trials != nullptr ? std::atoi(trials) : 24); ++trial) {
    const unsigned seed = static_cast<unsigned>(trial + (first != nullptr ? std::atoi(first) : 1));
    const std::size_t kind = static_cast<std::size_t>(trial) % kinds.size();
    const bool is_reference = references[kind].empty();
    SCOPED_TRACE("seed " + std::to_string(seed) + ", kind " + std::to_string(kind));
    std::mt19937 random(seed);
    std::string names;
    std::vector<Program> nodes;
    for (NodeOptions node : kinds[kind]) {
      node.seed = seed;
      if (is_reference) node.most_delay = 0;
      names += (names.empty() ? "" : ",") + (node.way == Way::kProtocol ? node.name : node.space + "/cmd_vel");
      nodes.push_back(NodeProcess(node));
    }
    const std::string speed = std::vector<std::string>{"max", "10", "3"}[random() % 3];
    const std::string prefix = "starved" + std::to_string(trial) + "-";
    {
      Program run =
          RunPen(Arguments(prefix, Words("--ros-lockstep % --ros-lockstep-limit 0 --ticks 25 --lease 5 --speed %",
                                         {names, is_reference ? "max" : speed})));
      std::optional<Starver> starver;
      if (!is_reference) {
        starver.emplace(seed, [&run, &nodes] {
          std::vector<pid_t> all = DescendantsOf(run.pid());
          all.push_back(run.pid());
          for (const Program& node : nodes) all.push_back(node.pid());
          return all;
        });
      }
      const int status = run.Wait();
      starver.reset();
      EXPECT_EQ(status, 0) << run.output();
    }
    for (const Program& node : nodes) node.Signal(SIGKILL);
    const std::string hashes = folder_.Read(prefix + "hashes");
    if (is_reference) references[kind] = hashes;
    EXPECT_EQ(hashes, references[kind]);
  }
}

TEST_F(RosLockstepTrials, AServiceKilledAtTwentyInstantsRepeatsAndReplays) {
  const std::string& reference = Reference();
  std::mt19937 random(20);
  for (int trial = 0; trial < 20; ++trial) {
    const auto at = static_cast<Tick>(1 + 5 * trial / 2);
    // Between the phases of a tick: the scans, the answer, the step, the journal.
    const std::chrono::microseconds later(std::uniform_int_distribution<int>(0, 5000)(random));
    SCOPED_TRACE("trial " + std::to_string(trial) + " at tick " + std::to_string(at));
    const bool by_topic = trial % 2 == 1;
    const std::string prefix = "killed" + std::to_string(trial) + "-";
    const std::string recording = folder_.Path(prefix + "run.mcap");
    LockstepNode driver({.way = by_topic ? Way::kTopic : Way::kProtocol});
    Program run = RunPen(Arguments(prefix, Words("--speed 10 --lease 1 --record % --ros-lockstep %",
                                                 {recording, by_topic ? "/r0/cmd_vel" : "driver"})));
    run.WaitForLine(", ready");
    const std::vector<pid_t> services = ChildrenWith(run, "world-service");
    ASSERT_EQ(services.size(), 1u);
    ASSERT_TRUE(Eventually([&] { return driver.answered() >= at; }));
    std::this_thread::sleep_for(later);
    ASSERT_EQ(kill(services.front(), SIGKILL), 0);
    EXPECT_EQ(run.Wait(), 0) << run.output();
    EXPECT_EQ(folder_.Read(prefix + "hashes"), reference) << run.output();
    OutputOf(Troupe({"replay", recording, "--verify"}));
  }
}

TEST_F(RosLockstepTrials, RewoundTicksWaitAgainAndRepeat) {
  const std::string& reference = Reference();
  LockstepNode driver({});
  driver.HaltAt(30);
  Program run = RunPen(Arguments(
      "rewound-", Words("--ros-lockstep driver --ros-lockstep-limit 0 --record %", {folder_.Path("rewound.mcap")})));
  ASSERT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick == 30; }));
  const std::size_t answers = driver.answers();
  EXPECT_TRUE(Call(control::Rewind{.tick = 12}).done);
  EXPECT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick == 30; }));
  EXPECT_GE(driver.answers(), answers + 18);
  driver.Continue();
  EXPECT_EQ(run.Wait(), 0) << run.output();
  const auto end_of = [](const std::string& hashes) { return hashes.substr(hashes.rfind('\n', hashes.size() - 2)); };
  EXPECT_EQ(end_of(folder_.Read("rewound-hashes")), end_of(reference));
}

TEST_F(RosLockstepTrials, ARunAtThePaceOfRealTimeKeepsItWhileNodesAnswerInTime) {
  const LockstepNode driver({});
  Program run =
      RunPen(Arguments("", Words("--ros-lockstep driver --speed 1 --ticks 30 --summary %", {folder_.Path("summary")})));
  EXPECT_EQ(run.Wait(), 0) << run.output();
  const auto summary = nlohmann::json::parse(folder_.Read("summary"));
  EXPECT_GE(summary["wall_seconds"], 2.9);
}

}  // namespace
}  // namespace troupe::test
