// Whole runs, seen from a ROS domain: what is published is what the run writes to its files, and looking changes
// nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <set>
#include <sstream>

#include "common/dds/wire.h"
#include "common/ros_dds/ros_endpoints.h"
#include "common/ros_dds/ros_qos.h"
#include "tests/process/output_folder.h"
#include "tests/process/programs.h"
#include "tests/process/run_files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"

namespace troupe::test {
namespace {

constexpr std::int64_t kIntervalNs = 100'000'000;  // of pen.world

Tick TickOf(const ros::Time& stamp) {
  return static_cast<Tick>((stamp.sec * std::int64_t{1'000'000'000} + stamp.nanosec) / kIntervalNs);
}

std::vector<std::string> RosArguments(std::vector<std::string> more) {
  const ros::RosOptions options = TestRosOptions();
  std::vector<std::string> arguments = {"--ros", "--ros-interface", "lo", "--ros-domain",
                                        std::to_string(options.domain)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// Reads r0's and r1's topics while a program runs, keeping by tick what came.
class Reader {
 public:
  void Drain() {
    for (Robot& robot : robots_) {
      robot.truth.Drain([&](const ros::OdometryMessage& message) {
        const auto& position = message.pose.pose.position;
        const auto& turn = message.pose.pose.orientation;
        robot.poses[TickOf(message.header.stamp)] = {position.x, position.y, position.z,
                                                     2.0 * std::atan2(turn.z, turn.w)};
      });
      robot.scan.Drain([&](const ros::LaserScan& scan) {
        const auto ranges = dds::Elements(scan.ranges);
        robot.scans[TickOf(scan.header.stamp)] = {ranges.begin(), ranges.end()};
      });
    }
    clock_.Drain([&](const ros::Clock& clock) { clocks_.push_back(TickOf(clock.clock)); });
  }

  struct Robot {
    Robot(const ros::RosNode& node, const std::string& robot_name)
        : name(robot_name),
          truth(node, "/" + name + "/ground_truth", ros::Stream(1000)),
          scan(node, "/" + name + "/scan", ros::Stream(1000)) {}
    std::string name;
    ros::RosReader<ros::OdometryMessage> truth;
    ros::RosReader<ros::LaserScan> scan;
    std::map<Tick, Pose> poses;
    std::map<Tick, std::vector<float>> scans;
  };
  const std::vector<Robot>& robots() const { return robots_; }
  const std::vector<Tick>& clocks() const { return clocks_; }

 private:
  std::vector<Robot> MakeRobots() {
    std::vector<Robot> robots;
    for (const char* name : {"r0", "r1"}) robots.emplace_back(node_, name);
    return robots;
  }

  ros::RosParticipant participant_{TestRosOptions()};
  ros::RosNode node_ = ros::MakeNode(participant_, "/", "reader");
  std::vector<Robot> robots_ = MakeRobots();
  ros::RosReader<ros::Clock> clock_{node_, "/clock", ros::Stream(1000)};
  std::vector<Tick> clocks_;
};

TEST(RosRun, PublishesWhatTheRunWritesToItsFilesAndChangesNothing) {
  OutputFolder folder;
  Reader reader;
  Program run = RunPen(RosArguments({"--ticks", "300", "--speed", "10", "--poses", folder.Path("poses"), "--scans",
                                     folder.Path("scans"), "--hash-log", folder.Path("hashes")}));
  ASSERT_EQ(run.Wait(), 0) << run.output();
  reader.Drain();
  const auto poses = ReadPoses(folder.Read("poses"));
  const auto scans = ReadScans(folder.Read("scans"));
  for (const Reader::Robot& robot : reader.robots()) {
    EXPECT_GT(robot.poses.size(), 100u);
    EXPECT_GT(robot.scans.size(), 100u);
    for (const auto& [tick, pose] : robot.poses) {
      const auto& logged = poses.at({tick, robot.name});
      ASSERT_EQ(pose.x, logged.X_WR.x);
      ASSERT_EQ(pose.y, logged.X_WR.y);
      ASSERT_EQ(pose.z, logged.X_WR.z);
      ASSERT_NEAR(pose.heading, logged.X_WR.heading, 1e-12);
    }
    for (const auto& [tick, ranges] : robot.scans) {
      const std::vector<double>& logged = scans.at({tick, robot.name, "ranger:1.0"});
      ASSERT_EQ(ranges, std::vector<float>(logged.begin(), logged.end()));
    }
  }
  EXPECT_GT(reader.clocks().size(), 100u);
  EXPECT_TRUE(std::is_sorted(reader.clocks().begin(), reader.clocks().end()));
  EXPECT_EQ(reader.clocks().back(), 300u);

  OutputFolder without;
  Finished plain = Finish(RunPen({"--no-ros", "--ticks", "300", "--hash-log", without.Path("hashes")}));
  ASSERT_EQ(plain.exit_status, 0) << plain.output;
  EXPECT_EQ(folder.Read("hashes"), without.Read("hashes"));
}

// Drives r0 by hand, stepping from a pause, and returns the hash after each step.
std::vector<std::string> StepByService(int steps) {
  OutputFolder folder;
  ros::RosParticipant participant(TestRosOptions());
  const ros::RosNode node = ros::MakeNode(participant, "/", "tester");
  ros::RosReader<ros::LaserScan> scans(node, "/r0/scan", ros::Stream(1000));
  Client<simulation_interfaces_srv_dds__StepSimulation_Request_,
         simulation_interfaces_srv_dds__StepSimulation_Response_>
      step(participant, "/world/step_simulation");
  Program run = RunPen(RosArguments({"--paused", "--speed", "1", "--hash-log", folder.Path("hashes")}));
  std::set<Tick> seen;
  for (int i = 1; i <= steps; ++i) {
    simulation_interfaces_srv_dds__StepSimulation_Request_ request{};
    request.steps = 2;
    step.Call(request, [](const auto& response) { EXPECT_EQ(response.result.result, 1); });
    if (!seen.empty()) {
      // Written before the step returned, so it must only travel.
      EXPECT_TRUE(Eventually([&] {
        scans.Drain([&](const ros::LaserScan& scan) { seen.insert(TickOf(scan.header.stamp)); });
        return seen.contains(static_cast<Tick>(2 * i));
      }));
    }
    scans.Drain([&](const ros::LaserScan& scan) { seen.insert(TickOf(scan.header.stamp)); });
  }
  EXPECT_FALSE(seen.empty());
  Client<simulation_interfaces_srv_dds__GetSimulationState_Request_,
         simulation_interfaces_srv_dds__GetSimulationState_Response_>
      state(participant, "/world/get_simulation_state");
  state.Call({}, [](const auto& response) { EXPECT_EQ(response.state.state, 2) << "paused"; });
  Client<simulation_interfaces_srv_dds__GetEntities_Request_, simulation_interfaces_srv_dds__GetEntities_Response_>
      entities(participant, "/world/get_entities");
  entities.Call({}, [](const auto& response) {
    EXPECT_THAT(dds::Strings(response.entities), testing::ElementsAre("r0", "r1", "r2", "r3"));
  });
  run.Signal(SIGINT);
  EXPECT_EQ(run.Wait(), 130) << run.output();
  std::istringstream lines(folder.Read("hashes"));
  std::vector<std::string> hashes;
  for (std::string line; std::getline(lines, line);) hashes.push_back(line);
  return hashes;
}

TEST(RosRun, StepsByServiceWithTheSameHashesTwiceAndTheSensorDataOfEachStep) {
  const std::vector<std::string> first = StepByService(50);
  EXPECT_EQ(first.size(), 101u);
  EXPECT_EQ(StepByService(50), first);
}

TEST(RosRun, OpensNothingInTheRosDomainUnlessAsked) {
  ros::RosParticipant participant(TestRosOptions());
  const ros::RosNode node = ros::MakeNode(participant, "/", "reader");
  ros::RosReader<ros::Clock> clock(node, "/clock", ros::Stream(10));
  const std::string domain = std::to_string(TestRosOptions().domain);
  Finished run = Finish(RunPen({"--ros-interface", "lo", "--ros-domain", domain, "--ticks", "20", "--speed", "10"}));
  ASSERT_EQ(run.exit_status, 0) << run.output;
  clock.Drain([](const ros::Clock&) { FAIL() << "a clock without --ros"; });
}

}  // namespace
}  // namespace troupe::test
