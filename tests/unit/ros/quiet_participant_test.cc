// Quiet participants on a network of this test's own: the loopback interface would deliver all their announcements.
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/discovery_relay.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/ros_qos.h"
#include "tests/support/dds_domain.h"
#include "tests/support/own_network.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/binding/wire.h"

namespace troupe {
namespace {

// Announces its name and records the names that it has discovered.
class Speaker {
 public:
  Speaker(std::string name, bool quiet) : Speaker(std::move(name), OptionsFor(quiet)) {}
  Speaker(std::string name, const ros::RosOptions& options)
      : participant_(options),
        writer_(ros::MakeNode(participant_, "/", name), "/names", ros::Latched()),
        reader_(ros::MakeNode(participant_, "/", name), "/names", ros::Latched(10)) {
    writer_.Write({name.data()});
  }
  const std::set<std::string>& heard() {
    reader_.Drain([&](const ros::String& message) { heard_.insert(dds::Text(message.data)); });
    return heard_;
  }

 private:
  static ros::RosOptions OptionsFor(bool quiet) {
    ros::RosOptions options = test::TestRosOptions();
    options.network_interface = "net0";
    options.quiet = quiet;
    return options;
  }

  ros::RosParticipant participant_;
  ros::RosWriter<ros::String> writer_;
  ros::RosReader<ros::String> reader_;
  std::set<std::string> heard_;
};

TEST(QuietParticipant, DiscoversToolsButNoOtherQuietOnes) {
  if (!test::HasNetworkOfItsOwn()) GTEST_SKIP() << "needs root, and a kernel with network namespaces and veth";
  Speaker early("early", false);
  Speaker robot("robot", true);
  Speaker other("other", true);
  Speaker late("late", false);
  const std::set<std::string> all = {"early", "robot", "other", "late"};
  for (Speaker* tool : {&early, &late}) {
    EXPECT_TRUE(test::Eventually([&] { return tool->heard() == all; })) << testing::PrintToString(tool->heard());
  }
  for (Speaker* quiet : {&robot, &other}) {
    EXPECT_TRUE(test::Eventually([&] { return quiet->heard().size() == 3; }));
    EXPECT_FALSE(quiet->heard().contains(quiet == &robot ? "other" : "robot"));
  }
}

ros::RosOptions OnLoopback(std::uint16_t relay_port = 0) {
  ros::RosOptions options = test::TestRosOptions();
  options.quiet = relay_port != 0;
  options.relay_port = relay_port;
  return options;
}

TEST(DiscoveryRelay, LetsToolsAndAgentsDiscoverEachOtherOnTheLoopbackInterface) {
  const ros::RosOptions options = OnLoopback();
  const ros::DiscoveryRelay relay(options.domain, ros::IndicesSearched(options.distribution));
  Speaker early("early", options);
  Speaker robot("robot", OnLoopback(relay.port()));
  Speaker other("other", OnLoopback(relay.port()));
  Speaker late("late", options);
  const std::set<std::string> all = {"early", "robot", "other", "late"};
  for (Speaker* tool : {&early, &late}) {
    EXPECT_TRUE(test::Eventually([&] { return tool->heard() == all; })) << testing::PrintToString(tool->heard());
  }
  for (Speaker* quiet : {&robot, &other}) {
    EXPECT_TRUE(test::Eventually([&] { return quiet->heard().size() == 3; }));
    EXPECT_FALSE(quiet->heard().contains(quiet == &robot ? "other" : "robot"));
  }
}

}  // namespace
}  // namespace troupe
