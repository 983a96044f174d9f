// Ticks wait for nodes of ROS: runs with a node that drives a robot repeat, however slow the node is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <fstream>
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
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using std::chrono::milliseconds;
using testing::ContainsRegex;
using testing::HasSubstr;

// The way in which ticks wait for the node: for its commands, or for its answers on /world/tick_done.
enum class Way { kTopic, kProtocol };

struct NodeOptions {
  Way way = Way::kProtocol;
  std::string name = "driver";
  std::string space = "/r0";  // of the robot's topics
  int most_delay = 0;         // ms before an answer, drawn
  unsigned seed = 1;          // of the delays
  std::uint32_t domain = TestRosNetwork().domain;
};

// A node that drives a robot by its scan: the same scan gives the same command.
class Driver {
 public:
  explicit Driver(const NodeOptions& options)
      : options_(options), participant_(NetworkIn(options.domain)), thread_([this] { Run(); }) {}
  ~Driver() {
    stop_ = true;
    Notify();
    thread_.join();
  }
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  // It answers no tick from this one on, until Continue.
  void HaltAt(Tick tick) { halt_at_ = tick; }
  void Continue() {
    halt_at_ = kNever;
    Notify();
  }
  // Answers beside its own, which no tick may count.
  void SendWrongAnswers() { is_wrong_ = true; }
  Tick answered() const { return answered_; }  // the newest
  std::string lists() {
    const std::lock_guard lock(mutex_);
    return lists_;
  }

 private:
  static constexpr Tick kNever = 1'000'000'000;

  static ros::RosNetwork NetworkIn(std::uint32_t domain) {
    ros::RosNetwork network = TestRosNetwork();
    network.domain = domain;
    return network;
  }
  void Notify() {
    const std::lock_guard lock(mutex_);
    arrived_ = true;
    wake_.notify_one();
  }
  static ros::TwistMessage CommandFor(const ros::LaserScan& scan) {
    const auto ranges = dds::Elements(scan.ranges);
    double right = 0.0;
    double left = 0.0;
    double ahead = 8.0;
    const std::size_t count = ranges.size();
    for (std::size_t i = 0; i < count; ++i) {
      const double range = std::min<double>(ranges[i], 8.0);
      (2 * i < count ? right : left) += range;
      if (3 * i >= count && 3 * i < 2 * count) ahead = std::min(ahead, range);
    }
    ros::TwistMessage twist{};
    twist.linear.x = ahead > 0.7 ? 0.4 : 0.0;
    twist.angular.z = std::clamp((left - right) / 20.0, -1.0, 1.0) + (ahead > 0.7 ? 0.0 : 0.5);
    return twist;
  }

  void Run() {
    const ros::RosNode node = ros::MakeNode(participant_, "/", options_.name);
    const auto notify = [this] { Notify(); };
    ros::RosReader<ros::LaserScan> scans(node, options_.space + "/scan", ros::Stream(10), ros::Part::kOnlyReader,
                                         notify);
    ros::RosReader<ros::Header> ticks(node, "/world/tick", ros::Latched(), ros::Part::kOnlyReader, notify);
    ros::RosWriter<ros::TwistMessage> commands(node, options_.space + "/cmd_vel", ros::Stream(10));
    ros::RosWriter<ros::Header> answers(node, "/world/tick_done", ros::Stream(10));
    participant_.Announce();
    std::mt19937 random(options_.seed);
    std::optional<Tick> scanned;
    ros::TwistMessage command{};
    std::optional<Tick> shown;
    std::optional<ros::Time> stamp;
    bool has_scan = false;
    std::optional<Tick> done;  // by this node
    auto commanded_at = std::chrono::steady_clock::now();
    while (!stop_) {
      {
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, milliseconds(200), [this] { return arrived_ || stop_; });
        arrived_ = false;
      }
      scans.Drain([&](const ros::LaserScan& scan) {
        scanned = TickOf(scan.header.stamp);
        command = CommandFor(scan);
      });
      ticks.Drain([&](const ros::Header& tick) {
        shown = TickOf(tick.stamp);
        stamp = tick.stamp;
        const std::lock_guard lock(mutex_);
        lists_ = dds::Text(tick.frame_id);
        has_scan = (" " + lists_).find(" " + options_.space + "/scan:") != std::string::npos;
        if (done == shown) done.reset();  // the tick again: it is answered again
      });
      if (!commands.wanted()) continue;
      if (options_.way == Way::kTopic) {
        if (!scanned) continue;
        // The first one may be lost while the endpoints discover each other.
        const bool repeats = std::chrono::steady_clock::now() - commanded_at > milliseconds(1000);
        if (done == scanned && !repeats) continue;
        if (*scanned >= halt_at_) continue;
        if (done != scanned) Delay(random);
        commands.Write(command);
        commanded_at = std::chrono::steady_clock::now();
        done = scanned;
        answered_ = *done;
        continue;
      }
      if (!answers.wanted() || !shown || done == shown || *shown >= halt_at_) continue;
      if (scanned != shown && (has_scan || !done)) continue;  // of the first tick the scan is repeated for this node
      Delay(random);
      if (is_wrong_) SendWrong(answers, *shown);
      if (scanned == shown) commands.Write(command);
      Answer(answers, options_.name, *stamp);
      if (is_wrong_) Answer(answers, options_.name, *stamp);
      done = shown;
      answered_ = *done;
    }
  }
  void Delay(std::mt19937& random) const {
    if (options_.most_delay == 0) return;
    std::this_thread::sleep_for(milliseconds(std::uniform_int_distribution<int>(0, options_.most_delay)(random)));
  }
  static void Answer(ros::RosWriter<ros::Header>& answers, const std::string& name, const ros::Time& stamp) {
    dds::WireArena arena;
    ros::Header header{};
    header.stamp = stamp;
    header.frame_id = arena.Copy(name);
    answers.Write(header);
  }
  void SendWrong(ros::RosWriter<ros::Header>& answers, Tick tick) const {
    const auto stamp_of = [](Tick of) {
      return ros::Time{static_cast<std::int32_t>(of / 10), static_cast<std::uint32_t>(of % 10) * 100'000'000};
    };
    Answer(answers, options_.name, stamp_of(tick + 1));
    if (tick > 0) Answer(answers, options_.name, stamp_of(tick - 1));
    Answer(answers, options_.name, {-7, 4'000'000'000U});
    Answer(answers, "", stamp_of(tick));
    Answer(answers, std::string(300, '\x01'), stamp_of(tick));
  }

  const NodeOptions options_;
  ros::RosParticipant participant_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool arrived_ = true;
  std::string lists_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> is_wrong_ = false;
  std::atomic<Tick> halt_at_ = kNever;
  std::atomic<Tick> answered_ = 0;
  std::thread thread_;
};

class RosLockstepTest : public testing::Test {
 protected:
  std::vector<std::string> Arguments(const std::string& prefix, const std::vector<std::string>& more) {
    return RosArguments(Words("--ticks 60 --hash-log % --session %", {folder_.Path(prefix + "hashes"), session_}) +
                        more);
  }
  // The hashes of a run with the driver.
  std::string HashesOf(const NodeOptions& node, const std::vector<std::string>& more) {
    const std::string prefix = std::to_string(runs_++) + "-";
    Driver driver(node);
    OutputOf(RunPen(Arguments(prefix, more)));
    return folder_.Read(prefix + "hashes");
  }
  ControlReply Call(const ControlRequest& request) const {
    ControlClient client(NetworkOf(session_));
    EXPECT_TRUE(client.WaitForService(kSeconds).ok());
    const Result<ControlReply> reply = client.Call(request, kSeconds);
    EXPECT_TRUE(reply.ok());
    return reply.ok() ? reply.value() : ControlReply();
  }
  ControlReply Call(ControlCommand command, std::uint64_t ticks = 1) const {
    ControlRequest request{.command = command, .ticks = ticks};
    return Call(request);
  }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("lockstep");
  int runs_ = 0;
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

TEST_F(RosLockstepTest, AnswersToOtherTicksTwiceOrWithoutSenseCountForNone) {
  const std::string reference = HashesOf({}, {"--ros-lockstep", "driver"});
  Driver driver({});
  driver.SendWrongAnswers();
  Program run = RunPen(Arguments("wrong-", {"--ros-lockstep", "driver"}));
  const std::string output = OutputOf(std::move(run));
  EXPECT_EQ(folder_.Read("wrong-hashes"), reference);
  EXPECT_THAT(output, HasSubstr("ignored the answer of 'driver' to"));
}

TEST_F(RosLockstepTest, ASilentNodeIsNamedAndEndsTheRunAtTheLimit) {
  Driver driver({});
  driver.HaltAt(20);
  Program run = RunPen(
      Arguments("", Words("--ros-lockstep driver --ros-lockstep-limit 1.5 --summary %", {folder_.Path("summary")})));
  EXPECT_EQ(run.Wait(), 3) << run.output();
  EXPECT_THAT(run.output(), ContainsRegex("tick 20 has waited [0-9.]+ s for driver of ROS"));
}

TEST_F(RosLockstepTest, ARunContinuesWithoutASilentNodeIfAskedUntilItReturns) {
  Driver driver({});
  driver.HaltAt(20);
  Program run = RunPen(Arguments("", Words("--ros-lockstep driver --ros-lockstep-limit 0.5 --ros-lockstep-at-limit "
                                           "continue --ticks 100000 --speed 20")));
  run.WaitForLine("tick 20 continues after");
  driver.Continue();
  run.WaitForLine("ticks wait for driver again");
  run.Interrupt();
}

TEST_F(RosLockstepTest, TheFirstAnswerHasNoLimitAndTheStatusNamesTheNode) {
  Program run = RunPen(
      Arguments("", Words("--ros-lockstep driver --ros-lockstep-limit 0.2 --summary %", {folder_.Path("summary")})));
  run.WaitForLine("waiting for driver");
  const Driver driver({});
  EXPECT_EQ(run.Wait(), 0) << run.output();
  const auto summary = nlohmann::json::parse(folder_.Read("summary"));
  ASSERT_EQ(summary["ros_lockstep"].size(), 1u);
  EXPECT_EQ(summary["ros_lockstep"][0]["name"], "driver");
  EXPECT_EQ(summary["ros_lockstep"][0]["times_last"], 60);
}

TEST_F(RosLockstepTest, StepsEndWhenTheNodeHasAnsweredTheirLastTick) {
  Driver driver({});
  driver.HaltAt(5);
  Program run = RunPen(Arguments("", {"--ros-lockstep", "driver", "--paused", "--ros-lockstep-limit", "0"}));
  EXPECT_TRUE(Call(ControlCommand::kStep, 4).done);
  EXPECT_TRUE(Eventually([&] { return driver.answered() == 4; }));
  std::atomic<bool> has_stepped = false;
  std::thread stepper([&] {
    EXPECT_TRUE(Call(ControlCommand::kStep, 1).done);
    has_stepped = true;
  });
  EXPECT_TRUE(Eventually([&] { return Call(ControlCommand::kStatus).tick == 5; }));
  EXPECT_FALSE(has_stepped);
  driver.Continue();
  stepper.join();
  EXPECT_TRUE(Eventually([&] { return driver.answered() == 5; }));
  run.Interrupt();
}

TEST_F(RosLockstepTest, EditsAreExecutedWhileATickWaits) {
  Driver driver({});
  driver.HaltAt(10);
  Program run = RunPen(Arguments("", {"--ros-lockstep", "driver", "--ros-lockstep-limit", "0", "--ticks", "100000"}));
  EXPECT_TRUE(Eventually([&] { return Call(ControlCommand::kStatus).tick == 10; }));
  EXPECT_EQ(Call(ControlCommand::kStatus).state, RunState::kPlaying);
  EXPECT_TRUE(Call({.command = ControlCommand::kSetPose, .name = "r1", .pose = {0.0, 2.0, 0.0, 0.0}}).done);
  EXPECT_TRUE(
      Call({.command = ControlCommand::kSpawn, .name = "late", .source = "rover", .pose = {0, -2.2, 0, 0}}).done);
  EXPECT_TRUE(Call({.command = ControlCommand::kDelete, .name = "late"}).done);
  EXPECT_TRUE(Call(ControlCommand::kPause).done);
  EXPECT_EQ(Call(ControlCommand::kStatus).state, RunState::kPaused);
  EXPECT_EQ(Call(ControlCommand::kStatus).tick, 10u);
  EXPECT_TRUE(Call(ControlCommand::kReset).done);
  EXPECT_TRUE(Call(ControlCommand::kPlay).done);
  EXPECT_TRUE(Eventually([&] { return Call(ControlCommand::kStatus).tick == 10; }));
  driver.Continue();
  EXPECT_TRUE(Eventually([&] { return Call(ControlCommand::kStatus).tick > 30; }));
  run.Interrupt();
}

TEST_F(RosLockstepTest, ATickWaitsForATopicOfAnyTypeAndTellsOfItsMessages) {
  ros::RosParticipant participant(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(participant, "/", "planner");
  ros::RosWriter<ros::Clock> plans(node, "/plan", ros::Stream(1));  // of a type that no agent reads
  participant.Announce();
  Driver driver({});
  Program run = RunPen(Arguments("", {"--ros-lockstep", "driver,/plan", "--ros-lockstep-limit", "0"}));
  for (Tick tick = 0; tick <= 2; ++tick) {
    EXPECT_TRUE(Eventually([&] { return driver.answered() == tick && Call(ControlCommand::kStatus).tick == tick; }));
    // The first one may be lost while the endpoints discover each other.
    EXPECT_TRUE(Eventually([&] { return plans.wanted(); }));
    bool advances = false;
    for (int trial = 0; trial < 5 && !advances; ++trial) {
      EXPECT_EQ(Call(ControlCommand::kStatus).tick, tick);
      plans.Write({});
      advances = Eventually([&] { return Call(ControlCommand::kStatus).tick > tick; }, 4.0);
    }
    ASSERT_TRUE(advances);
  }
  EXPECT_TRUE(Eventually([&] { return driver.lists().find("/r0/scan:1") != std::string::npos; }));
  EXPECT_THAT(driver.lists(), HasSubstr("/tf:4"));
  run.Signal(SIGINT);
  EXPECT_EQ(run.Wait(), 130);
}

TEST_F(RosLockstepTest, ARunWithAKilledServiceRepeatsAndReplays) {
  const std::string reference = HashesOf({}, {"--ros-lockstep", "driver"});
  for (const Way way : {Way::kProtocol, Way::kTopic}) {
    const std::string prefix = way == Way::kTopic ? "topic-" : "protocol-";
    const std::string recording = folder_.Path(prefix + "run.mcap");
    Driver driver({.way = way});
    Program run = RunPen(Arguments(prefix, Words("--speed 10 --lease 1 --record % --ros-lockstep %",
                                                 {recording, way == Way::kTopic ? "/r0/cmd_vel" : "driver"})));
    ASSERT_TRUE(Eventually([&] { return driver.answered() >= 20; }));
    for (const pid_t service : ChildrenWith(run, "world-service")) ASSERT_EQ(kill(service, SIGKILL), 0);
    EXPECT_EQ(run.Wait(), 0) << run.output();
    EXPECT_EQ(folder_.Read(prefix + "hashes"), reference) << run.output();
    OutputOf(Troupe({"replay", recording, "--verify"}));
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
    Driver of_run({.name = "driver", .space = "/r1", .most_delay = delay, .seed = 8});
    Driver of_robot({.way = Way::kTopic, .space = "", .most_delay = delay, .seed = 9, .domain = domain});
    OutputOf(Troupe(Words("run % --headless --domain % --hash-log % --ros-interface lo --ros-domain %",
                          {folder_.Path("own.json"), std::to_string(TestDomain()), folder_.Path("hashes"),
                           std::to_string(TestRosNetwork().domain)})));
    if (hashes.empty()) hashes = folder_.Read("hashes");
    EXPECT_EQ(folder_.Read("hashes"), hashes);
  }
}

TEST_F(RosLockstepTest, RefusesWhatCannotWait) {
  EXPECT_THAT(OutputOf(RunPen({"--ros-lockstep", "driver"}), 2), HasSubstr("found a run without ROS, expected --ros"));
  EXPECT_THAT(OutputOf(RunPen(RosArguments(Words("--ros-lockstep driver --mode realtime"))), 2),
              HasSubstr("in mode realtime"));
  EXPECT_THAT(OutputOf(RunPen(RosArguments(Words("--ros-lockstep driver --ros-clock-rate 100"))), 2),
              HasSubstr("--ros-clock-rate: found times between ticks"));
}

}  // namespace
}  // namespace troupe::test
