#include "ros/service_bridge/service_directory.h"

#include <gtest/gtest.h>

namespace troupe::ros {
namespace {

Guid Endpoint(std::uint8_t number, bool is_reader) {
  Guid guid{};
  guid[0] = number;
  guid[15] = is_reader ? 0x04 : 0x03;
  return guid;
}

TEST(ServiceDirectory, NamesTheServiceOfATopic) {
  EXPECT_EQ(ServiceOfTopic("rq/anna/resetRequest"), "anna/reset");
  EXPECT_EQ(ServiceOfTopic("rr/anna/resetReply"), "anna/reset");
  for (const char* topic : {"rt/anna/odom", "rq/anna/resetReply", "rr/anna/resetRequest", "rq/Request", "rq/", ""}) {
    EXPECT_EQ(ServiceOfTopic(topic), std::nullopt) << topic;
  }
}

TEST(ServiceDirectory, AServiceHasAReaderAndAWriter) {
  ServiceDirectory directory;
  EXPECT_EQ(directory.Add(Endpoint(1, true), {"rq/resetRequest", "Request", "a"}), "reset");
  EXPECT_FALSE(directory.Find("reset"));
  EXPECT_EQ(directory.Add(Endpoint(2, false), {"rr/resetReply", "Response", "b"}), "reset");
  const std::optional<BridgedService> service = directory.Find("reset");
  ASSERT_TRUE(service);
  EXPECT_EQ(service->request.type, "Request");
  EXPECT_EQ(service->response.topic, "rr/resetReply");
  EXPECT_EQ(service->response.user_data, "b");
  EXPECT_EQ(directory.Remove(Endpoint(1, true)), "reset");
  EXPECT_FALSE(directory.Find("reset"));
  EXPECT_EQ(directory.Remove(Endpoint(1, true)), std::nullopt);
}

TEST(ServiceDirectory, TheNewestEndpointsCountWhileOldOnesAreThere) {
  ServiceDirectory directory;
  directory.Add(Endpoint(1, true), {"rq/resetRequest", "Old", ""});
  directory.Add(Endpoint(2, false), {"rr/resetReply", "Old", ""});
  directory.Add(Endpoint(3, true), {"rq/resetRequest", "New", ""});
  directory.Add(Endpoint(4, false), {"rr/resetReply", "New", ""});
  ASSERT_TRUE(directory.Find("reset"));
  EXPECT_EQ(directory.Find("reset")->request.type, "New");
  directory.Remove(Endpoint(1, true));
  directory.Remove(Endpoint(2, false));
  ASSERT_TRUE(directory.Find("reset"));
  EXPECT_EQ(directory.Find("reset")->response.type, "New");
}

// The writers of requests and readers of responses: other bridges of the run.
TEST(ServiceDirectory, EndpointsOfClientsAreNoService) {
  ServiceDirectory directory;
  EXPECT_EQ(directory.Add(Endpoint(1, false), {"rq/resetRequest", "Request", ""}), std::nullopt);
  EXPECT_EQ(directory.Add(Endpoint(2, true), {"rr/resetReply", "Response", ""}), std::nullopt);
  EXPECT_EQ(directory.Add(Endpoint(3, true), {"rt/odom", "Odometry", ""}), std::nullopt);
  EXPECT_FALSE(directory.Find("reset"));
}

}  // namespace
}  // namespace troupe::ros
