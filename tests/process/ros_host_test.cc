// The processes of a run on a host share the program ros-participant, with one participant in each ROS domain.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "tests/process/programs.h"
#include "tests/process/ros_edit_run.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using StepClient = TROUPE_SIMULATION_CLIENT(StepSimulation);

std::vector<pid_t> ParticipantsOf(const Program& run) {
  std::vector<pid_t> participants = ChildrenOf(run.pid());
  std::erase_if(participants,
                [](pid_t child) { return CommandLineOf(child).find("/ros-participant ") == std::string::npos; });
  return participants;
}

// Awaits messages from now on.
template <typename T>
void ExpectMessages(ros::RosReader<T>& reader) {
  reader.Drain([](const T&) {});
  int received = 0;
  EXPECT_TRUE(Eventually([&] {
    reader.Drain([&](const T&) { ++received; });
    return received >= 3;
  }));
}

TEST(RosHost, AllShareOneParticipantAndReturnWhenItIsKilled) {
  RosEditRun run(WorldPath("pen.world"), {"--speed", "1", "--ros-services", "cyclone"});
  const std::vector<std::string> robots = {"r0", "r1", "r2", "r3"};
  run.ExpectRobots(robots);
  EXPECT_EQ(run.participants(), 1u);
  ros::RosParticipant participant(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(participant, "/", "tester");
  ros::RosReader<ros::OdometryMessage> odometry(node, "/r0/odom", ros::Stream(10));
  ExpectMessages(odometry);
  for (int i = 0; i < 2; ++i) {
    const std::vector<pid_t> participants = ParticipantsOf(run.program());
    ASSERT_EQ(participants.size(), 1u);
    kill(participants.front(), SIGKILL);
    EXPECT_TRUE(Eventually([&] {
      const std::vector<pid_t> next = ParticipantsOf(run.program());
      return next.size() == 1 && next != participants;
    }));
    ExpectMessages(odometry);
    run.ExpectRobots(robots);
  }
  const std::vector<pid_t> participants = ParticipantsOf(run.program());
  run.End();
  EXPECT_THAT(run.program().output(), HasSubstr("the ROS participant of this host (process "));
  EXPECT_THAT(run.program().output(), HasSubstr("was killed by signal 9 (Killed); it is started again"));
  for (const pid_t process : participants) EXPECT_TRUE(IsGoneSoon(process));
}

TEST(RosHost, EditsAndLostAgentsChangeTheGraph) {
  RosEditRun run(WorldPath("pen.world"), {"--paused"});
  run.Step(2);
  run.ExpectRobots({"r0", "r1", "r2", "r3"});
  run.Delete("r1");
  run.ExpectRobots({"r0", "r2", "r3"});
  run.ExpectNoTopicsOf("r1");
  run.Reset();
  run.Step(2);
  run.ExpectRobots({"r0", "r1", "r2", "r3"});
  const std::vector<pid_t> agents = run.AgentsOf("r2");
  ASSERT_EQ(agents.size(), 1u);
  kill(agents.front(), SIGKILL);
  EXPECT_TRUE(Eventually([&] { return run.AgentsOf("r2") != agents && run.AgentsOf("r2").size() == 1; }));
  run.ExpectRobots({"r0", "r1", "r2", "r3"});
  run.program().Interrupt();
}

TEST(RosHost, ARunInOneProcessHasTheProgramToo) {
  RosEditRun run(WorldPath("pen.world"), {"--paused", "--ros-services", "cyclone", "--in-process"});
  run.ExpectRobots({"r0", "r1", "r2", "r3"});
  EXPECT_EQ(run.participants(), 1u);
  const std::vector<pid_t> participants = ParticipantsOf(run.program());
  ASSERT_EQ(participants.size(), 1u);
  run.program().Interrupt();
  EXPECT_TRUE(IsGoneSoon(participants.front()));
}

TEST(RosHost, ItsProgramsEndWithALauncherThatIsKilled) {
  RosEditRun run(WorldPath("pen.world"), {"--speed", "1"});
  std::vector<pid_t> programs = ParticipantsOf(run.program());
  ASSERT_EQ(programs.size(), 1u);
  for (const pid_t side : ChildrenOf(programs.front())) programs.push_back(side);
  EXPECT_EQ(programs.size(), ros::HasFastDds() ? 2u : 1u);
  run.program().Signal(SIGKILL);
  run.program().Wait();
  for (const pid_t program : programs) EXPECT_TRUE(IsGoneSoon(program));
}

// The programs of a run that are started by hand find the participant of their session, or start it.
TEST(RosHost, ProgramsThatAreStartedByHandShareOne) {
  const std::string session = TestSession("by-hand");
  const std::vector<std::string> common = Words("% % --ros --ros-interface=lo --ros-services=cyclone %",
                                                {"--session=" + session, "--domain=" + std::to_string(TestDomain()),
                                                 "--ros-domain=" + std::to_string(TestRosNetwork().domain)});
  RosGraph graph;
  std::vector<Program> programs;
  const auto start = [&](std::vector<std::string> command) {
    command.insert(command.end(), common.begin(), common.end());
    programs.emplace_back(std::move(command));
  };
  for (const char* robot : {"r0", "r1", "r2", "r3"}) {
    start({ProgramPath("robot-agent"), "--robot", robot});
  }
  start({ProgramPath("world-service"), WorldPath("pen.world"), "--speed", "1"});
  const std::vector<std::string> nodes = {"/r0/robot", "/r1/robot", "/r2/robot", "/r3/robot", "/world"};
  EXPECT_TRUE(Eventually([&] { return graph.Nodes() == nodes; })) << testing::PrintToString(graph.Nodes());
  EXPECT_EQ(graph.Participants(), 1u);
  programs.back().Signal(SIGINT);
  for (Program& program : programs) program.Wait();
  EXPECT_TRUE(Eventually([&] { return graph.Participants() == 0u; })) << "it ends with the last of them";
}

TEST(RosHost, ANetworkThatCannotBeUsedEndsTheRun) {
  for (const char* mode : {"--headless", "--in-process"}) {
    const Finished run = Finish(RunPen({"--ticks", "5", "--ros", "--ros-interface", "none0", mode}));
    EXPECT_NE(run.exit_status, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("network interface 'none0'"));
  }
}

// Drives r0 by commands that are acknowledged before each step; returns the hashes.
std::string CommandAndStep(const std::string& mode) {
  const TemporaryFolder folder;
  ros::RosParticipant participant(TestRosNetwork());
  dds::Topic<ros::TwistMessage> topic(participant.participant(), "rt/r0/cmd_vel");
  dds::DataWriter<ros::TwistMessage> commands(participant.publisher(), topic, ros::ToDds(ros::Stream(1)));
  StepClient step(participant, "/world/step_simulation");
  Program run = RunPen({"--paused", "--hash-log", folder.Path("hashes"), "--ros", "--ros-interface", "lo",
                        "--ros-domain", std::to_string(TestRosNetwork().domain), "--ros-reliable-commands", mode});
  EXPECT_TRUE(Eventually([&] { return commands.publication_matched_status().current_count > 0; }));
  for (int i = 0; i < 8; ++i) {
    ros::TwistMessage twist{};
    twist.linear.x = 0.05 * (i % 11);
    twist.angular.z = 0.3 * (i % 5) - 0.6;
    commands.write(twist);
    EXPECT_TRUE(commands.wait_for_acknowledgments(20.0));
    StepBy(step, 1);
  }
  run.Interrupt();
  return folder.Read("hashes");
}

TEST(RosHost, ACommandThatIsAcknowledgedCountsFromTheNextStepOn) {
  const std::string expected = CommandAndStep("--in-process");
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(CommandAndStep("--headless"), expected);
}

// The stamp of the last odometry of a run of 150 ticks of 0.1 s, long enough for the reader to be discovered. The run
// has sent it when it ends; the thread of the reader may still have to receive it.
double LastStamp(const std::string& mode) {
  ros::RosParticipant participant(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(participant, "/", "tester");
  ros::RosReader<ros::OdometryMessage> odometry(node, "/r3/odom", ros::Stream(1000));
  OutputOf(RunPen({"--ticks", "150", "--speed", "10", "--ros", "--ros-interface", "lo", "--ros-domain",
                   std::to_string(TestRosNetwork().domain), mode}));
  double last = 0.0;
  Eventually([&] {
    odometry.Drain([&](const ros::OdometryMessage& message) {
      last = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec;
    });
    return last > 14.85;
  });
  return last;
}

TEST(RosHost, TheSamplesOfTheLastTicksArrive) {
  EXPECT_NEAR(LastStamp("--in-process"), 14.95, 0.06);
  EXPECT_NEAR(LastStamp("--headless"), 14.95, 0.06);
}

// A tool that reads many topics, in a process of its own, which the test kills: this program again, with this test
// alone.
TEST(RosHostTool, DISABLED_ReadsUntilItIsKilled) {
  const char* const domain = std::getenv("TOOL_DOMAIN");
  ASSERT_NE(domain, nullptr);
  ros::RosNetwork network = TestRosNetwork();
  network.domain = static_cast<std::uint32_t>(std::stoul(domain));
  ros::RosParticipant participant(network);
  const ros::RosNode node = ros::MakeNode(participant, "/", "tool");
  std::vector<std::unique_ptr<ros::RosReader<ros::OdometryMessage>>> readers;
  for (const std::string robot : {"/r0", "/r1", "/r2", "/r3"}) {
    for (const std::string topic : {"/odom", "/ground_truth"}) {
      readers.push_back(std::make_unique<ros::RosReader<ros::OdometryMessage>>(node, robot + topic, ros::Stream(10)));
    }
  }
  for (const auto& reader : readers) ExpectMessages(*reader);
  std::puts("reads all topics");
  std::fflush(stdout);
  for (;;) pause();
}

// Its readers acknowledge no sample any more, and for the 10 s of its lease the run cannot know that it has ended. Each
// of the eight writers would wait 1 s for it, beyond the time after which the program is killed.
TEST(RosHost, EndsInOrderAfterAToolThatWasKilled) {
  const std::string session = TestSession("killed-tool");
  const auto tick = [&] { return CallRun(session, control::GetStatus()).tick; };
  Program run = RunPen(RosArguments({"--session", session, "--speed", "1", "--ros-services", "cyclone"}));
  Program tool({"/usr/bin/env", "TOOL_DOMAIN=" + std::to_string(TestRosNetwork().domain),
                std::filesystem::read_symlink("/proc/self/exe").string(), "--gtest_also_run_disabled_tests",
                "--gtest_filter=RosHostTool.DISABLED_ReadsUntilItIsKilled"});
  tool.WaitForLine("reads all topics");
  tool.Signal(SIGKILL);
  tool.Wait();
  const Tick killed_at = tick();
  EXPECT_TRUE(Eventually([&] { return tick() > killed_at + 1; }));  // samples of all topics that it does not read
  run.Interrupt();
  EXPECT_THAT(run.output(), Not(HasSubstr("did not end in time")));
}

// Those of one machine share it; the world service is on the host of the launcher.
TEST(RosHost, HostsHaveTheirOwnParticipants) {
  const TemporaryFolder folder;
  std::ofstream(folder.Path("scenario.json")) << R"({"world": ")" << WorldPath("pen.world") << R"(", "hosts": [
        {"name": "first", "address": "127.0.0.1", "start": "{command}"},
        {"name": "second", "address": "127.0.0.1", "start": "{command}", "robots": ["r1", "r3"]}]})";
  RosEditRun run(folder.Path("scenario.json"), {"--speed", "1", "--interface", "lo", "--ros-services", "cyclone"});
  run.ExpectRobots({"r0", "r1", "r2", "r3"});
  EXPECT_EQ(run.participants(), 2u);
  run.End();
}

}  // namespace
}  // namespace troupe::test
