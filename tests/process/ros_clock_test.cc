// The topics of a run in a pause, for nodes that start then; and simulated time between ticks.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "tests/process/programs.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"
#include "troupe/ids.h"

namespace troupe::test {
namespace {

std::int64_t Nanoseconds(const ros::Time& time) {
  return time.sec * std::int64_t{1'000'000'000} + time.nanosec;
}

// The stamp of the first message on a topic, in ticks.
template <typename T, typename StampOf>
void ExpectStamp(const ros::RosNode& node, const std::string& topic, Tick tick, const StampOf& stamp_of) {
  ros::RosReader<T> reader(node, topic, ros::Stream(1));
  std::optional<std::int64_t> stamp;
  EXPECT_TRUE(Eventually([&] {
    reader.Drain([&](const T& message) { stamp = Nanoseconds(stamp_of(message)); });
    return stamp.has_value();
  })) << topic;
  EXPECT_EQ(stamp.value_or(-1), static_cast<std::int64_t>(tick) * kIntervalNs) << topic;
}

TEST(RosClock, ANodeThatStartsInAPauseLearnsTheTimeAndSeesTheRobots) {
  Program run = RunPen(RosArguments({"--paused", "--speed", "1"}));
  {
    ros::RosParticipant stepper(TestRosNetwork());
    TROUPE_SIMULATION_CLIENT(StepSimulation) step(stepper, "/world/step_simulation");
    StepBy(step, 7);
  }
  ros::RosParticipant late(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(late, "/", "late");
  ExpectStamp<ros::Clock>(node, "/clock", 7, [](const auto& message) { return message.clock; });
  for (const char* robot : {"/r0", "/r3"}) {
    ExpectStamp<ros::OdometryMessage>(node, std::string(robot) + "/odom", 7,
                                      [](const auto& message) { return message.header.stamp; });
    ExpectStamp<ros::LaserScan>(node, std::string(robot) + "/scan", 7,
                                [](const auto& message) { return message.header.stamp; });
  }
  ros::RosReader<ros::TfMessage> transforms(node, "/tf", ros::Stream(100));
  std::set<std::string> frames;
  EXPECT_TRUE(Eventually([&] {
    transforms.Drain([&](const ros::TfMessage& message) {
      for (const auto& transform : dds::Elements(message.transforms)) frames.insert(transform.child_frame_id);
    });
    return frames.size() == 4;
  })) << testing::PrintToString(frames);
  run.Interrupt();
}

TEST(RosClock, AdvancesBetweenTicksIfAskedWithoutChangingTheRun) {
  TemporaryFolder folder;
  ros::RosParticipant participant(TestRosNetwork());
  ros::RosReader<ros::Clock> reader(ros::MakeNode(participant, "/", "reader"), "/clock", ros::Stream(10'000));
  Program run = RunPen(
      RosArguments({"--speed", "1", "--ros-clock-rate", "100", "--ticks", "30", "--hash-log", folder.Path("hashes")}));
  ASSERT_EQ(run.Wait(), 0) << run.output();
  std::vector<std::int64_t> times;
  reader.Drain([&](const ros::Clock& clock) { times.push_back(Nanoseconds(clock.clock)); });
  ASSERT_FALSE(times.empty());
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_EQ(times.back(), 30 * kIntervalNs);
  EXPECT_GT(std::set<std::int64_t>(times.begin(), times.end()).size(), 100u) << "of 30 ticks";

  TemporaryFolder without;
  OutputOf(RunPen({"--no-ros", "--ticks", "30", "--hash-log", without.Path("hashes")}));
  EXPECT_EQ(folder.Read("hashes"), without.Read("hashes"));
}

}  // namespace
}  // namespace troupe::test
