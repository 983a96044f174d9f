// Participants of Troupe and tools, each with the configuration of a distribution of ROS 2, discover each other on this
// machine. They do so on a network of this test's own where that is possible.
#include "ros/connection/ros_network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "tests/support/dds_domain.h"
#include "tests/support/own_network.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_tool.h"
#include "transport/dds/binding/entity.h"

namespace troupe {
namespace {

using ros::DiscoveryRange;
using ros::Distribution;
using test::Eventually;
using test::RosTool;
using testing::Contains;
using testing::Not;

ros::RosNetwork Options(Distribution distribution, DiscoveryRange range) {
  ros::RosNetwork options = test::TestRosNetwork();
  options.network_interface = "auto";
  options.distribution = distribution;
  options.discovery = range;
  return options;
}

// A participant that writes one topic.
class Announcer {
 public:
  Announcer(const ros::RosNetwork& options, const std::string& topic)
      : participant_(options), writer_(ros::MakeNode(participant_, "/", "speaker"), topic, ros::Latched()) {}

 private:
  ros::RosParticipant participant_;
  ros::RosWriter<ros::Bool> writer_;
};

struct Range {
  Distribution distribution;
  const char* tool_xml;
};

class Localhost : public testing::TestWithParam<Range> {
 protected:
  static void SetUpTestSuite() { test::HasNetworkOfItsOwn(); }

  static bool Finds(RosTool& tool, const std::vector<std::string>& topics) {
    return Eventually([&] { return tool.Topics() == std::set<std::string>(topics.begin(), topics.end()); });
  }
  ros::RosNetwork options_ = Options(GetParam().distribution, DiscoveryRange::kLocalhost);
};

TEST_P(Localhost, AnEarlyToolFindsAParticipant) {
  RosTool early(options_.domain, GetParam().tool_xml);
  const Announcer speaker(options_, "/topic");
  EXPECT_TRUE(Finds(early, {"/topic"}));
}

TEST_P(Localhost, ALateToolFindsAParticipant) {
  const Announcer speaker(options_, "/topic");
  RosTool late(options_.domain, GetParam().tool_xml);
  EXPECT_TRUE(Finds(late, {"/topic"}));
}

// Tools have a limited number of participant indices, of which Troupe must leave some.
TEST_P(Localhost, ToolsFindAllOfManyParticipants) {
  std::vector<std::unique_ptr<Announcer>> speakers;
  std::vector<std::string> topics;
  for (int i = 0; i < 20; ++i) {
    topics.push_back("/topic" + std::to_string(i));
    speakers.push_back(std::make_unique<Announcer>(options_, topics.back()));
  }
  RosTool tool(options_.domain, GetParam().tool_xml);
  EXPECT_TRUE(Finds(tool, topics)) << testing::PrintToString(tool.Topics());
}

INSTANTIATE_TEST_SUITE_P(Distributions, Localhost,
                         testing::Values(Range{Distribution::kHumble, test::kHumbleLocalhost},
                                         Range{Distribution::kJazzy, test::kJazzyLocalhost}),
                         [](const auto& range) { return NameOf(range.param.distribution); });

TEST(RosNetwork, OffHidesAParticipant) {
  test::HasNetworkOfItsOwn();
  const Announcer hidden(Options(Distribution::kJazzy, DiscoveryRange::kOff), "/hidden");
  const Announcer seen(Options(Distribution::kJazzy, DiscoveryRange::kLocalhost), "/seen");
  RosTool tool(test::TestRosNetwork().domain, test::kJazzyLocalhost);
  EXPECT_TRUE(Eventually([&] { return tool.Topics().contains("/seen"); }));
  EXPECT_THAT(tool.Topics(), Not(Contains("/hidden")));
}

TEST(RosNetwork, StaticPeersAreFoundWithoutMulticastUnlessTheRangeIgnoresThem) {
  if (!test::HasNetworkOfItsOwn()) GTEST_SKIP() << "needs root, and a kernel with network namespaces and veth";
  ros::RosNetwork options = Options(Distribution::kJazzy, DiscoveryRange::kSystemDefault);
  options.static_peers = {"10.77.0.1"};
  const Announcer ignoring(options, "/ignoring");
  options.discovery = DiscoveryRange::kSubnet;
  const Announcer searching(options, "/searching");
  RosTool tool(options.domain, test::kJazzySubnetWithoutMulticast);
  EXPECT_TRUE(Eventually([&] { return tool.Topics().contains("/searching"); }));
  EXPECT_THAT(tool.Topics(), Not(Contains("/ignoring")));
}

TEST(RosNetwork, AStaticPeerWithoutAnAddressIsAnError) {
  ros::RosNetwork options = Options(Distribution::kJazzy, DiscoveryRange::kSubnet);
  options.static_peers = {"no such host"};
  try {
    ros::NetworkConfig(options);
    FAIL() << "expected an exception";
  } catch (const dds::Exception& exception) {
    EXPECT_THAT(exception.what(), testing::HasSubstr("static peer 'no such host'"));
  }
}

TEST(RosNetwork, MulticastOfOneMachineStaysThere) {
  for (const Distribution distribution : {Distribution::kHumble, Distribution::kJazzy}) {
    const std::string xml = ToXml(ros::NetworkConfig(Options(distribution, DiscoveryRange::kLocalhost)));
    EXPECT_THAT(xml, testing::HasSubstr("<MulticastTimeToLive>0<"));
    EXPECT_THAT(xml, testing::HasSubstr("<NetworkInterface name=\"lo\" multicast=\"true\"/>"));
  }
}

}  // namespace
}  // namespace troupe
