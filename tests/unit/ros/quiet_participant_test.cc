// Quiet participants on a network of this test's own: the loopback interface would deliver all their announcements.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/discovery_relay.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/ros_qos.h"
#include "tests/support/announcement_message.h"
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

// A socket that agents of this test name as the place of their discovery.
class AgentSocket {
 public:
  AgentSocket() : handle_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)), address_(Loopback(0)) {
    socklen_t size = sizeof address_;
    EXPECT_EQ(bind(handle_, reinterpret_cast<const sockaddr*>(&address_), size), 0);
    EXPECT_EQ(getsockname(handle_, reinterpret_cast<sockaddr*>(&address_), &size), 0);
  }
  ~AgentSocket() { close(handle_); }
  AgentSocket(const AgentSocket&) = delete;
  AgentSocket& operator=(const AgentSocket&) = delete;

  // Announces agent `number` at this socket.
  void Announce(std::size_t number, const ros::DiscoveryRelay& relay) const {
    const auto low = static_cast<std::uint8_t>(number % 256);
    const auto high = static_cast<std::uint8_t>(number / 256);
    const std::vector<std::uint8_t> message =
        test::AnnouncementMessage({0xee, low, high, 3, 4, 5, 6, 7, 8, 9, 10, 11}, ntohs(address_.sin_port));
    const sockaddr_in to = Loopback(relay.port());
    EXPECT_GT(sendto(handle_, message.data(), message.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  // Whether an announcement of another participant comes within some seconds, 0: has come.
  bool Receives(double seconds) const {
    pollfd waited{handle_, POLLIN, 0};
    std::uint8_t byte = 0;
    return poll(&waited, 1, static_cast<int>(seconds * 1000.0)) == 1 && recv(handle_, &byte, sizeof byte, 0) > 0;
  }

 private:
  static sockaddr_in Loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    return address;
  }

  int handle_;
  sockaddr_in address_;
};

TEST(DiscoveryRelay, KnowsABoundedNumberOfAgents) {
  const ros::RosOptions options = OnLoopback();
  const ros::DiscoveryRelay relay(options.domain, ros::IndicesSearched(options.distribution));
  const Speaker tool("tool", options);
  const AgentSocket known;
  const AgentSocket moved;
  const AgentSocket surplus;
  // A new agent receives the announcement of the tool at once, if the relay has it.
  ASSERT_TRUE(test::Eventually([&] {
    moved.Announce(0, relay);
    known.Announce(0, relay);
    return known.Receives(0.1);
  }));
  for (std::size_t i = 1; i < ros::DiscoveryRelay::kMost; ++i) {
    known.Announce(i, relay);
    ASSERT_TRUE(known.Receives(10.0)) << i;
  }
  while (moved.Receives(0.0)) {
  }
  surplus.Announce(ros::DiscoveryRelay::kMost, relay);
  moved.Announce(0, relay);
  EXPECT_TRUE(moved.Receives(10.0)) << "an agent that is known has moved";
  EXPECT_FALSE(surplus.Receives(0.0));
}

}  // namespace
}  // namespace troupe
