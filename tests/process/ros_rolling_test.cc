// The services of simulation_interfaces in the layout of 2.x, as in a run with --ros-distro rolling, called by a
// client with layouts of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "ros/connection/topic_types.h"
#include "tests/process/programs.h"
#include "tests/process/rolling_requests.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"

TROUPE_RENAMED_DDS_TYPE(rolling_client_dds__SpawnEntity_Request_,
                        "simulation_interfaces::srv::dds_::SpawnEntity_Request_");
TROUPE_RENAMED_DDS_TYPE(rolling_client_dds__SetEntityState_Request_,
                        "simulation_interfaces::srv::dds_::SetEntityState_Request_");
TROUPE_RENAMED_DDS_TYPE(rolling_client_dds__GetSpawnables_Response_,
                        "simulation_interfaces::srv::dds_::GetSpawnables_Response_");
TROUPE_RENAMED_DDS_TYPE(rolling_client_dds__LoadWorld_Request_, "simulation_interfaces::srv::dds_::LoadWorld_Request_");
TROUPE_RENAMED_DDS_TYPE(rolling_client_dds__LoadWorld_Response_,
                        "simulation_interfaces::srv::dds_::LoadWorld_Response_");

namespace troupe::test {
namespace {

using testing::Pair;

constexpr std::uint8_t kUnsupported = 0;

rolling_client_dds__Pose_ RollingPoseAt(double x, double y) {
  return {{x, y, 0.0}, {0.0, 0.0, 0.6, 0.8}};
}

class RosRollingTest : public testing::Test {
 protected:
  void CheckSpawnables();
  void CheckSpawnAndPose();
  void CheckOnlyPosesAreSet();
  void CheckLoad();

  // The result, and the name of the entity.
  std::pair<int, std::string> Spawn(const char* name, const char* uri, const char* resource_string, double x,
                                    double y) {
    rolling_client_dds__SpawnEntity_Request_ request{};
    request.name = Text(name);
    request.entity_resource = {Text(uri), Text(resource_string)};
    request.entity_namespace = Text(name);
    request.initial_pose = {{{}, Text("map")}, RollingPoseAt(x, y)};
    std::pair<int, std::string> answer;
    spawn_.Call(request, [&](const auto& response) {
      answer = {response.result.result, dds::Text(response.entity_name)};
    });
    return answer;
  }
  std::uint8_t Set(const rolling_client_dds__SetEntityState_Request_& request) { return set_state_.ResultOf(request); }
  ros::PoseMessage PoseOf(const char* name) {
    simulation_interfaces_srv_dds__GetEntityState_Request_ request{};
    request.entity = Text(name);
    ros::PoseMessage pose{};
    get_state_.Call(request, [&](const auto& response) {
      EXPECT_EQ(response.result.result, kOk);
      EXPECT_EQ(dds::Text(response.state.header.frame_id), "map");
      pose = response.state.pose;
    });
    return pose;
  }

  ros::RosParticipant participant_{TestRosNetwork()};
  Client<rolling_client_dds__SpawnEntity_Request_, simulation_interfaces_srv_dds__SpawnEntity_Response_> spawn_{
      participant_, "/world/spawn_entity"};
  Client<rolling_client_dds__SetEntityState_Request_, simulation_interfaces_srv_dds__SetEntityState_Response_>
      set_state_{participant_, "/world/set_entity_state"};
  TROUPE_SIMULATION_CLIENT(GetEntityState) get_state_{participant_, "/world/get_entity_state"};
  Client<simulation_interfaces_srv_dds__GetSpawnables_Request_, rolling_client_dds__GetSpawnables_Response_>
      spawnables_{participant_, "/world/get_spawnables"};
  Client<rolling_client_dds__LoadWorld_Request_, rolling_client_dds__LoadWorld_Response_> load_{participant_,
                                                                                                "/world/load_world"};
};

void RosRollingTest::CheckSpawnables() {
  std::map<std::string, std::string> types;
  spawnables_.Call({}, [&](const auto& response) {
    EXPECT_EQ(response.result.result, kOk);
    EXPECT_EQ(dds::Text(response.result.error_message), "");
    for (const auto& spawnable : dds::Elements(response.spawnables)) {
      types[dds::Text(spawnable.entity_resource.uri)] = dds::Text(spawnable.description);
      EXPECT_EQ(dds::Text(spawnable.entity_resource.resource_string), "");
      EXPECT_EQ(spawnable.spawn_bounds.type, 0);
      EXPECT_EQ(spawnable.spawn_bounds.points._length, 0u);
    }
  });
  EXPECT_THAT(types, testing::IsSupersetOf({Pair("rover", "position"), Pair("wall", "model")}));
}

void RosRollingTest::CheckSpawnAndPose() {
  EXPECT_THAT(Spawn("late", "rover", "", 0.5, -2.0), Pair(kOk, "late"));
  EXPECT_THAT(Spawn("other", "", "<robot/>", 0.5, 2.0), Pair(103, "")) << "an unknown format";
  EXPECT_THAT(Spawn("other", "", "", 0.5, 2.0), Pair(104, "")) << "no resource";
  const ros::PoseMessage spawned = PoseOf("late");
  EXPECT_EQ(spawned.position.x, 0.5);
  EXPECT_EQ(spawned.position.y, -2.0);
  EXPECT_NEAR(spawned.orientation.z, 0.6, 1e-12);
  EXPECT_NEAR(spawned.orientation.w, 0.8, 1e-12);
}

void RosRollingTest::CheckOnlyPosesAreSet() {
  rolling_client_dds__SetEntityState_Request_ request{};
  request.entity = Text("late");
  request.state.header.frame_id = Text("map");
  request.state.pose = RollingPoseAt(1.0, -2.0);
  EXPECT_EQ(Set(request), kOk);
  EXPECT_EQ(PoseOf("late").position.x, 0.5) << "set_pose is false";
  request.state.twist.linear.x = 1.0;
  request.set_pose = true;
  EXPECT_EQ(Set(request), kOk) << "set_twist is false";
  EXPECT_EQ(PoseOf("late").position.x, 1.0);
  request.set_twist = true;
  EXPECT_EQ(Set(request), kOk) << "a twist that the drive can have";
  request.state.twist.linear.y = 1.0;
  EXPECT_EQ(Set(request), 4) << "its drive moves only forwards";
  request.state.twist.linear = {};
  EXPECT_EQ(Set(request), kOk) << "a twist of zero";
  request.set_acceleration = true;
  EXPECT_EQ(Set(request), kUnsupported);
  request.set_acceleration = false;
  request.entity = Text("missing");
  EXPECT_EQ(Set(request), kNotFound);
}

void RosRollingTest::CheckLoad() {
  const std::string pen = WorldPath("pen.world");
  rolling_client_dds__LoadWorld_Request_ load{};
  load_.Call(load, [](const auto& response) { EXPECT_EQ(response.result.result, 102) << "no resource"; });
  load.world_resource.resource_string = Text("<world/>");
  load_.Call(load, [](const auto& response) { EXPECT_EQ(response.result.result, 101) << "an unknown format"; });
  load.world_resource.uri = Text(pen.c_str());
  load_.Call(load, [&](const auto& response) {
    EXPECT_EQ(response.result.result, kOk) << dds::Text(response.result.error_message);
    EXPECT_EQ(dds::Text(response.world.name), "pen");
    EXPECT_EQ(dds::Text(response.world.world_resource.uri), pen);
    EXPECT_EQ(dds::Text(response.world.world_resource.resource_string), "");
    EXPECT_EQ(dds::Text(response.world.description), "");
    EXPECT_EQ(response.world.tags._length, 0u);
  });
}

TEST_F(RosRollingTest, AnswersInTheLayoutsOfTheSecondVersion) {
  const ros::RosNetwork options = TestRosNetwork();
  Program run = RunPen({"--paused", "--ros", "--ros-distro", "rolling", "--ros-interface", "lo", "--ros-domain",
                        std::to_string(options.domain)});
  run.WaitForLine("ready");

  CheckSpawnables();
  CheckSpawnAndPose();
  CheckOnlyPosesAreSet();
  CheckLoad();
  run.Interrupt();
}

}  // namespace
}  // namespace troupe::test
