// Ticks wait for nodes of ROS: runs with a node that drives a robot repeat, however slow the node is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/convert.h"
#include "tests/process/lockstep_node.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

class RosLockstepTest : public LockstepRunTest {};

using SpawnClient = TROUPE_SIMULATION_CLIENT(SpawnEntity);

// As `ros2 topic echo`: a program that reads what the node reads.
class LateReader {
 public:
  LateReader() { participant_.Announce(); }

 private:
  ros::RosParticipant participant_{TestRosNetwork()};
  ros::RosNode node_ = ros::MakeNode(participant_, "/", "echo");
  ros::RosReader<ros::LaserScan> scans_{node_, "/r0/scan", ros::Stream(10)};
};

TEST_F(RosLockstepTest, RunsRepeatAtAnySpeedHoweverSlowTheNodeIs) {
  const NodeOptions protocol{.way = Way::kProtocol, .most_delay = 8, .seed = 1};
  const std::string reference = HashesOf(protocol, {"--ros-lockstep", "driver"});
  EXPECT_EQ(std::count(reference.begin(), reference.end(), '\n'), 61);
  EXPECT_EQ(HashesOf({.way = Way::kProtocol, .most_delay = 20, .seed = 2}, Words("--ros-lockstep driver --speed 5")),
            reference);
  EXPECT_EQ(HashesOf({.way = Way::kProtocol}, Words("--ros-lockstep driver --in-process --speed max")), reference);
  // Unchanged, with ticks that wait for its commands.
  EXPECT_EQ(HashesOf({.way = Way::kTopic, .most_delay = 8, .seed = 3}, Words("--ros-lockstep /r0/cmd_vel")), reference);
  EXPECT_EQ(HashesOf({.way = Way::kTopic, .most_delay = 20, .seed = 4}, Words("--ros-lockstep /r0/cmd_vel --speed 5")),
            reference);
  // Without waiting, ticks go on meanwhile.
  const NodeOptions slow{.way = Way::kTopic, .most_delay = 20, .seed = 5};
  const std::vector<std::string> free = Words("--speed 20");
  EXPECT_NE(HashesOf(slow, free), reference);
}

// Its callbacks take longer than the agents need to show a tick again.
TEST_F(RosLockstepTest, ANodeThatCountsItsMessagesRepeatsHoweverSlowItIsAndWhoeverReads) {
  const std::vector<std::string> waits = Words("--ros-lockstep /r0/cmd_vel --ticks 12");
  const std::string reference = HashesOf({.way = Way::kCounter}, waits);
  EXPECT_EQ(std::count(reference.begin(), reference.end(), '\n'), 13);
  for (const bool has_parameters : {true, false}) {
    LockstepNode node({.way = Way::kCounter, .least_delay = 250, .most_delay = 500, .has_parameters = has_parameters});
    Program run = RunPen(Arguments("slow-", waits));
    // Tools that come in the middle.
    std::vector<std::unique_ptr<LateReader>> readers;
    for (const Tick tick : {3, 6, 9}) {
      ASSERT_TRUE(Eventually([&] { return node.answered() >= tick; }));
      readers.push_back(std::make_unique<LateReader>());
    }
    EXPECT_EQ(run.Wait(), 0) << run.output();
    EXPECT_EQ(folder_.Read("slow-hashes"), reference);
    EXPECT_LE(node.answers(), 13u);  // of ticks 0 to 12; the run does not wait for that of the last one
  }
}

TEST_F(RosLockstepTest, TheFirstTickIsHeldBackUntilAllNodesCanReceiveIt) {
  const std::vector<std::string> waits = Words("--ros-lockstep /r0/cmd_vel,/r1/cmd_vel --ticks 10");
  std::string reference;
  for (const int later : {0, 1500}) {
    LockstepNode first({.way = Way::kCounter, .name = "first"});
    Program run = RunPen(Arguments("held-", waits));
    std::this_thread::sleep_for(std::chrono::milliseconds(later));
    EXPECT_TRUE(later == 0 || first.answers() == 0);
    const LockstepNode second({.way = Way::kCounter, .name = "second", .space = "/r1", .most_delay = 300});
    EXPECT_EQ(run.Wait(), 0) << run.output();
    if (reference.empty()) reference = folder_.Read("held-hashes");
    EXPECT_EQ(folder_.Read("held-hashes"), reference);
  }
}

TEST_F(RosLockstepTest, AnAgentThatIsStartedAgainShowsNoTickTwice) {
  const std::vector<std::string> waits =
      Words("--ros-lockstep /r0/cmd_vel --ticks 20 --lease 1 --on-agent-loss rebuild");
  const std::string reference = HashesOf({.way = Way::kCounter}, waits);
  for (const std::string victim : {"robot-agent", "world-service"}) {
    LockstepNode node({.way = Way::kCounter, .least_delay = 100, .most_delay = 200});
    const std::string prefix = victim.substr(0, 3);
    Program run = RunPen(Arguments(prefix, waits));
    ASSERT_TRUE(Eventually([&] { return node.answered() >= 5; }));
    for (const pid_t process : ChildrenWith(run, victim)) ASSERT_EQ(kill(process, SIGKILL), 0);
    EXPECT_EQ(run.Wait(), 0) << run.output();
    EXPECT_EQ(folder_.Read(prefix + "hashes"), reference) << run.output();
  }
}

TEST_F(RosLockstepTest, AnswersToOtherTicksTwiceOrWithoutSenseCountForNone) {
  const std::string& reference = Reference();
  LockstepNode driver({});
  driver.SendWrongAnswers();
  Program run = RunPen(Arguments("wrong-", {"--ros-lockstep", "driver"}));
  const std::string output = OutputOf(std::move(run));
  EXPECT_EQ(folder_.Read("wrong-hashes"), reference);
  EXPECT_THAT(output, HasSubstr("ignored the answer of 'driver' to"));
}

TEST_F(RosLockstepTest, ASilentNodeIsNamedAndEndsTheRunAtTheLimit) {
  LockstepNode driver({});
  driver.HaltAt(20);
  Program run = RunPen(
      Arguments("", Words("--ros-lockstep driver --ros-lockstep-limit 6 --summary %", {folder_.Path("summary")})));
  EXPECT_EQ(run.Wait(), 3) << run.output();
  EXPECT_THAT(run.output(), ContainsRegex("tick 20 has waited [0-9.]+ s for driver of ROS"));
}

TEST_F(RosLockstepTest, ARunContinuesWithoutASilentNodeIfAskedUntilItReturns) {
  LockstepNode driver({});
  driver.HaltAt(20);
  Program run = RunPen(Arguments("", Words("--ros-lockstep driver --ros-lockstep-limit 5 --ros-lockstep-at-limit "
                                           "continue --ticks 100000 --speed 20")));
  run.WaitForLine("tick 20 continues after");
  driver.Continue();
  run.WaitForLine("ticks wait for driver again");
  run.Interrupt();
}

TEST_F(RosLockstepTest, TheFirstAnswerHasNoLimitAndTheStatusNamesTheNode) {
  Program run = RunPen(
      Arguments("", Words("--ros-lockstep driver --ros-lockstep-limit 5 --summary %", {folder_.Path("summary")})));
  run.WaitForLine("waiting for driver");  // after 5 s
  const LockstepNode driver({});
  EXPECT_EQ(run.Wait(), 0) << run.output();
  const auto summary = nlohmann::json::parse(folder_.Read("summary"));
  ASSERT_EQ(summary["ros_lockstep"].size(), 1u);
  EXPECT_EQ(summary["ros_lockstep"][0]["name"], "driver");
  EXPECT_EQ(summary["ros_lockstep"][0]["times_last"], 60);
}

TEST_F(RosLockstepTest, StepsEndWhenTheNodeHasAnsweredTheirLastTick) {
  LockstepNode driver({});
  driver.HaltAt(5);
  Program run = RunPen(Arguments("", {"--ros-lockstep", "driver", "--paused", "--ros-lockstep-limit", "0"}));
  EXPECT_TRUE(Call(control::Step{.ticks = 4}).done);
  EXPECT_TRUE(Eventually([&] { return driver.answered() == 4; }));
  std::atomic<bool> has_stepped = false;
  std::thread stepper([&] {
    EXPECT_TRUE(Call(control::Step{.ticks = 1}).done);
    has_stepped = true;
  });
  EXPECT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick == 5; }));
  EXPECT_FALSE(has_stepped);
  driver.Continue();
  stepper.join();
  EXPECT_TRUE(Eventually([&] { return driver.answered() == 5; }));
  run.Interrupt();
}

TEST_F(RosLockstepTest, EditsAreExecutedWhileATickWaits) {
  LockstepNode driver({});
  driver.HaltAt(10);
  Program run = RunPen(Arguments("", {"--ros-lockstep", "driver", "--ros-lockstep-limit", "0", "--ticks", "100000"}));
  ASSERT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick == 10; }, kSeconds));
  EXPECT_EQ(Call(control::GetStatus()).state, RunState::kPlaying);
  EXPECT_TRUE(Call(control::SetPose{.name = "r1", .pose = {0.0, 2.0, 0.0, 0.0}}).done);
  EXPECT_TRUE(Call(control::Spawn{.source = "rover", .name = "late", .pose = {0, -2.2, 0, 0}}).done);
  EXPECT_TRUE(Call(control::Delete{.name = "late"}).done);
  EXPECT_TRUE(Call(control::Pause()).done);
  EXPECT_EQ(Call(control::GetStatus()).state, RunState::kPaused);
  EXPECT_EQ(Call(control::GetStatus()).tick, 10u);
  EXPECT_TRUE(Call(control::Reset()).done);
  EXPECT_TRUE(Call(control::Play()).done);
  EXPECT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick == 10; }));
  driver.Continue();
  EXPECT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick > 30; }));
  run.Interrupt();
}

TEST_F(RosLockstepTest, ACallOfAServiceBeforeTheAnswerEditsTheTickAndRepeats) {
  std::string hashes;
  for (const std::string prefix : {"first-", "second-"}) {
    LockstepNode driver({});
    driver.HaltAt(10);
    Program run = RunPen(Arguments(prefix, {"--ros-lockstep", "driver", "--ros-lockstep-limit", "0"}));
    ASSERT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick == 10; }, kSeconds));
    const ros::RosParticipant participant(TestRosNetwork());
    SpawnClient spawn(participant, "/world/spawn_entity");
    simulation_interfaces_srv_dds__SpawnEntity_Request_ request{};
    request.name = Text("late");
    request.uri = Text("rover");
    request.initial_pose.pose = ros::ToMessage(Pose{0.0, -2.2, 0.0, 0.0});
    EXPECT_EQ(spawn.ResultOf(request), kOk);
    EXPECT_EQ(Call(control::GetStatus()).tick, 10u);
    driver.Continue();
    EXPECT_EQ(run.Wait(), 0) << run.output();
    if (hashes.empty()) hashes = folder_.Read(prefix + "hashes");
    EXPECT_EQ(folder_.Read(prefix + "hashes"), hashes);
  }
}

TEST_F(RosLockstepTest, CallsOfTwoNodesInATickAreExecutedInTheOrderOfTheirNamesWhicheverArrivesFirst) {
  std::string hashes;
  for (const auto& order : std::vector<std::vector<std::string>>{{"alpha", "beta"}, {"beta", "alpha"}}) {
    std::map<std::string, std::unique_ptr<LockstepNode>> nodes;
    std::map<std::string, std::unique_ptr<SpawnClient>> clients;
    for (const std::string& name : order) {
      nodes[name] = std::make_unique<LockstepNode>(NodeOptions{.name = name, .space = name == "alpha" ? "/r0" : "/r1"});
      nodes[name]->HaltAt(10);
      clients[name] =
          std::make_unique<SpawnClient>(nodes[name]->participant(), "/world/spawn_entity", name == "alpha" ? 1 : 2);
    }
    const std::string prefix = order.front() + "-";
    Program run = RunPen(Arguments(prefix, Words("--ros-lockstep alpha,beta --ros-lockstep-limit 0 --ticks 20")));
    // Not the tick of the run, which is there before nodes are told of it: a call until then is one of the tick before.
    for (const auto& [name, node] : nodes) {
      ASSERT_TRUE(Eventually([&shown = *node] { return shown.shown() == 10u; }, kSeconds)) << name;
    }
    for (const std::string& name : order) {
      const std::string robot = "late_" + name;
      simulation_interfaces_srv_dds__SpawnEntity_Request_ request{};
      request.name = Text(robot.c_str());
      request.uri = Text("rover");
      request.initial_pose.pose = ros::ToMessage(Pose{name == "alpha" ? 1.5 : 0.0, -2.2, 0.0, 0.0});
      clients[name]->Send(request);
      clients[name]->AwaitArrival();
    }
    for (const auto& called : clients) {
      SpawnClient& client = *called.second;
      std::uint8_t result = 0;
      EXPECT_TRUE(
          Eventually([&] { return client.Receive([&](const auto& response) { result = response.result.result; }); }));
      EXPECT_EQ(result, kOk) << called.first;
    }
    for (const auto& [name, node] : nodes) node->Continue();
    EXPECT_EQ(run.Wait(), 0) << run.output();
    if (hashes.empty()) hashes = folder_.Read(prefix + "hashes");
    EXPECT_EQ(folder_.Read(prefix + "hashes"), hashes);
  }
}

// Without that, a participant that waits for what another one does after its call would be awaited by the call.
TEST_F(RosLockstepTest, ACallIsExecutedOnceTheOtherNodeHasSaidThatItWaits) {
  LockstepNode alpha({.name = "alpha"});
  LockstepNode beta({.name = "beta", .space = "/r1"});
  for (LockstepNode* const node : {&alpha, &beta}) node->HaltAt(5);
  SpawnClient client(alpha.participant(), "/world/spawn_entity");
  Program run = RunPen(Arguments("", Words("--ros-lockstep alpha,beta --ros-lockstep-limit 0 --ticks 20")));
  for (LockstepNode* const node : {&alpha, &beta}) {
    ASSERT_TRUE(Eventually([&] { return node->shown() == 5u; }, kSeconds));
  }
  simulation_interfaces_srv_dds__SpawnEntity_Request_ request{};
  request.name = Text("late");
  request.uri = Text("rover");
  request.initial_pose.pose = ros::ToMessage(Pose{0.0, -2.2, 0.0, 0.0});
  const Edition edition = Call(control::GetStatus()).edition;
  client.Send(request);
  client.AwaitArrival();
  std::uint8_t result = 0;
  const auto take_result = [&] {
    return client.Receive([&](const auto& response) { result = response.result.result; });
  };
  EXPECT_FALSE(take_result());
  EXPECT_EQ(Call(control::GetStatus()).edition, edition);
  beta.WaitForOthers();
  EXPECT_TRUE(Eventually(take_result, kSeconds));
  EXPECT_EQ(result, kOk);
  for (LockstepNode* const node : {&alpha, &beta}) node->Continue();
  EXPECT_EQ(run.Wait(), 0) << run.output();
}

TEST_F(RosLockstepTest, ATickWaitsForATopicOfAnyTypeAndTellsOfItsMessages) {
  ros::RosParticipant participant(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(participant, "/", "planner");
  ros::RosWriter<ros::Clock> plans(node, "/plan", ros::Stream(1));  // of a type that no agent reads
  participant.Announce();
  LockstepNode driver({});
  Program run = RunPen(Arguments("", {"--ros-lockstep", "driver,/plan", "--ros-lockstep-limit", "0"}));
  for (Tick tick = 0; tick <= 2; ++tick) {
    EXPECT_TRUE(Eventually([&] { return driver.answered() == tick && Call(control::GetStatus()).tick == tick; }));
    // The first one may be lost while the endpoints discover each other.
    EXPECT_TRUE(Eventually([&] { return plans.wanted(); }));
    bool advances = false;
    for (int trial = 0; trial < 5 && !advances; ++trial) {
      EXPECT_EQ(Call(control::GetStatus()).tick, tick);
      plans.Write({});
      advances = Eventually([&] { return Call(control::GetStatus()).tick > tick; }, 4.0);
    }
    ASSERT_TRUE(advances);
  }
  // Topics without a reader have no messages.
  EXPECT_TRUE(Eventually([&] { return driver.lists().ends_with(" /r0/scan:1"); })) << driver.lists();
  run.Signal(SIGINT);
  EXPECT_EQ(run.Wait(), 130);
}

TEST_F(RosLockstepTest, ARunWithAKilledServiceRepeatsAndReplays) {
  const std::string& reference = Reference();
  for (const Way way : {Way::kProtocol, Way::kTopic}) {
    const std::string prefix = way == Way::kTopic ? "topic-" : "protocol-";
    const std::string recording = folder_.Path(prefix + "run.mcap");
    LockstepNode driver({.way = way});
    Program run = RunPen(Arguments(prefix, Words("--speed 10 --lease 1 --record % --ros-lockstep %",
                                                 {recording, way == Way::kTopic ? "/r0/cmd_vel" : "driver"})));
    ASSERT_TRUE(Eventually([&] { return driver.answered() >= 20; }));
    for (const pid_t service : ChildrenWith(run, "world-service")) ASSERT_EQ(kill(service, SIGKILL), 0);
    EXPECT_EQ(run.Wait(), 0) << run.output();
    EXPECT_EQ(folder_.Read(prefix + "hashes"), reference) << run.output();
    OutputOf(Troupe({"replay", recording, "--verify"}));
  }
}

TEST_F(RosLockstepTest, TheLimitIsThatOfANodeThatIsSilentWhenTheServiceHasDied) {
  LockstepNode driver({});
  driver.HaltAt(20);
  Program run = RunPen(Arguments("", Words("--lease 1 --ros-lockstep driver --ros-lockstep-limit 6")));
  ASSERT_TRUE(Eventually([&] { return driver.answered() == 19; }));
  for (const pid_t service : ChildrenWith(run, "world-service")) ASSERT_EQ(kill(service, SIGKILL), 0);
  EXPECT_EQ(run.Wait(), 3) << run.output();
  EXPECT_THAT(run.output(), ContainsRegex("tick 20 has waited [0-9.]+ s for driver of ROS"));
}

TEST_F(RosLockstepTest, ATimerOfSimulatedTimeSetsTheCommandOfEachTick) {
  std::string hashes;
  for (const int delay : {0, 10}) {
    const NodeOptions timer{.way = Way::kTimer, .most_delay = delay, .seed = 10};
    const std::string of_run = HashesOf(timer, Words("--ros-lockstep /r0/cmd_vel --ros-lockstep-limit 10"));
    EXPECT_EQ(std::count(of_run.begin(), of_run.end(), '\n'), 61);
    if (hashes.empty()) hashes = of_run;
    EXPECT_EQ(of_run, hashes);
  }
}

TEST_F(RosLockstepTest, ATimerOfSimulatedTimeGoesOnAfterAnEditAndAReset) {
  LockstepNode timer({.way = Way::kTimer});
  Program run = RunPen(Arguments("", Words("--ros-lockstep /r0/cmd_vel --ros-lockstep-limit 10 --speed 10 "
                                           "--ticks 100000")));
  run.WaitForLine("tick 0 continues without /r0/cmd_vel");
  ASSERT_TRUE(Eventually([&] { return timer.answered() >= 20; }));
  EXPECT_TRUE(Call(control::SetPose{.name = "r1", .pose = {0.0, 2.0, 0.0, 0.0}}).done);
  const Tick edited = Call(control::GetStatus()).tick;
  EXPECT_TRUE(Eventually([&] { return timer.answered() > edited + 5; }));
  EXPECT_TRUE(Call(control::Reset()).done);
  EXPECT_TRUE(Eventually([&] { return timer.answered() < edited; }));
  EXPECT_TRUE(Eventually([&] { return timer.answered() > edited; }));
  run.Interrupt();
}

TEST_F(RosLockstepTest, ANameThatNoTopicAndNoNodeHasIsRefused) {
  for (const char* const name : {"a b", "~cmd_vel", "r0/cmd_vel", "/r0//cmd_vel"}) {
    Program run = RunPen(Arguments("", {"--ros-lockstep", name}));
    EXPECT_EQ(run.Wait(), 2) << name;
    EXPECT_THAT(run.output(), HasSubstr(std::string("found '") + name + "', expected a topic such as")) << name;
  }
}

TEST_F(RosLockstepTest, ARobotInADomainOfItsOwnHasItsOwnTicks) {
  const std::uint32_t domain = ReserveDomain();
  std::ofstream(folder_.Path("own.json"))
      << R"({"world": ")" << WorldPath("pen.world") << R"(", "ticks": 40, "ros": true, "ros_lockstep": ["driver"],
           "robots": [{"name": "r0", "ros_domain": )"
      << domain << R"(, "ros_lockstep": ["~/cmd_vel"]}]})";
  std::string hashes;
  for (const int delay : {0, 10}) {
    LockstepNode of_run({.name = "driver", .space = "/r1", .most_delay = delay, .seed = 8});
    LockstepNode of_robot({.way = Way::kTopic, .space = "", .most_delay = delay, .seed = 9, .domain = domain});
    OutputOf(Troupe(Words("run % --headless --domain % --hash-log % --ros-interface lo --ros-domain %",
                          {folder_.Path("own.json"), std::to_string(TestDomain()), folder_.Path("hashes"),
                           std::to_string(TestRosNetwork().domain)})));
    if (hashes.empty()) hashes = folder_.Read("hashes");
    EXPECT_EQ(folder_.Read("hashes"), hashes);
  }
}

TEST_F(RosLockstepTest, ATickWaitsForTheSuccessorOfANodeThatIsKilled) {
  const std::string& reference = Reference();
  std::optional<Program> node(NodeProcess({}));
  Program run = RunPen(Arguments("killed-", Words("--ros-lockstep driver --ros-lockstep-limit 0 --speed 3")));
  ASSERT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick >= 10; }));
  node->Signal(SIGKILL);
  node->Wait();
  ASSERT_LT(Call(control::GetStatus()).tick, 60u);
  const LockstepNode successor({});
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_EQ(folder_.Read("killed-hashes"), reference);
}

TEST_F(RosLockstepTest, ViewersSeeARunThatPlaysWhileItsTickWaits) {
  LockstepNode driver({});
  driver.HaltAt(10);
  Program run = RunPen(Arguments("", {"--ros-lockstep", "driver", "--ros-lockstep-limit", "0"}));
  ASSERT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick == 10; }));
  Program top = Troupe({"top", "--domain", std::to_string(TestDomain()), "--session", session_});
  EXPECT_THAT(top.WaitForLine("tick 10"), HasSubstr(", playing, "));
  EXPECT_THAT(top.WaitForLine("the tick waits for"), HasSubstr("driver"));
  EXPECT_TRUE(Call(control::Pause()).done);
  top.WaitForLine(", paused, tick 10");
  EXPECT_TRUE(Call(control::Play()).done);
  top.WaitForLineAfter(", paused, tick 10");
  top.Signal(SIGINT);
  driver.Continue();
  EXPECT_EQ(run.Wait(), 0) << run.output();
}

TEST_F(RosLockstepTest, ABranchWaitsForTheNodesOfItsScenario) {
  const std::string scenario = folder_.Path("waits.json");
  std::ofstream(scenario) << R"({"world": ")" << WorldPath("pen.world")
                          << R"(", "ticks": 40, "ros": true, "ros_lockstep": ["driver"]})";
  const std::vector<std::string> network =
      Words("--headless --domain % --ros-interface lo --ros-domain %",
            {std::to_string(TestDomain()), std::to_string(TestRosNetwork().domain)});
  LockstepNode driver({});
  OutputOf(Troupe(Words("run % --record % --hash-log %", {scenario, folder_.Path("run.mcap"), folder_.Path("hashes")}) +
                  network));
  driver.HaltAt(25);
  Program branch = Troupe(Words("run % --from-tick 20 --ticks 40 --session %", {folder_.Path("run.mcap"), session_}) +
                          Words("--hash-log %", {folder_.Path("branch-hashes")}) + network);
  EXPECT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick == 25; }));
  driver.Continue();
  EXPECT_EQ(branch.Wait(), 0) << branch.output();
  const std::string hashes = folder_.Read("hashes");
  const std::string of_branch = folder_.Read("branch-hashes");
  EXPECT_EQ(of_branch.substr(of_branch.rfind('\n', of_branch.size() - 2)),
            hashes.substr(hashes.rfind('\n', hashes.size() - 2)));
}

// Nodes that only answer, each with a thread and a participant of its own.
class Answerer {
 public:
  explicit Answerer(std::string name)
      : name_(std::move(name)), participant_(TestRosNetwork()), thread_([this] { Run(); }) {}
  ~Answerer() {
    stop_ = true;
    thread_.join();
  }
  Answerer(const Answerer&) = delete;
  Answerer& operator=(const Answerer&) = delete;

 private:
  void Run() {
    const ros::RosNode node = ros::MakeNode(participant_, "/", name_);
    std::mutex mutex;
    std::condition_variable wake;
    bool arrived = false;
    ros::RosReader<ros::Header> ticks(node, "/world/tick", ros::Latched(), ros::Part::kOnlyReader, [&] {
      const std::lock_guard lock(mutex);
      arrived = true;
      wake.notify_one();
    });
    ros::RosWriter<ros::Header> answers(node, "/world/tick_done", ros::Stream(10));
    participant_.Announce();
    std::optional<ros::Time> stamp;
    while (!stop_) {
      {
        std::unique_lock lock(mutex);
        wake.wait_for(lock, std::chrono::milliseconds(100), [&] { return std::exchange(arrived, false); });
      }
      ticks.Drain([&](const ros::Header& tick) { stamp = tick.stamp; });
      if (!stamp || !answers.wanted()) continue;
      dds::WireArena arena;
      ros::Header header{};
      header.stamp = *stamp;
      header.frame_id = arena.Copy(name_);
      answers.Write(header);
      stamp.reset();
    }
  }

  const std::string name_;
  ros::RosParticipant participant_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

// The figures of docs/ros2-lockstep.md.
TEST_F(RosLockstepTest, DISABLED_TicksPerSecond) {
  for (const int count : {0, 1, 10, 50}) {
    std::vector<std::unique_ptr<Answerer>> nodes;
    std::string names;
    for (int i = 0; i < count; ++i) {
      nodes.push_back(std::make_unique<Answerer>("node" + std::to_string(i)));
      names += (i == 0 ? "node" : ",node") + std::to_string(i);
    }
    std::vector<std::string> more = Words("--ticks 1000000 --speed max");
    if (count > 0) more = more + std::vector<std::string>{"--ros-lockstep", names};
    Program run = RunPen(Arguments("", more));
    ASSERT_TRUE(Eventually([&] { return Call(control::GetStatus()).tick > 20; }, 120.0));
    const Tick from = Call(control::GetStatus()).tick;
    const auto began = std::chrono::steady_clock::now();
    std::this_thread::sleep_for(std::chrono::seconds(5));
    const Tick to = Call(control::GetStatus()).tick;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    std::printf("%d nodes: %.0f ticks per second\n", count, static_cast<double>(to - from) / seconds);
    run.Interrupt();
  }
}

TEST_F(RosLockstepTest, RefusesWhatCannotWait) {
  EXPECT_THAT(OutputOf(RunPen({"--ros-lockstep", "driver"}), 2),
              HasSubstr("found a run without ROS 2, expected --ros"));
  EXPECT_THAT(OutputOf(RunPen(RosArguments(Words("--ros-lockstep driver --mode realtime"))), 2),
              HasSubstr("in mode realtime"));
  EXPECT_THAT(OutputOf(RunPen(RosArguments(Words("--ros-lockstep driver --ros-clock-rate 100"))), 2),
              HasSubstr("--ros-clock-rate: found times between ticks"));
  for (const char* option : {"--ros-lockstep-period 2", "--ros-lockstep-limit 3", "--ros-lockstep-at-limit end"}) {
    EXPECT_THAT(OutputOf(RunPen(RosArguments(Words(option))), 2), HasSubstr("expected --ros-lockstep")) << option;
  }
}

}  // namespace
}  // namespace troupe::test
