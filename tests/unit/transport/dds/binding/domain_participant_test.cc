#include "transport/dds/binding/domain_participant.h"

#include <dds/ddsrt/log.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/dds_domain.h"
#include "tests/unit/transport/dds/binding/keyed_status_type.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/network_log.h"
#include "transport/dds/convert/convert.h"

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

TEST(ExceptionTest, NamesTheReturnCodeAndTheOperation) {
  const Exception exception(DDS_RETCODE_TIMEOUT, "writing a sample");
  EXPECT_STREQ("DDS: Timeout while writing a sample", exception.what());
  EXPECT_EQ(DDS_RETCODE_TIMEOUT, exception.code());
}

TEST(CheckTest, ReturnsEveryOtherResult) {
  EXPECT_EQ(0, Check(DDS_RETCODE_OK, "nothing"));
  EXPECT_EQ(7, Check(7, "counting"));
}

TEST(CheckTest, ThrowsFailures) {
  EXPECT_THROW(Check(DDS_RETCODE_BAD_PARAMETER, "trying"), Exception);
}

void Complain(int number) {
  dds_log(DDS_LC_WARNING, "file", 1, "function", "sample %d is malformed\n", number);
}

TEST(NetworkLog, ReportsALineUnchanged) {
  std::vector<std::string> lines;
  {
    const NetworkLog log([&](const std::string& line) { lines.push_back(line); });
    Complain(7);
  }
  EXPECT_THAT(lines, testing::ElementsAre("network: sample 7 is malformed"));
}

TEST(NetworkLog, CountsAFloodAndReportsItsFirstLines) {
  std::vector<std::string> lines;
  std::uint64_t counted = 0;
  constexpr int kFlood = 100'000;
  {
    const NetworkLog log([&](const std::string& line) {
      lines.push_back(line);
      const bool sum = line.find(" more lines like these") != std::string::npos;
      counted += sum ? std::stoull(line.substr(std::string("network: ").size())) : 1;
    });
    for (int i = 0; i < kFlood; ++i) Complain(i);
  }
  EXPECT_EQ(counted, kFlood);
  EXPECT_LT(lines.size(), kFlood / 100);
}

using JoinSample = troupe_wire_Join;  // keyed by `agent`

JoinSample Make(std::uint64_t agent) {
  static char empty[] = "";
  JoinSample sample{};
  sample.agent = agent;
  sample.host = empty;
  return sample;
}

class ListenerTest : public testing::Test {
 protected:
  ListenerTest()
      : session_(test::TestSession(testing::UnitTest::GetInstance()->current_test_info()->name())),
        publisher_(here_, Qos() << Partition{session_}),
        subscriber_(there_, Qos() << Partition{session_}) {}

  std::string session_;
  DomainParticipant here_{test::TestConfig()};
  DomainParticipant there_{test::TestConfig()};
  Publisher publisher_;
  Subscriber subscriber_;
  Topic<JoinSample> topic_here_{here_, "test/join"};
  Topic<JoinSample> topic_there_{there_, "test/join"};
  Qos qos_ = Qos() << Reliability::Reliable(1.0) << History::KeepAll();
};

TEST_F(ListenerTest, HearsOfDataAndOfPartners) {
  std::atomic<int> taken = 0;
  std::atomic<int> publications = 0;
  std::atomic<int> subscriptions = 0;
  DataReader<JoinSample> reader(subscriber_, topic_there_, qos_);
  DataReaderListener hears;
  hears.on_data_available = [&] { taken += static_cast<int>(reader.take().length()); };
  hears.on_subscription_matched = [&](const SubscriptionMatchedStatus& status) {
    publications += status.current_count_change;
  };
  reader.set_listener(hears);
  std::optional<DataWriter<JoinSample>> writer(std::in_place, publisher_, topic_here_, qos_);
  DataWriterListener writers;
  writers.on_publication_matched = [&](const PublicationMatchedStatus& status) {
    subscriptions += status.current_count_change;
  };
  writer->set_listener(writers);
  ASSERT_TRUE(Eventually([&] { return publications == 1; }));
  ASSERT_TRUE(Eventually([&] { return writer->publication_matched_status().current_count == 1; }));
  writer->write(Make(1));
  writer->write(Make(2));
  EXPECT_TRUE(Eventually([&] { return taken == 2; }));
  writer.reset();
  EXPECT_TRUE(Eventually([&] { return publications == 0; }));
}

TEST_F(ListenerTest, AnExceptionIsReportedAndTheNextCallIsStillMade) {
  std::atomic<int> calls = 0;
  std::atomic<int> exceptions = 0;
  DataReader<JoinSample> reader(subscriber_, topic_there_, qos_);
  DataReaderListener listener;
  listener.on_data_available = [&] {
    reader.take();
    ++calls;
    throw std::runtime_error("on purpose");
  };
  listener.on_exception = [&](std::exception_ptr exception) {
    try {
      std::rethrow_exception(exception);
    } catch (const std::runtime_error& error) {
      if (std::string(error.what()) == "on purpose") ++exceptions;
    }
  };
  reader.set_listener(listener);
  DataWriter<JoinSample> writer(publisher_, topic_here_, qos_);
  ASSERT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count == 1; }));
  writer.write(Make(1));
  ASSERT_TRUE(Eventually([&] { return exceptions == 1; }));
  writer.write(Make(2));
  EXPECT_TRUE(Eventually([&] { return exceptions == 2; }));
  EXPECT_EQ(2, calls);
}

TEST_F(ListenerTest, AThrowingExceptionHandlerDoesNoHarmEither) {
  std::atomic<int> calls = 0;
  DataReader<JoinSample> reader(subscriber_, topic_there_, qos_);
  DataReaderListener listener;
  listener.on_data_available = [&] {
    reader.take();
    ++calls;
    throw 42;
  };
  listener.on_exception = [](std::exception_ptr) { throw std::runtime_error("expected in the log of this test"); };
  reader.set_listener(listener);
  DataWriter<JoinSample> writer(publisher_, topic_here_, qos_);
  ASSERT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count == 1; }));
  writer.write(Make(1));
  ASSERT_TRUE(Eventually([&] { return calls == 1; }));
  writer.write(Make(2));
  EXPECT_TRUE(Eventually([&] { return calls == 2; }));
}

TEST_F(ListenerTest, ClearedItIsSilent) {
  std::atomic<int> calls = 0;
  DataReader<JoinSample> reader(subscriber_, topic_there_, qos_);
  DataReaderListener listener;
  listener.on_data_available = [&] { ++calls; };
  reader.set_listener(listener);
  reader.clear_listener();
  DataWriter<JoinSample> writer(publisher_, topic_here_, qos_);
  ASSERT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count == 1; }));
  writer.write(Make(1));
  ASSERT_TRUE(writer.wait_for_acknowledgments(10.0));
  EXPECT_EQ(1u, reader.take().length());
  EXPECT_EQ(0, calls);
}

// A ping is answered inside the listener that received it, a thousand times.
TEST_F(ListenerTest, MayWriteAndTake) {
  constexpr std::uint64_t kRounds = 1000;
  const Publisher back(there_, Qos() << Partition{session_ + "-back"});
  const Subscriber back_here(here_, Qos() << Partition{session_ + "-back"});
  DataWriter<JoinSample> ping(publisher_, topic_here_, qos_);
  DataReader<JoinSample> ping_reader(subscriber_, topic_there_, qos_);
  DataWriter<JoinSample> pong(back, topic_there_, qos_);
  DataReader<JoinSample> pong_reader(back_here, topic_here_, qos_);
  std::atomic<std::uint64_t> rounds = 0;
  DataReaderListener answers;
  answers.on_data_available = [&] {
    for (const auto& sample : ping_reader.take()) {
      if (sample.info().valid()) pong.write(Make(sample.data().agent));
    }
  };
  DataReaderListener asks;
  asks.on_data_available = [&] {
    for (const auto& sample : pong_reader.take()) {
      if (!sample.info().valid()) continue;
      rounds = sample.data().agent;
      if (rounds < kRounds) ping.write(Make(rounds + 1));
    }
  };
  ping_reader.set_listener(answers);
  pong_reader.set_listener(asks);
  for (const auto* writer : {&ping, &pong}) {
    ASSERT_TRUE(Eventually([&] { return writer->publication_matched_status().current_count == 1; }));
  }
  ASSERT_TRUE(Eventually([&] { return pong_reader.subscription_matched_status().current_count == 1; }));
  ping.write(Make(1));
  EXPECT_TRUE(Eventually([&] { return rounds == kRounds; }));
  ping_reader.clear_listener();
  pong_reader.clear_listener();
}

}  // namespace
}  // namespace troupe::dds
