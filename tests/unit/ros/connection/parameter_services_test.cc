#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros/connection/node_services.h"
#include "ros/connection/type_descriptions.h"
#include "tests/support/host_participant.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"

namespace troupe::ros {
namespace {

using test::Client;
using testing::ElementsAre;

class ParameterServicesTest : public testing::Test {
 protected:
  test::HostParticipant host_;
  std::unique_ptr<HostConnection> server_ = host_.Connect();
  RosNode node_ = MakeNode(*server_, "/r0", "robot");
  ParameterServices services_{node_, "robot", {{"use_sim_time", true}, {"speed", 0.5}, {"who", "r0"}}};
  RosParticipant client_{test::TestRosNetwork()};
};

TEST_F(ParameterServicesTest, ListsAndGets) {
  Client<rcl_interfaces_srv_dds__ListParameters_Request_, rcl_interfaces_srv_dds__ListParameters_Response_> list(
      client_, "/r0/robot/list_parameters");
  list.Call({}, [](const auto& response) {
    EXPECT_THAT(dds::Strings(response.result.names), ElementsAre("speed", "use_sim_time", "who"));
  });
  Client<rcl_interfaces_srv_dds__GetParameters_Request_, rcl_interfaces_srv_dds__GetParameters_Response_> get(
      client_, "/r0/robot/get_parameters");
  dds::WireArena arena;
  rcl_interfaces_srv_dds__GetParameters_Request_ request{};
  arena.FillStrings(request.names, {"use_sim_time", "no_such", "who", "speed"});
  get.Call(request, [](const auto& response) {
    const auto values = dds::Elements(response.values);
    ASSERT_EQ(values.size(), 4u);
    EXPECT_EQ(values[0].type, 1);
    EXPECT_TRUE(values[0].bool_value);
    EXPECT_EQ(values[1].type, 0);
    EXPECT_EQ(values[2].type, 4);
    EXPECT_STREQ(values[2].string_value, "r0");
    EXPECT_EQ(values[3].type, 3);
    EXPECT_EQ(values[3].double_value, 0.5);
  });
}

TEST_F(ParameterServicesTest, DescribesAndListsTypes) {
  dds::WireArena arena;
  Client<rcl_interfaces_srv_dds__GetParameterTypes_Request_, rcl_interfaces_srv_dds__GetParameterTypes_Response_> types(
      client_, "/r0/robot/get_parameter_types");
  rcl_interfaces_srv_dds__GetParameterTypes_Request_ type_request{};
  arena.FillStrings(type_request.names, {"speed", "no_such"});
  types.Call(type_request, [](const auto& response) { EXPECT_THAT(dds::Elements(response.types), ElementsAre(3, 0)); });
  Client<rcl_interfaces_srv_dds__DescribeParameters_Request_, rcl_interfaces_srv_dds__DescribeParameters_Response_>
      describe(client_, "/r0/robot/describe_parameters");
  rcl_interfaces_srv_dds__DescribeParameters_Request_ request{};
  arena.FillStrings(request.names, {"who"});
  describe.Call(request, [](const auto& response) {
    ASSERT_EQ(response.descriptors._length, 1u);
    EXPECT_STREQ(response.descriptors._buffer[0].name, "who");
    EXPECT_TRUE(response.descriptors._buffer[0].read_only);
  });
}

TEST_F(ParameterServicesTest, RefusesChanges) {
  Client<rcl_interfaces_srv_dds__SetParameters_Request_, rcl_interfaces_srv_dds__SetParameters_Response_> set(
      client_, "/r0/robot/set_parameters");
  dds::WireArena arena;
  rcl_interfaces_srv_dds__SetParameters_Request_ request{};
  auto* parameter = arena.Fill(request.parameters, 3);
  parameter[0].name = arena.Copy("use_sim_time");
  parameter[0].value.type = 1;
  parameter[0].value.bool_value = true;
  parameter[1].name = arena.Copy("speed");
  parameter[1].value.type = 3;
  parameter[1].value.double_value = 9.0;
  parameter[2].name = arena.Copy("no_such");
  set.Call(request, [](const auto& response) {
    const auto results = dds::Elements(response.results);
    ASSERT_EQ(results.size(), 3u);
    EXPECT_TRUE(results[0].successful);
    EXPECT_FALSE(results[1].successful);
    EXPECT_STREQ(results[1].reason, "the parameter is read-only");
    EXPECT_STREQ(results[2].reason, "no such parameter");
  });
}

TEST_F(ParameterServicesTest, AnnouncesParametersThatAreSet) {
  const RosNode node = MakeNode(client_, "/", "peer");
  RosReader<rcl_interfaces_msg_dds__ParameterEvent_> events(node, "/parameter_events", Stream(100));
  Client<rcl_interfaces_srv_dds__SetParameters_Request_, rcl_interfaces_srv_dds__SetParameters_Response_> set(
      client_, "/r0/robot/set_parameters");
  dds::WireArena arena;
  rcl_interfaces_srv_dds__SetParameters_Request_ request{};
  auto* parameter = arena.Fill(request.parameters, 2);
  parameter[0].name = arena.Copy("use_sim_time");
  parameter[0].value.type = 1;
  parameter[0].value.bool_value = true;
  parameter[1].name = arena.Copy("no_such");
  std::vector<std::string> changed;
  EXPECT_TRUE(test::Eventually([&] {  // the writer of events may not have discovered its reader yet
    set.Call(request, [](const auto& response) { EXPECT_EQ(response.results._length, 2u); });
    events.Drain([&](const rcl_interfaces_msg_dds__ParameterEvent_& event) {
      EXPECT_STREQ(event.node, "/r0/robot");
      for (const auto& value : dds::Elements(event.changed_parameters)) changed.emplace_back(value.name);
    });
    return !changed.empty();
  }));
  EXPECT_EQ(changed.front(), "use_sim_time");
}

TEST_F(ParameterServicesTest, TypesAreDescribedFromJazzyOn) {
  const TypeDescriptionService service(node_, "robot");
  using Request = type_description_interfaces_srv_dds__GetTypeDescription_Request_;
  using Response = type_description_interfaces_srv_dds__GetTypeDescription_Response_;
  Client<Request, Response> describe(client_, "/r0/robot/get_type_description");
  dds::WireArena arena;
  Request request{};
  request.type_name = arena.Copy("sensor_msgs/msg/LaserScan");
  request.type_hash = arena.Copy(HashOfRosType("sensor_msgs/msg/LaserScan"));
  describe.Call(request, [](const Response& response) {
    EXPECT_TRUE(response.successful) << response.failure_reason;
    const auto& description = response.type_description;
    EXPECT_STREQ(description.type_description.type_name, "sensor_msgs/msg/LaserScan");
    EXPECT_EQ(description.type_description.fields._length, 10u);
    EXPECT_EQ(description.referenced_type_descriptions._length, 2u) << "header and time";
  });
  request.type_hash = arena.Copy("RIHS01_0");
  describe.Call(request, [](const Response& response) {
    EXPECT_FALSE(response.successful);
    EXPECT_THAT(response.failure_reason, testing::HasSubstr("found the hash 'RIHS01_0', expected RIHS01_"));
  });
  request.type_name = arena.Copy("x/msg/Y");
  describe.Call(request, [](const Response& response) { EXPECT_FALSE(response.successful); });
}

}  // namespace
}  // namespace troupe::ros
