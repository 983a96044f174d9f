// What the tests of the gateway of robots to ROS share: robots, and an agent's replica with a ROS node across the
// network.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/agent/replica.h"
#include "robot-agent/ros/ros_gateway.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/messages/messages.h"
#include "tests/support/dds_domain.h"
#include "tests/support/gripper_world.h"
#include "tests/support/host_participant.h"
#include "tests/support/ros_domain.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "transport/dds/binding/wire.h"

namespace troupe::test {

// Robots a and b, each with a scanner of 5 rays and two sonars, on odometry.
inline WorldDescription TwoRobots() {
  SmallWorld world;
  for (const char* name : {"a", "b"}) {
    const RobotId robot = world.AddRobot(name, {name[0] == 'a' ? 0.0 : 3.0, 0.0, 0.0, 0.0});
    world.AddRanger(robot, {0.1, 0.0, 0.3, 0.0}, {Fan(1.0, 5)});
    world.AddRanger(robot, {0.0, 0.0, 0.2, 0.0}, {OneRay(), OneRay(4.0)});
    world.robot(robot).localization.type = LocalizationType::kOdometry;
    world.robot(robot).localization.origin = {1.0, 2.0, 0.0, 0.5};
  }
  return world.world();
}

// Robots a and b, each with a gripper on a lift and a scanner that the lift raises. The lift is at 0.25 m, and b's left
// finger has moved 0.05 m.
inline GripperWorld TwoGrippers() {
  GripperWorld world;
  for (const char* name : {"a", "b"}) {
    const GripperRobot parts = world.AddGripperRobot({name[0] == 'a' ? 0.0 : 3.0, 0.0, 0.0, 0.0});
    world.model(parts.root).name = world.world.robots.back().name = name;
    const char* names[] = {"gripper.lift", "gripper.left", "gripper.right"};
    for (const JointId joint : {parts.lift, parts.left, parts.right}) {
      world.world.joints[joint.index()].name = names[joint.index() % 3];
    }
    SensorDescription ranger{.name = "ranger:0",
                             .model = world.AddModel(std::vector<Block>(), {0.0, 0.0, 0.5, 0.0}, parts.carriage)};
    RaySensors(ranger) = {Fan(1.0, 5)};
    world.world.robots.back().sensors = {ranger};
  }
  return world;
}

// The user data of all endpoints that `discovered` announces, by topic.
inline std::map<std::string, std::string> UserDataOf(dds_entity_t participant, dds_entity_t discovered) {
  const dds::Entity endpoints(dds::Check(dds_create_reader(participant, discovered, nullptr, nullptr), "reading"));
  constexpr std::uint32_t kMaxEndpoints = 1000;
  std::vector<void*> samples(kMaxEndpoints, nullptr);
  std::vector<dds_sample_info_t> infos(kMaxEndpoints);
  std::map<std::string, std::string> all;
  const dds_return_t count = dds_read(endpoints.handle(), samples.data(), infos.data(), kMaxEndpoints, kMaxEndpoints);
  for (dds_return_t i = 0; i < count; ++i) {
    const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[static_cast<std::size_t>(i)]);
    void* bytes = nullptr;
    std::size_t size = 0;
    if (dds_qget_userdata(endpoint.qos, &bytes, &size) && bytes != nullptr) {
      all[endpoint.topic_name].assign(static_cast<const char*>(bytes), size);
      dds_free(bytes);
    } else {
      all[endpoint.topic_name] = "";
    }
  }
  if (count > 0) dds_return_loan(endpoints.handle(), samples.data(), count);
  return all;
}

// The parent of each frame.
inline std::map<std::string, std::string> ParentsOf(const ros::TfMessage& message) {
  std::map<std::string, std::string> parents;
  for (const ros::TransformStamped& transform : dds::Elements(message.transforms)) {
    EXPECT_TRUE(parents.emplace(transform.child_frame_id, transform.header.frame_id).second);
  }
  return parents;
}

inline ros::TwistMessage Twist2(double vx, double wz) {
  ros::TwistMessage twist{};
  twist.linear.x = vx;
  twist.angular.z = wz;
  return twist;
}

// RosGatewayFixture: a ROS node across the network, and an agent's replica that it exchanges messages with.
class RosGatewayFixture : public testing::Test {
 protected:
  void MakeReplica(ros::RosOptions options, const WorldDescription& world = TwoRobots()) {
    state_ = PlacedState(world);
    replica_.reset();
    host_.reset();
    options.socket = host_.emplace(options.network).socket();
    replica_ = ValueOf(Replica::Create(std::make_shared<const Scene>(world), {}, {}, {}, MakeRosGateway(options)));
  }

  ProposalMessage Tick() {
    const ProposalMessage answer = replica_->Decide(state_);
    replica_->Publish(state_);
    ++state_.tick;
    return answer;
  }

  template <typename T>
  ros::RosReader<T> Reader(const std::string& topic, bool latched = false) {
    return ros::RosReader<T>(peer_, topic, latched ? ros::Latched() : ros::Stream(100));
  }
  template <typename T>
  ros::RosWriter<T> Writer(const std::string& topic) {
    return ros::RosWriter<T>(peer_, topic, ros::Stream(1));
  }

  // Ticks until `reader` has received a message, and calls `check` with the last one.
  template <typename T, typename Check>
  void TickUntilReceived(ros::RosReader<T>& reader, const Check& check) {
    bool received = false;
    ASSERT_TRUE(Eventually([&] {
      Tick();
      reader.Drain([&](const T& message) {
        if (!received) check(message);
        received = true;
      });
      return received;
    }));
  }

  // The twist proposed for robot a after the command. The command is repeated, because a reader misses a sample written
  // before it has discovered the writer.
  template <typename T>
  Twist CommandUntilMoving(ros::RosWriter<T>& commands, const T& command) {
    Twist twist;
    EXPECT_TRUE(Eventually([&] {
      commands.Write(command);
      twist = Tick().proposals[0].twist;
      return !twist.IsZero();
    }));
    return twist;
  }

  ros::RosOptions options_ = {.network = TestRosNetwork()};
  ros::RosParticipant participant_{options_.network};
  ros::RosNode peer_ = ros::MakeNode(participant_, "/", "peer");
  WorldState state_;
  std::optional<HostParticipant> host_;
  std::unique_ptr<Replica> replica_;
};

}  // namespace troupe::test
