// The services of simulation_interfaces about worlds, infos, bounds, named poses and several entities, called as
// rmw_cyclonedds does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/convert.h"
#include "tests/process/programs.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"

namespace troupe::test {
namespace {

using testing::ElementsAre;

geometry_msgs_msg_dds__PoseStamped_ PoseAt(double x, double y) {
  geometry_msgs_msg_dds__PoseStamped_ pose{};
  pose.header.frame_id = Text("map");
  pose.pose = ros::ToMessage(Pose{x, y, 0.0, 0.0});
  return pose;
}

class RosInterfaces : public testing::Test {
 protected:
  RosInterfaces() {
    std::ofstream(folder_.Path("place.json"))
        << R"({"world": ")" << WorldPath("pen.world") << R"(", "name": "placed", "places": [)"
        << R"({"name": "dock", "pose": [1, 2, 90], "description": "the charger", "tags": ["charger", "start"]},)"
        << R"({"name": "door", "pose": [-1, 0, 0], "tags": ["start"]}]})";
    std::vector<std::string> arguments =
        Words("run % --headless --session % --domain % --paused --ros --ros-interface lo --ros-domain %",
              {folder_.Path("place.json"), TestSession("interfaces"), std::to_string(TestDomain()),
               std::to_string(TestRosNetwork().domain)});
    run_.emplace(Troupe(std::move(arguments)));
    run_->WaitForLine(", ready");
  }
  ~RosInterfaces() override { run_->Interrupt(); }

  std::vector<std::string> PoseNames(const std::vector<std::string>& tags, std::uint8_t mode) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetNamedPoses_Request_ request{};
    arena.FillStrings(request.tags.tags, tags);
    request.tags.filter_mode = mode;
    std::vector<std::string> names;
    poses_.Call(request, [&](const auto& response) {
      EXPECT_EQ(response.result.result, kOk);
      for (const auto& pose : dds::Elements(response.poses)) names.emplace_back(pose.name);
    });
    return names;
  }
  std::vector<std::string> Entities(const simulation_interfaces_msg_dds__EntityFilters_& filters) {
    simulation_interfaces_srv_dds__GetEntities_Request_ request{};
    request.filters = filters;
    std::vector<std::string> names;
    entities_.Call(request, [&](const auto& response) {
      EXPECT_EQ(response.result.result, kOk) << response.result.error_message;
      names = dds::Strings(response.entities);
    });
    return names;
  }
  std::uint8_t SetInfo(const char* entity, const std::vector<std::string>& tags) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__SetEntityInfo_Request_ request{};
    request.entity = Text(entity);
    request.info.category.category = 1;
    request.info.description = Text("a scout");
    arena.FillStrings(request.info.tags, tags);
    return set_info_.ResultOf(request);
  }
  int CurrentWorld(std::string* name = nullptr, std::string* uri = nullptr) {
    int result = 0;
    world_.Call({}, [&](const auto& response) {
      result = response.result.result;
      if (name != nullptr) *name = dds::Text(response.world.name);
      if (uri != nullptr) *uri = dds::Text(response.world.world_resource.uri);
    });
    return result;
  }
  int State() {
    int state = 0;
    state_.Call({}, [&](const auto& response) { state = response.state.state; });
    return state;
  }
  int Unload() { return unload_.ResultOf({}); }
  int LoadText(const std::string& text) {
    simulation_interfaces_srv_dds__LoadWorld_Request_ request{};
    request.resource_string = Text(text.c_str());
    return load_.ResultOf(request);
  }
  int SetTwist(const char* entity, double vx, double vy) {
    simulation_interfaces_srv_dds__SetEntityState_Request_ request{};
    request.entity = Text(entity);
    request.state.header.frame_id = Text("map");
    request.state.pose = ros::ToMessage(Pose{-2.0, -2.0, 0.0, 0.0});
    request.state.twist.linear.x = vx;
    request.state.twist.linear.y = vy;
    return set_state_.ResultOf(request);
  }

  TemporaryFolder folder_;
  ros::RosParticipant participant_{TestRosNetwork()};
  TROUPE_SIMULATION_CLIENT(GetCurrentWorld) world_{participant_, "/world/get_current_world"};
  TROUPE_SIMULATION_CLIENT(GetAvailableWorlds) worlds_{participant_, "/world/get_available_worlds"};
  TROUPE_SIMULATION_CLIENT(UnloadWorld) unload_{participant_, "/world/unload_world"};
  TROUPE_SIMULATION_CLIENT(LoadWorld) load_{participant_, "/world/load_world"};
  TROUPE_SIMULATION_CLIENT(GetNamedPoses) poses_{participant_, "/world/get_named_poses"};
  TROUPE_SIMULATION_CLIENT(GetEntityBounds) bounds_{participant_, "/world/get_entity_bounds"};
  TROUPE_SIMULATION_CLIENT(GetEntities) entities_{participant_, "/world/get_entities"};
  TROUPE_SIMULATION_CLIENT(GetEntityState) get_state_{participant_, "/world/get_entity_state"};
  TROUPE_SIMULATION_CLIENT(SetEntityState) set_state_{participant_, "/world/set_entity_state"};
  TROUPE_SIMULATION_CLIENT(SetEntityInfo) set_info_{participant_, "/world/set_entity_info"};
  TROUPE_SIMULATION_CLIENT(GetEntityInfo) info_{participant_, "/world/get_entity_info"};
  TROUPE_SIMULATION_CLIENT(SpawnEntities) spawn_{participant_, "/world/spawn_entities"};
  TROUPE_SIMULATION_CLIENT(GetSimulationState) state_{participant_, "/world/get_simulation_state"};
  std::optional<Program> run_;
};

TEST_F(RosInterfaces, NamesPosesWithTheirTags) {
  EXPECT_THAT(PoseNames({}, 0), ElementsAre("dock", "door"));
  EXPECT_THAT(PoseNames({"charger"}, 0), ElementsAre("dock"));
  EXPECT_THAT(PoseNames({"charger", "start"}, 1), ElementsAre("dock"));
  EXPECT_THAT(PoseNames({"lift"}, 0), ElementsAre());
  poses_.Call({}, [](const auto& response) {
    const auto& dock = response.poses._buffer[0];
    EXPECT_STREQ(dock.description, "the charger");
    EXPECT_EQ(dock.pose.position.y, 2.0);
    EXPECT_NEAR(dock.pose.orientation.z, std::sqrt(0.5), 1e-12);
  });
}

TEST_F(RosInterfaces, FiltersEntitiesByTagsAndBounds) {
  EXPECT_EQ(SetInfo("r1", {"red"}), kOk);
  EXPECT_EQ(SetInfo("r2", {"red", "fast"}), kOk);
  EXPECT_EQ(SetInfo("missing", {"red"}), kNotFound);
  dds::WireArena arena;
  simulation_interfaces_msg_dds__EntityFilters_ filters{};
  arena.FillStrings(filters.tags.tags, {"red"});
  EXPECT_THAT(Entities(filters), ElementsAre("r1", "r2"));
  arena.FillStrings(filters.tags.tags, {"red", "fast"});
  filters.tags.filter_mode = 1;
  EXPECT_THAT(Entities(filters), ElementsAre("r2"));
  simulation_interfaces_srv_dds__GetEntityInfo_Request_ request{};
  request.entity = Text("r2");
  info_.Call(request, [](const auto& response) {
    EXPECT_STREQ(response.info.description, "a scout");
    EXPECT_THAT(dds::Strings(response.info.tags), ElementsAre("red", "fast"));
  });
  simulation_interfaces_msg_dds__EntityFilters_ near{};
  near.bounds.type = 3;  // a sphere
  auto* points = arena.Fill(near.bounds.points, 2);
  points[0] = {2.0, 2.0, 0.0};
  points[1].x = 0.5;
  EXPECT_THAT(Entities(near), ElementsAre("r2"));
}

TEST_F(RosInterfaces, ReportsTheBoxOfAnEntity) {
  simulation_interfaces_srv_dds__GetEntityBounds_Request_ request{};
  request.entity = Text("north");
  bounds_.Call(request, [](const auto& response) {
    EXPECT_EQ(response.result.result, kOk);
    EXPECT_EQ(response.bounds.type, 1) << "a box";
    ASSERT_EQ(response.bounds.points._length, 2u);
    const auto& upper = response.bounds.points._buffer[0];
    const auto& lower = response.bounds.points._buffer[1];
    EXPECT_NEAR(upper.x, 3.2, 1e-9);
    EXPECT_NEAR(lower.x, -3.2, 1e-9);
    EXPECT_NEAR(upper.z, 0.6, 1e-9);
    EXPECT_NEAR(lower.z, 0.0, 1e-9);
  });
  request.entity = Text("missing");
  bounds_.Call(request, [](const auto& response) { EXPECT_EQ(response.result.result, kNotFound); });
}

TEST_F(RosInterfaces, SpawnsSeveralEntitiesFromNamesAndTexts) {
  ros::RosReader<ros::OdometryMessage> odom(ros::MakeNode(participant_, "/", "reader"), "/fleet/one/odom",
                                            ros::Stream(10));
  const std::string text = "define probe position ( size [0.2 0.2 0.2] )\nprobe ( name \"probe\" )\n";
  dds::WireArena arena;
  simulation_interfaces_srv_dds__SpawnEntities_Request_ request{};
  auto* order = arena.Fill(request.spawn_requests, 5);
  order[0] = {Text("one"), false, {Text("rover"), Text("")}, Text("/fleet/one"), PoseAt(0.0, -2.0)};
  order[1] = {Text("two"), false, {Text(""), Text(text.c_str())}, Text(""), PoseAt(0.0, 2.0)};
  order[2] = {Text("three"), false, {Text("rover"), Text("")}, Text("//"), PoseAt(1.0, 2.0)};
  order[3] = {Text("four"), false, {Text(""), Text("position (\n")}, Text(""), PoseAt(1.0, 2.0)};
  order[4] = {Text(""), false, {Text("rover"), Text("")}, Text(""), PoseAt(1.0, 2.0)};
  spawn_.Call(request, [](const auto& response) {
    EXPECT_EQ(response.result.result, 150) << "some failed";
    ASSERT_EQ(response.results._length, 5u);
    const auto results = dds::Elements(response.results);
    EXPECT_EQ(results[0].result.result, kOk) << results[0].result.error_message;
    EXPECT_STREQ(results[0].entity_name, "one");
    EXPECT_EQ(results[1].result.result, kOk) << results[1].result.error_message;
    EXPECT_EQ(results[2].result.result, 105) << "an invalid namespace";
    EXPECT_EQ(results[3].result.result, 106) << "a text that cannot be parsed";
    EXPECT_EQ(results[4].result.result, 102) << "no name, and no renaming";
  });
  EXPECT_THAT(Entities({}), testing::IsSupersetOf({"one", "two"}));
  EXPECT_TRUE(Eventually([&] {
    bool received = false;
    odom.Drain([&](const ros::OdometryMessage& message) {
      EXPECT_STREQ(message.child_frame_id, "fleet/one/base_link");
      received = true;
    });
    return received;
  })) << "the robot has its topics below its namespace";
}

TEST_F(RosInterfaces, SetsTheTwistThatADriveCanHave) {
  EXPECT_EQ(SetTwist("r0", 0.5, 0.0), kOk);
  // It is an input of the next tick.
  OutputOf(Troupe(Words("ctl step --session % --domain %", {TestSession("interfaces"), std::to_string(TestDomain())})));
  simulation_interfaces_srv_dds__GetEntityState_Request_ request{};
  request.entity = Text("r0");
  get_state_.Call(request, [](const auto& response) { EXPECT_EQ(response.state.twist.linear.x, 0.5); });
  EXPECT_EQ(SetTwist("r0", 0.0, 0.5), kFailed) << "a differential drive moves only forwards";
  EXPECT_EQ(SetTwist("r0", 1e6, 0.0), kFailed) << "beyond its bounds";
}

TEST_F(RosInterfaces, UnloadsAndLoadsWorlds) {
  std::string name;
  std::string uri;
  EXPECT_EQ(CurrentWorld(&name, &uri), kOk);
  EXPECT_EQ(name, "placed");
  EXPECT_EQ(uri, folder_.Path("place.json"));
  worlds_.Call({}, [&](const auto& response) {
    EXPECT_EQ(response.result.result, kOk);
    std::vector<std::string> uris;
    for (const auto& world : dds::Elements(response.worlds)) uris.emplace_back(world.world_resource.uri);
    EXPECT_THAT(uris, testing::Contains(folder_.Path("place.json")));
  });
  dds::WireArena arena;
  simulation_interfaces_srv_dds__GetAvailableWorlds_Request_ more{};
  arena.FillStrings(more.additional_sources, {"/proc"});
  worlds_.Call(more, [](const auto& response) { EXPECT_EQ(response.result.result, kFailed) << "not allowed"; });
  more.continue_on_error = true;
  worlds_.Call(more, [](const auto& response) { EXPECT_EQ(response.result.result, kOk); });

  EXPECT_EQ(Unload(), kOk);
  EXPECT_EQ(State(), 4) << "no world";
  EXPECT_EQ(Unload(), 101);
  EXPECT_EQ(CurrentWorld(), 101);
  EXPECT_THAT(Entities({}), ElementsAre());
  EXPECT_EQ(LoadText("<sdf/>"), 101) << "an unknown format";
  EXPECT_EQ(LoadText("position (\n"), 103) << "a text that cannot be parsed";
  EXPECT_EQ(LoadText("name \"typed\"\nposition ( name \"only\" size [0.4 0.4 0.4] )\n"), kOk);
  EXPECT_EQ(CurrentWorld(&name, &uri), kOk);
  EXPECT_EQ(name, "typed");
  EXPECT_EQ(uri, "");
  EXPECT_THAT(Entities({}), ElementsAre("only"));
}

}  // namespace
}  // namespace troupe::test
