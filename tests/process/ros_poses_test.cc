// RViz's goal pose and initial pose command robots of whole runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/messages/convert.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

// s. To a goal a robot drives for some simulated seconds.
constexpr double kDrive = 60.0;

std::uint32_t OwnDomain() {
  static const std::uint32_t domain = ReserveDomain();
  return domain;
}

// A tool of RViz: a writer with its QoS. It lives until its pose has had its effect, as RViz does: a reader that
// discovers a writer that has left already gets nothing.
template <typename T>
class PoseTool {
 public:
  PoseTool(std::uint32_t domain, const std::string& topic)
      : participant_(OptionsIn(domain)),
        node_(ros::MakeNode(participant_, "/", "rviz")),
        writer_(node_, topic, ros::Stream(5)) {}

  void Write(const char* frame, const Pose& pose) {
    ASSERT_TRUE(Eventually([&] { return writer_.wanted(); })) << "no reader";
    T message{};
    message.header.frame_id = const_cast<char*>(frame);
    if constexpr (std::is_same_v<T, geometry_msgs_msg_dds__PoseStamped_>) {
      message.pose = ros::ToMessage(pose);
    } else {
      message.pose.pose = ros::ToMessage(pose);
      message.pose.covariance[0] = 0.25;
    }
    writer_.Write(message);
  }

 private:
  static ros::RosNetwork OptionsIn(std::uint32_t domain) {
    ros::RosNetwork options = TestRosNetwork();
    options.domain = domain;
    return options;
  }

  ros::RosParticipant participant_;
  ros::RosNode node_;
  ros::RosWriter<T> writer_;
};
using GoalTool = PoseTool<geometry_msgs_msg_dds__PoseStamped_>;
using InitialPoseTool = PoseTool<geometry_msgs_msg_dds__PoseWithCovarianceStamped_>;

class RosPoses : public testing::Test {
 protected:
  RosPoses() {
    std::ofstream(folder_.Path("rooms.world")) << "define rover position ( size [0.4 0.4 0.3] localization \"gps\" )\n"
                                                  "rover ( name \"anna\" pose [0 0 0 0] ctrl \"go_to\" )\n"
                                                  "rover ( name \"bert\" pose [0 5 0 0] ctrl \"idle\" )\n"
                                                  "rover ( name \"cleo\" pose [0 10 0.2 0] ctrl \"go_to\" )\n";
    std::ofstream(folder_.Path("rooms.json"))
        << R"({"world": "rooms.world", "robots": [{"name": "cleo", "ros_domain": )" << OwnDomain() << "}]}";
  }
  void Start(const std::vector<std::string>& more) {
    run_.emplace(
        Troupe(Words("run % --headless --speed 20 --session % --domain % --ros --ros-interface lo --ros-domain %",
                     {folder_.Path("rooms.json"), session_, std::to_string(TestDomain()),
                      std::to_string(TestRosNetwork().domain)}) +
               more));
    run_->WaitForLine(", ready");
    ASSERT_TRUE(client_.WaitForService(kSeconds).ok()) << run_->output();
  }
  void TearDown() override { run_->Interrupt(); }

  Pose PoseOf(const std::string& robot) {
    control::Entities question{.name = robot};
    const Result<ControlReply> reply = client_.Call(question, kSeconds);
    if (!reply.ok() || reply.value().entities.size() != 1) {
      ADD_FAILURE() << run_->output();
      return {};
    }
    return reply.value().entities.front().X_WE;
  }
  bool Reaches(const std::string& robot, const Pose& goal) {
    return Eventually(
        [&] {
          const Pose pose = PoseOf(robot);
          return std::hypot(pose.x - goal.x, pose.y - goal.y) < 0.2 && std::abs(pose.heading - goal.heading) < 0.3;
        },
        kDrive);
  }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("poses");
  std::optional<Program> run_;
  ControlClient client_{NetworkOf(session_)};
};

TEST_F(RosPoses, AGoalPoseIsTheGoalOfAController) {
  Start({"--ros-rviz", "goal"});
  const std::uint32_t domain = TestRosNetwork().domain;
  const Pose goal{2.0, -1.0, 0.0, 1.0};
  GoalTool of_anna(domain, "/anna/goal_pose");
  of_anna.Write("map", goal);
  EXPECT_TRUE(Reaches("anna", goal)) << PoseOf("anna").x << " " << PoseOf("anna").y;
  // In the domain of a robot, with a plain name.
  const Pose other{-1.0, 9.0, 0.0, 0.5};
  GoalTool of_cleo(OwnDomain(), "/goal_pose");
  of_cleo.Write("", other);
  EXPECT_TRUE(Reaches("cleo", other)) << PoseOf("cleo").x << " " << PoseOf("cleo").y;
  // Refusals have a reason.
  GoalTool refused(domain, "/bert/goal_pose");
  refused.Write("map", goal);
  run_->WaitForLine("ROS: goal_pose of 'bert': the controller of 'bert' (idle) accepts no goals");
  refused.Write("bert/odom", goal);
  run_->WaitForLine("ROS: goal_pose of 'bert': found a pose in frame 'bert/odom', expected one in 'map'");
}

TEST_F(RosPoses, AnInitialPoseIsSetInTheWorld) {
  Start({"--ros-rviz", "pose"});
  const std::uint32_t domain = TestRosNetwork().domain;
  InitialPoseTool tool(domain, "/bert/initialpose");
  tool.Write("map", {3.0, 4.0, 0.0, -0.5});
  EXPECT_TRUE(Reaches("bert", {3.0, 4.0, 0.0, -0.5})) << run_->output();
  tool.Write("map", {0.0, 0.1, 0.0, 0.0});
  run_->WaitForLine("ROS: initialpose of 'bert': 'bert' would be inside 'anna'");
  // RViz says no height: that of the robot stays.
  InitialPoseTool of_cleo(OwnDomain(), "/initialpose");
  of_cleo.Write("map", {-3.0, 12.0, 0.0, 2.0});
  EXPECT_TRUE(Reaches("cleo", {-3.0, 12.0, 0.0, 2.0})) << run_->output();
  EXPECT_NEAR(PoseOf("cleo").z, 0.2, 1e-9);
}

TEST_F(RosPoses, TheTopicsFollowTheRobotsOfTheWorld) {
  Start({"--ros-rviz", "both"});
  const auto edit = [&](const control::Request& request) {
    const Result<ControlReply> reply = client_.Call(request, kSeconds);
    EXPECT_TRUE(reply.ok() && reply.value().done) << run_->output();
  };
  edit(control::Spawn{.source = "rover", .name = "late", .pose = {0.0, -5.0, 0.0, 0.0}});
  InitialPoseTool of_late(TestRosNetwork().domain, "/late/initialpose");
  of_late.Write("map", {1.0, -6.0, 0.0, 1.0});
  EXPECT_TRUE(Reaches("late", {1.0, -6.0, 0.0, 1.0})) << run_->output();
  edit(control::Delete{"cleo"});
  edit(control::Delete{"late"});
  InitialPoseTool of_anna(TestRosNetwork().domain, "/anna/initialpose");
  of_anna.Write("map", {1.0, -6.0, 0.0, 1.0});
  EXPECT_TRUE(Reaches("anna", {1.0, -6.0, 0.0, 1.0})) << run_->output();
}

}  // namespace
}  // namespace troupe::test
