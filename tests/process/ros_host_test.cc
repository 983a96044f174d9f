// Runs whose robots share a participant in ROS for each host, the program ros-participant.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "tests/process/output_folder.h"
#include "tests/process/programs.h"
#include "tests/process/ros_edit_run.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;
using StepClient = Client<simulation_interfaces_srv_dds__StepSimulation_Request_,
                          simulation_interfaces_srv_dds__StepSimulation_Response_>;

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

TEST(RosHost, RobotsShareOneParticipantAndReturnWhenItIsKilled) {
  RosEditRun run(WorldPath("pen.world"), {"--speed", "1", "--ros-services", "cyclone", "--ros-participants", "host"});
  const std::vector<std::string> robots = {"r0", "r1", "r2", "r3"};
  run.ExpectRobots(robots);
  EXPECT_EQ(run.participants(), 2u) << "that of the world, and that of the robots";
  ros::RosParticipant participant(TestRosOptions());
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
  EXPECT_THAT(run.program().output(), HasSubstr("the ROS participant of the robots (process "));
  EXPECT_THAT(run.program().output(), HasSubstr("was killed by signal 9 (Killed); it is started again"));
  for (const pid_t process : participants) EXPECT_TRUE(IsGoneSoon(process));
}

TEST(RosHost, EditsAndLostAgentsChangeTheGraph) {
  RosEditRun run(WorldPath("pen.world"), {"--paused", "--ros-participants", "host"});
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
  run.program().Signal(SIGINT);
  EXPECT_EQ(run.program().Wait(), 130);
}

// More than ten processes share a participant by default.
TEST(RosHost, IsTheDefaultOfManyProcesses) {
  const OutputFolder folder;
  std::ofstream file(folder.Path("fleet.world"));
  file << "define rover position ( size [0.4 0.4 0.3] )\n";
  for (int i = 0; i < 12; ++i) file << "rover ( name \"r" << i << "\" pose [" << i << " 0 0 0] )\n";
  file.close();
  std::vector<std::string> robots;
  for (int i = 0; i < 12; ++i) robots.push_back("r" + std::to_string(i));
  RosEditRun run(folder.Path("fleet.world"), {"--paused", "--ros-services", "cyclone"});
  run.ExpectRobots(robots);
  EXPECT_EQ(run.participants(), 2u);
  EXPECT_EQ(ParticipantsOf(run.program()).size(), 1u);
  run.End();
}

// Drives r0 by commands that are acknowledged before each step; returns the hashes.
std::string CommandAndStep(const std::string& participants) {
  const OutputFolder folder;
  ros::RosParticipant participant(TestRosOptions());
  dds::Topic<ros::TwistMessage> topic(participant.participant(), "rt/r0/cmd_vel");
  dds::DataWriter<ros::TwistMessage> commands(participant.publisher(), topic, ros::ToDds(ros::Stream(1)));
  StepClient step(participant, "/world/step_simulation");
  Program run =
      RunPen({"--paused", "--hash-log", folder.Path("hashes"), "--ros", "--ros-interface", "lo", "--ros-domain",
              std::to_string(TestRosOptions().domain), "--ros-reliable-commands", "--ros-participants", participants});
  EXPECT_TRUE(Eventually([&] { return commands.publication_matched_status().current_count > 0; }));
  for (int i = 0; i < 8; ++i) {
    ros::TwistMessage twist{};
    twist.linear.x = 0.05 * (i % 11);
    twist.angular.z = 0.3 * (i % 5) - 0.6;
    commands.write(twist);
    EXPECT_TRUE(commands.wait_for_acknowledgments(20.0));
    simulation_interfaces_srv_dds__StepSimulation_Request_ request{};
    request.steps = 1;
    step.Call(request, [](const auto& response) { EXPECT_EQ(response.result.result, 1); });
  }
  run.Signal(SIGINT);
  EXPECT_EQ(run.Wait(), 130) << run.output();
  return folder.Read("hashes");
}

TEST(RosHost, ACommandThatIsAcknowledgedCountsFromTheNextStepOn) {
  const std::string expected = CommandAndStep("process");
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(CommandAndStep("host"), expected);
}

// The stamp of the last odometry of a run of 30 ticks of 0.1 s.
double LastStamp(const std::string& participants) {
  ros::RosParticipant participant(TestRosOptions());
  const ros::RosNode node = ros::MakeNode(participant, "/", "tester");
  ros::RosReader<ros::OdometryMessage> odometry(node, "/r3/odom", ros::Stream(1000));
  Finished run = Finish(RunPen({"--ticks", "30", "--speed", "10", "--ros", "--ros-interface", "lo", "--ros-domain",
                                std::to_string(TestRosOptions().domain), "--ros-participants", participants}));
  EXPECT_EQ(run.exit_status, 0) << run.output;
  double last = 0.0;
  odometry.Drain([&](const ros::OdometryMessage& message) {
    last = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec;
  });
  return last;
}

TEST(RosHost, TheSamplesOfTheLastTicksArrive) {
  EXPECT_NEAR(LastStamp("process"), 2.95, 0.06);
  EXPECT_NEAR(LastStamp("host"), 2.95, 0.06);
}

TEST(RosHost, EachHostHasAParticipant) {
  const OutputFolder folder;
  std::ofstream(folder.Path("scenario.json")) << R"({"world": ")" << WorldPath("pen.world") << R"(", "hosts": [
        {"name": "first", "address": "127.0.0.1", "start": "{command}"},
        {"name": "second", "address": "127.0.0.1", "start": "{command}", "robots": ["r1", "r3"]}]})";
  RosEditRun run(folder.Path("scenario.json"),
                 {"--speed", "1", "--interface", "lo", "--ros-services", "cyclone", "--ros-participants", "host"});
  run.ExpectRobots({"r0", "r1", "r2", "r3"});
  EXPECT_EQ(run.participants(), 3u) << "that of the world, and one of each host";
  run.End();
}

}  // namespace
}  // namespace troupe::test
