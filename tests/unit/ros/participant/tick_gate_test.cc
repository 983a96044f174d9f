// A tick reaches nodes once they can receive it, and each of its messages once.
#include "ros/participant/tick_gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/node_services.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "ros/link/host_connection.h"
#include "ros/messages/messages.h"
#include "tests/support/dds_domain.h"
#include "tests/support/host_participant.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"

namespace troupe::ros {
namespace {

using test::Eventually;
using testing::ElementsAre;
using testing::IsEmpty;

using ResetClient = test::Client<simulation_interfaces_srv_dds__ResetSimulation_Request_,
                                 simulation_interfaces_srv_dds__ResetSimulation_Response_>;

// A process whose ticks wait for topics, or for nodes. It has a service.
class WaitingRun {
 public:
  WaitingRun(const test::HostParticipant& host, const std::vector<std::string>& watched)
      : connection_(host.Connect(HostConnection::Sending::kAtOnce)),
        node_(MakeNode(*connection_, "/", "world")),
        ticks_(connection_->MakeWriter(node_.index, {"rt/world/tick", Type(), Latched()})),
        answers_(
            connection_->MakeReader(node_.index, {"rt/world/tick_done", Type(), Stream(10)}, Part::kOnlyReader, {})) {
    connection_->WatchTopics([] {});
    for (const std::string& name : watched) watches_.insert(connection_->Watch(name));
    connection_->Announce();
  }

  void Arm(const std::string& text) {
    connection_->Arm(text);
    EXPECT_TRUE(Eventually([&] { return connection_->watched().armed == text; }));
  }
  void Publish() { connection_->Show(); }
  void Tell(bool awaits = true) {
    dds::WireArena arena;
    Header header{};
    header.frame_id = arena.Copy("edition:4");
    connection_->Collect();
    connection_->Tell(*ticks_, &header, *answers_, awaits ? watches_ : std::set<std::uint32_t>());
  }
  void AwaitNone() { connection_->Await({}); }
  bool is_told() { return connection_->watched().is_told; }
  bool IsTold() {
    return Eventually([this] { return is_told(); });
  }
  // The tick is held back because no program is there that could answer.
  bool IsHeldForAbsent() {
    return Eventually([this] { return connection_->watched().held_for == watches_; });
  }
  bool IsAnswered() {
    return Eventually([this] { return connection_->watched().arrived == watches_; });
  }
  // The text before was answered, and this one is not yet.
  bool WasAnsweredBefore() {
    const HostConnection::Watched watched = connection_->watched();
    return watched.arrived_before == watches_ && watched.arrived.empty();
  }
  // Calls of all wait for others.
  bool HoldsCalls() {
    return Eventually([this] { return connection_->watched().calling.size() == 1; });
  }
  // Of those that have called, in the order of their calls.
  std::vector<std::uint64_t> callers() {
    const std::lock_guard lock(mutex_);
    return callers_;
  }

 private:
  static const dds_topic_descriptor_t* Type() { return dds::TopicTraits<Header>::descriptor(); }

  std::unique_ptr<HostConnection> connection_;
  RosNode node_;
  std::unique_ptr<TopicWriter> ticks_;
  std::unique_ptr<TopicReader> answers_;
  std::set<std::uint32_t> watches_;
  std::mutex mutex_;
  std::vector<std::uint64_t> callers_;
  RosService<simulation_interfaces_srv_dds__ResetSimulation_Request_,
             simulation_interfaces_srv_dds__ResetSimulation_Response_>
      service_{node_, "/world/reset_simulation", [this](const RosCaller& caller, const auto& request) {
                 if (caller.is_repeated) return;
                 const std::lock_guard lock(mutex_);
                 callers_.push_back(request.client_guid);
               }};
};

// An agent with a topic that has the time of a tick.
class ShowingAgent {
 public:
  explicit ShowingAgent(const test::HostParticipant& host) : connection_(host.Connect()) { connection_->Announce(); }

  // Readers of the topic are there.
  bool IsWanted() {
    return Eventually([this] {
      connection_->Receive();
      return output_.wanted();
    });
  }
  void Show(int tick) {
    Write(tick);
    connection_->AwaitSent();
  }
  // As in a wait, when it is asked.
  bool ShowsAgain(int tick) {
    return Eventually([&] {
      connection_->Receive();
      if (!connection_->ConsumeShowAgain()) return false;
      connection_->AddressReadersSince(std::chrono::steady_clock::time_point::min());
      Write(tick);
      connection_->AddressReadersSince(std::nullopt);
      connection_->ConfirmShown();
      return true;
    });
  }

 private:
  void Write(int tick) {
    OdometryMessage message{};
    message.header.stamp.sec = tick;
    message.header.frame_id = message.child_frame_id = const_cast<char*>("");
    output_.Write(message);
  }

  std::unique_ptr<HostConnection> connection_;
  RosNode node_ = MakeNode(*connection_, "/r0", "robot");
  RosWriter<OdometryMessage> output_{node_, "odom", Stream(10)};
};

// A program of ROS 2 that reads the topic and the ticks, and can have a writer of commands.
class PlannerNode {
 public:
  explicit PlannerNode(const std::string& plan = "/plan") : plan_(plan), participant_(test::TestRosNetwork()) {
    participant_.Announce();
  }

  void MakeCommands() {
    commands_.emplace(node_, plan_, Stream(1));
    parameters_.emplace(node_, "planner", Parameters{});
    participant_.Announce();
  }
  void Command() {
    EXPECT_TRUE(Eventually([this] { return commands_->wanted(); }));
    commands_->Write({});
  }
  const RosParticipant& participant() const { return participant_; }
  std::vector<int> DrainTimes() {
    std::vector<int> times;
    odometry_.Drain([&times](const OdometryMessage& message) { times.push_back(message.header.stamp.sec); });
    return times;
  }
  // The list of the newest tick.
  std::string DrainList() {
    std::string list;
    ticks_.Drain([&list](const Header& tick) { list = dds::Text(tick.frame_id); });
    return list;
  }

 private:
  const std::string plan_;
  RosParticipant participant_;
  RosNode node_ = MakeNode(participant_, "/", "planner");
  RosReader<OdometryMessage> odometry_{node_, "/r0/odom", Stream(10)};
  RosReader<Header> ticks_{node_, "/world/tick", Latched()};
  std::optional<RosWriter<Clock>> commands_;
  std::optional<ParameterServices> parameters_;
};

class TickGateTest : public testing::Test {
 protected:
  // In the tick 0 the node has answered.
  void BeginWithAnswer(WaitingRun& run) {
    run.Arm("run 1 0");
    node_.MakeCommands();
    agent_.Show(0);
    run.Tell();
    EXPECT_TRUE(agent_.ShowsAgain(0));
    EXPECT_TRUE(run.IsTold());
    node_.Command();
    EXPECT_TRUE(Eventually([this] { return !node_.DrainTimes().empty(); }));
  }

  // A tick that is not held back.
  void Publish(WaitingRun& run, const std::string& text, int tick) {
    run.Arm(text);
    agent_.Show(tick);
    run.Tell();
    EXPECT_TRUE(run.IsTold());
  }

  test::HostParticipant host_;
  ShowingAgent agent_{host_};
  PlannerNode node_;
};

TEST_F(TickGateTest, ATickIsHeldBackUntilAProgramCanAnswerIt) {
  WaitingRun run(host_, {"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  run.Arm("run 1 0");
  agent_.Show(0);
  run.Tell();
  EXPECT_TRUE(run.IsHeldForAbsent());
  EXPECT_THAT(node_.DrainTimes(), IsEmpty());
  node_.MakeCommands();
  EXPECT_FALSE(run.is_told());
  EXPECT_TRUE(agent_.ShowsAgain(0));
  EXPECT_TRUE(run.IsTold());
  std::vector<int> times;
  EXPECT_TRUE(Eventually([&] { return !(times = node_.DrainTimes()).empty(); }));
  EXPECT_THAT(times, ElementsAre(0));
  std::string list;
  EXPECT_TRUE(Eventually([&] { return !(list = node_.DrainList()).empty(); }));
  EXPECT_EQ(list, "edition:4 /r0/odom:1");
}

TEST_F(TickGateTest, ATickThatWaitsForNoneIsToldAtOnce) {
  WaitingRun run(host_, {"rt/plan"});
  run.Arm("run 1 0");
  run.Tell(false);
  EXPECT_TRUE(run.IsTold());
}

TEST_F(TickGateTest, AMessageOfATickIsWrittenOnceAndListedWithItsStamp) {
  WaitingRun run(host_, {"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  BeginWithAnswer(run);
  run.Arm("run 1 1");
  agent_.Show(1);  // as an agent that is started again
  Publish(run, "run 1 1", 1);
  Publish(run, "run 2 1", 1);  // an edit
  std::vector<int> times;
  EXPECT_TRUE(Eventually([&] {
    for (const int time : node_.DrainTimes()) times.push_back(time);
    return times.size() >= 2;
  }));
  EXPECT_THAT(times, ElementsAre(1, 1));
  EXPECT_EQ(node_.DrainList(), "edition:4 /r0/odom:1 @/r0/odom:1000000000");
}

// A process that continues the run of one that has died before its nodes could answer.
TEST_F(TickGateTest, WhatIsHeldBackIsKeptForTheSuccessorOfTheProcessThatWaits) {
  std::optional<WaitingRun> run(std::in_place, host_, std::vector<std::string>{"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  run->Arm("run");
  run->Arm("run 1 0");
  agent_.Show(0);
  run->Tell();
  EXPECT_TRUE(run->IsHeldForAbsent());
  run.emplace(host_, std::vector<std::string>{"rt/plan"});
  run->Arm("run");
  run->Arm("run 1 0");
  run->Tell();
  EXPECT_TRUE(run->IsHeldForAbsent());
  node_.MakeCommands();
  EXPECT_TRUE(agent_.ShowsAgain(0));
  EXPECT_TRUE(run->IsTold());
  std::vector<int> times;
  EXPECT_TRUE(Eventually([&] { return !(times = node_.DrainTimes()).empty(); }));
  EXPECT_THAT(times, ElementsAre(0));
}

TEST_F(TickGateTest, ATickThatWasAnsweredIsSoForTheSuccessorOfTheProcessThatHasReleasedIt) {
  std::optional<WaitingRun> run(std::in_place, host_, std::vector<std::string>{"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  BeginWithAnswer(*run);
  EXPECT_TRUE(run->IsAnswered());
  run->Arm("run 1 1");
  run.emplace(host_, std::vector<std::string>{"rt/plan"});
  run->Arm("run");
  run->Arm("run 1 0");
  EXPECT_TRUE(run->IsAnswered());
}

TEST_F(TickGateTest, ATickThatWasAnsweredIsSoForTheSuccessorOfAProcessThatHasDiedBeforeTheNextOne) {
  std::optional<WaitingRun> run(std::in_place, host_, std::vector<std::string>{"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  BeginWithAnswer(*run);
  EXPECT_TRUE(run->IsAnswered());
  run.emplace(host_, std::vector<std::string>{"rt/plan"});
  run->Arm("run");
  run->Arm("run 1 0");
  EXPECT_TRUE(run->IsAnswered());
}

TEST_F(TickGateTest, AnAgentThatIsStartedAgainShowsNoTickThatWasReleased) {
  WaitingRun run(host_, {"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  BeginWithAnswer(run);
  run.Arm("run 1 1");
  agent_.Show(0);
  Publish(run, "run 1 1", 1);
  std::vector<int> times;
  EXPECT_TRUE(Eventually([&] {
    for (const int time : node_.DrainTimes()) times.push_back(time);
    return !times.empty() && times.back() == 1;
  }));
  EXPECT_THAT(times, ElementsAre(1));
}

TEST_F(TickGateTest, ATickIsToldAfterAnEditOfOneThatWasHeldBack) {
  WaitingRun run(host_, {"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  run.Arm("run 1 0");
  agent_.Show(0);
  run.Tell();
  EXPECT_TRUE(run.IsHeldForAbsent());
  run.Arm("run 2 0");
  agent_.Show(0);
  run.Tell();
  node_.MakeCommands();
  EXPECT_TRUE(agent_.ShowsAgain(0));
  EXPECT_TRUE(run.IsTold());
}

// A node that has been killed writes no more, and its DDS is known to have ended only some seconds later.
TEST_F(TickGateTest, ASuccessorThatHasComeBeforeTheEndOfANodeIsShownTheTick) {
  WaitingRun run(host_, {"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  std::optional<PlannerNode> before(std::in_place);
  run.Arm("run 1 0");
  before->MakeCommands();
  agent_.Show(0);
  run.Tell();
  EXPECT_TRUE(agent_.ShowsAgain(0));
  EXPECT_TRUE(run.IsTold());
  before->Command();
  EXPECT_TRUE(run.IsAnswered());
  Publish(run, "run 1 1", 1);
  PlannerNode successor;
  successor.MakeCommands();
  before.reset();
  EXPECT_TRUE(agent_.ShowsAgain(1));
  EXPECT_TRUE(Eventually([&] {
    const std::vector<int> times = successor.DrainTimes();
    return !times.empty() && times.back() == 1;
  }));
}

TEST_F(TickGateTest, NoReaderThatComesLaterMakesAnAgentShowATickAgain) {
  WaitingRun run(host_, {"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  BeginWithAnswer(run);
  Publish(run, "run 1 1", 1);
  PlannerNode late;
  EXPECT_TRUE(Eventually([&] { return !late.DrainList().empty(); }));
  Publish(run, "run 1 2", 2);
  std::vector<int> times;
  EXPECT_TRUE(Eventually([&] {
    for (const int time : node_.DrainTimes()) times.push_back(time);
    return !times.empty() && times.back() == 2;
  }));
  EXPECT_THAT(times, ElementsAre(1, 2));
}

TEST_F(TickGateTest, TheAnswerToATickIsKnownAfterItsEdit) {
  WaitingRun run(host_, {"rt/plan"});
  ASSERT_TRUE(agent_.IsWanted());
  BeginWithAnswer(run);
  Publish(run, "run 1 1", 1);
  node_.Command();
  EXPECT_TRUE(run.IsAnswered());
  run.Arm("run 2 1");
  EXPECT_TRUE(run.WasAnsweredBefore());
}

// A node may call as soon as it has one message of the tick.
TEST_F(TickGateTest, CallsBeforeATickIsToldAreInTheOrderOfTheNamesOfTheCallers) {
  WaitingRun run(host_, {"rt/first", "rt/second"});
  ASSERT_TRUE(agent_.IsWanted());
  PlannerNode first("/first");
  PlannerNode second("/second");
  ResetClient first_call(first.participant(), "/world/reset_simulation", 1);
  ResetClient second_call(second.participant(), "/world/reset_simulation", 2);
  run.Arm("run 1 0");
  first.MakeCommands();
  second.MakeCommands();
  agent_.Show(0);
  run.Tell();
  EXPECT_TRUE(agent_.ShowsAgain(0));
  EXPECT_TRUE(run.IsTold());
  first.Command();
  second.Command();
  EXPECT_TRUE(run.IsAnswered());

  run.Arm("run 1 1");
  run.Publish();
  agent_.Show(1);
  second_call.Send({});
  second_call.AwaitArrival();
  run.Tell();
  EXPECT_TRUE(run.IsTold());
  first_call.Send({});
  EXPECT_TRUE(Eventually([&] { return run.callers().size() == 2; }));
  EXPECT_THAT(run.callers(), ElementsAre(1, 2));
}

class CallsTest : public TickGateTest {
 protected:
  // Both have answered the tick 0; the tick 1 is told.
  void Begin(WaitingRun& run) {
    ASSERT_TRUE(agent_.IsWanted());
    run.Arm("run 1 0");
    first_.MakeCommands();
    second_.MakeCommands();
    agent_.Show(0);
    run.Tell();
    EXPECT_TRUE(agent_.ShowsAgain(0));
    EXPECT_TRUE(run.IsTold());
    first_.Command();
    second_.Command();
    EXPECT_TRUE(run.IsAnswered());
    run.Arm("run 1 1");
    run.Publish();
    agent_.Show(1);
    run.Tell();
    EXPECT_TRUE(run.IsTold());
  }

  PlannerNode first_{"/first"};
  PlannerNode second_{"/second"};
  ResetClient call_{second_.participant(), "/world/reset_simulation", 2};
};

TEST_F(CallsTest, ACallIsExecutedAsSoonAsTheOtherParticipantHasAnswered) {
  WaitingRun run(host_, {"rt/first", "rt/second"});
  Begin(run);
  call_.Send({});
  EXPECT_TRUE(run.HoldsCalls());
  EXPECT_THAT(run.callers(), IsEmpty());
  first_.Command();
  EXPECT_TRUE(Eventually([&] { return run.callers().size() == 1; }, 4.0));
}

TEST_F(CallsTest, ACallIsExecutedWhenTheTickWaitsForTheOtherNoLonger) {
  WaitingRun run(host_, {"rt/first", "rt/second"});
  Begin(run);
  call_.Send({});
  EXPECT_TRUE(run.HoldsCalls());
  run.AwaitNone();
  EXPECT_TRUE(Eventually([&] { return run.callers().size() == 1; }));
}

TEST_F(CallsTest, ACallThatWaitsIsExecutedByTheSuccessorOfTheService) {
  std::optional<WaitingRun> run(std::in_place, host_, std::vector<std::string>{"rt/first", "rt/second"});
  Begin(*run);
  call_.Send({});
  EXPECT_TRUE(run->HoldsCalls());
  run.reset();
  run.emplace(host_, std::vector<std::string>{"rt/first", "rt/second"});
  run->Arm("run");
  run->Arm("run 1 1");
  run->Tell();
  EXPECT_TRUE(run->HoldsCalls());
  EXPECT_THAT(run->callers(), IsEmpty());
  first_.Command();
  EXPECT_TRUE(Eventually([&] { return run->callers() == std::vector<std::uint64_t>{2}; }));
}

// A node that answers ticks, and calls.
class AnsweringNode {
 public:
  explicit AnsweringNode(const std::string& name, std::uint64_t id)
      : participant_(test::TestRosNetwork()),
        node_(MakeNode(participant_, "/", name)),
        answers_(node_, "/world/tick_done", Stream(10)),
        call_(participant_, "/world/reset_simulation", id) {
    parameters_.emplace(node_, name, Parameters{});
    participant_.Announce();
  }

  void Answer(const std::string& text) {
    EXPECT_TRUE(Eventually([this] { return answers_.wanted(); }));
    dds::WireArena arena;
    Header header{};
    header.frame_id = arena.Copy(text);
    answers_.Write(header);
  }
  void Call() {
    call_.Send({});
    call_.AwaitArrival();
  }

 private:
  RosParticipant participant_;
  RosNode node_;
  RosWriter<Header> answers_;
  ResetClient call_;
  std::optional<ParameterServices> parameters_;
};

TEST_F(TickGateTest, CallsOfANodeAndOfTheSuccessorOfAnotherAreInTheOrderOfTheirNames) {
  WaitingRun run(host_, {"alpha", "beta", "gamma"});
  ASSERT_TRUE(agent_.IsWanted());
  const auto tell = [&](const std::string& text, int tick, bool is_held) {
    run.Arm(text);
    run.Publish();
    agent_.Show(tick);
    run.Tell();
    if (is_held) EXPECT_TRUE(agent_.ShowsAgain(tick));
    EXPECT_TRUE(run.IsTold());
  };
  AnsweringNode alpha("alpha", 1);
  std::optional<AnsweringNode> beta(std::in_place, "beta", 2);
  AnsweringNode gamma("gamma", 3);
  tell("run 1 0", 0, true);
  gamma.Call();
  gamma.Answer("gamma edition:3");  // to another announcement
  beta->Call();
  EXPECT_THAT(run.callers(), IsEmpty());
  alpha.Answer("alpha edition:4 waits");
  EXPECT_TRUE(Eventually([&] { return run.callers().size() == 2; }));
  alpha.Answer("alpha");
  beta->Answer("beta edition:4");
  gamma.Answer("gamma edition:4");
  EXPECT_TRUE(run.IsAnswered());

  beta.reset();
  beta.emplace("beta", 2);
  tell("run 1 1", 1, true);
  beta->Call();
  gamma.Call();
  alpha.Call();
  EXPECT_TRUE(Eventually([&] { return run.callers().size() == 5; }));
  EXPECT_THAT(run.callers(), ElementsAre(2, 3, 1, 2, 3));
}

// The agent of a robot that is driven.
class DrivenAgent {
 public:
  explicit DrivenAgent(const test::HostParticipant& host) : connection_(host.Connect()) {
    connection_->Announce();
    connection_->Flush();
  }

  bool GetsCommand(double speed, double seconds = 20.0) {
    return Eventually([&] { return !DrainSpeeds().empty() && speeds_.back() == speed; }, seconds);
  }
  std::vector<double> DrainSpeeds() {
    connection_->Receive();
    commands_.Drain([this](const TwistMessage& twist) { speeds_.push_back(twist.linear.x); });
    return speeds_;
  }

 private:
  std::unique_ptr<HostConnection> connection_;
  RosNode node_ = MakeNode(*connection_, "/r0", "robot");
  RosReader<TwistMessage> commands_{node_, "cmd_vel", Commands(true, 10)};
  std::vector<double> speeds_;
};

TEST_F(TickGateTest, TheSuccessorOfAnAgentGetsTheCommandsOfTheTickAndOfNoOtherRun) {
  WaitingRun run(host_, {"rt/r0/cmd_vel"});
  RosParticipant participant(test::TestRosNetwork());
  const RosNode driver = MakeNode(participant, "/", "driver");
  RosWriter<TwistMessage> commands(driver, "/r0/cmd_vel", Stream(10));
  participant.Announce();
  std::optional<DrivenAgent> agent(std::in_place, host_);
  run.Arm("run 1 0");
  EXPECT_TRUE(Eventually([&] { return commands.wanted(); }));
  TwistMessage twist{};
  twist.linear.x = 1.0;
  // The first one may be lost while the endpoints discover each other.
  bool is_received = false;
  for (int trial = 0; trial < 5 && !is_received; ++trial) {
    commands.Write(twist);
    is_received = agent->GetsCommand(1.0, 4.0);
  }
  EXPECT_TRUE(is_received);
  std::vector<double> speeds = agent->DrainSpeeds();
  speeds.push_back(2.0);
  run.Arm("run 1 1");
  agent.reset();
  twist.linear.x = 2.0;
  commands.Write(twist);  // while there is none
  agent.emplace(host_);
  EXPECT_TRUE(agent->GetsCommand(2.0));
  EXPECT_EQ(agent->DrainSpeeds(), speeds);
  run.Arm("run 2 0");
  agent.reset();
  agent.emplace(host_);
  twist.linear.x = 3.0;
  commands.Write(twist);
  EXPECT_TRUE(agent->GetsCommand(3.0));
  EXPECT_THAT(agent->DrainSpeeds(), ElementsAre(3.0));
}

}  // namespace
}  // namespace troupe::ros
