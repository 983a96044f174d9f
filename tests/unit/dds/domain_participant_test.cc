#include "transport/dds/binding/domain_participant.h"

#include <gtest/gtest.h>

#include "tests/support/dds_domain.h"
#include "tests/unit/dds/keyed_status_type.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"

namespace troupe::dds {
namespace {

using test::Eventually;
using test::TestConfig;

TEST(DomainParticipantTest, NamesTheFaultOfADomain) {
  DomainConfig config = TestConfig();
  config.domain = 231;
  try {
    DomainParticipant participant(config);
    FAIL() << "expected an exception";
  } catch (const Exception& exception) {
    EXPECT_EQ(DDS_RETCODE_BAD_PARAMETER, exception.code());
    EXPECT_NE(std::string::npos, std::string(exception.what()).find("domain 231"));
    EXPECT_NE(std::string::npos, std::string(exception.what()).find("0 to 230"));
  }
}

TEST(DomainParticipantTest, NamesANetworkInterfaceThatDoesNotExist) {
  DomainConfig config = TestConfig();
  config.network_interface = "no-such-\"<&$interface";
  try {
    DomainParticipant participant(config);
    FAIL() << "expected an exception";
  } catch (const Exception& exception) {
    EXPECT_NE(std::string::npos, std::string(exception.what()).find(config.network_interface));
  }
}

TEST(DomainParticipantTest, SeveralInOneProcessMatchOverTheNetwork) {
  const DomainParticipant here(TestConfig());
  const DomainParticipant there(TestConfig());
  const Qos session = Qos() << Partition{test::TestSession("meet")};
  const Publisher publisher(here, session);
  const Subscriber subscriber(there, session);
  const Topic<troupe_test_KeyedStatus> topic_here(here, "test/meet");
  const Topic<troupe_test_KeyedStatus> topic_there(there, "test/meet");
  const DataWriter<troupe_test_KeyedStatus> writer(publisher, topic_here, Qos());
  const DataReader<troupe_test_KeyedStatus> reader(subscriber, topic_there, Qos());
  EXPECT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count == 1; }));
  EXPECT_TRUE(Eventually([&] { return reader.subscription_matched_status().current_count == 1; }));
}

TEST(DomainParticipantTest, WithoutMulticastFindsItsPeerByPort) {
  DomainConfig known = TestConfig();
  known.discovery_multicast = false;
  known.participant_index = 50;
  DomainConfig searching = TestConfig();
  searching.discovery_multicast = false;
  searching.peers = {"127.0.0.1:" + std::to_string(DiscoveryPort(known.domain, 50))};
  const DomainParticipant here(known);
  const DomainParticipant there(searching);
  const Topic<troupe_test_KeyedStatus> topic_here(here, "test/peer");
  const Topic<troupe_test_KeyedStatus> topic_there(there, "test/peer");
  const Publisher publisher(here);
  const Subscriber subscriber(there);
  const DataWriter<troupe_test_KeyedStatus> writer(publisher, topic_here, Qos());
  const DataReader<troupe_test_KeyedStatus> reader(subscriber, topic_there, Qos());
  EXPECT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count == 1; }));
}

TEST(DomainConfigTest, DiscoveryPortsFollowTheStandard) {
  EXPECT_EQ(7410, DiscoveryPort(0, 0));
  EXPECT_EQ(7412, DiscoveryPort(0, 1));
  EXPECT_EQ(7400 + 250 * 42 + 10 + 2 * 7, DiscoveryPort(42, 7));
}

TEST(DomainConfigTest, TheProfileSuitsTheInterfaceUnlessOneIsAskedFor) {
  DomainConfig config;
  EXPECT_EQ("one-host", NetworkProfile(config));
  config.network_interface = "eth0";
  EXPECT_EQ("lan", NetworkProfile(config));
  EXPECT_NE(std::string::npos, ToXml(config).find("<FragmentSize>1344B"));
  config.network = "unicast";
  EXPECT_EQ("unicast", NetworkProfile(config));
  EXPECT_NE(std::string::npos, ToXml(config).find("<AllowMulticast>false<"));
}

TEST(DomainConfigTest, AnInterfaceIsNamedOrAddressed) {
  DomainConfig config;
  EXPECT_NE(std::string::npos, ToXml(config).find("<NetworkInterface name=\"lo\" multicast"));
  config.network_interface = "10.0.0.5";
  EXPECT_NE(std::string::npos, ToXml(config).find("<NetworkInterface address=\"10.0.0.5\"/>"));
  config.network_interface = "auto";
  EXPECT_NE(std::string::npos, ToXml(config).find("<NetworkInterface autodetermine=\"true\"/>"));
}

TEST(DomainConfigTest, EveryProfileIsGoodForCyclone) {
  for (const char* profile : {"one-host", "lan", "unicast"}) {
    DomainConfig config = TestConfig();
    config.network = profile;
    EXPECT_NO_THROW(DomainParticipant participant(config)) << profile;
    EXPECT_EQ(std::string::npos, ToXml(config).find('@')) << profile;
  }
}

TEST(DomainConfigTest, TextFromUsersStaysInsideItsAttribute) {
  DomainConfig config;
  config.peers = {"host\"/><Evil a=\"<&"};
  const std::string xml = ToXml(config);
  EXPECT_EQ(std::string::npos, xml.find("<Evil"));
  EXPECT_NE(std::string::npos, xml.find("host&quot;/>&lt;Evil a=&quot;&lt;&amp;"));
}

}  // namespace
}  // namespace troupe::dds
