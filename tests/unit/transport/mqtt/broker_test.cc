#include "transport/mqtt/broker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/files.h"
#include "transport/mqtt/mqtt_connections.h"

namespace troupe::mqtt {
namespace {

using testing::HasSubstr;

TEST(Broker, IsReadFromItsUrl) {
  const auto url_of = [](const std::string& url) { return ParseBrokerUrl(url).value().Url(); };
  EXPECT_EQ(url_of("mqtt://host"), "mqtt://host:1883");
  EXPECT_EQ(url_of("mqtts://host/"), "mqtts://host:8883");
  EXPECT_EQ(url_of("mqtt://10.0.0.5:99"), "mqtt://10.0.0.5:99");
  EXPECT_EQ(url_of("mqtt://[::1]"), "mqtt://[::1]:1883");
  EXPECT_EQ(url_of("mqtts://[fe80::1]:5"), "mqtts://[fe80::1]:5");
}

TEST(Broker, AWrongUrlIsAnErrorThatNamesTheFault) {
  const auto fault_of = [](const std::string& url) {
    const Result<Broker> broker = ParseBrokerUrl(url);
    return broker.ok() ? "" : broker.error().message;
  };
  EXPECT_THAT(fault_of("host"), HasSubstr("no scheme"));
  EXPECT_THAT(fault_of("http://host"), HasSubstr("no scheme"));
  EXPECT_THAT(fault_of("mqtt://"), HasSubstr("no host"));
  EXPECT_THAT(fault_of("mqtt://:5"), HasSubstr("no host"));
  EXPECT_THAT(fault_of("mqtt://host:"), HasSubstr("the port ''"));
  EXPECT_THAT(fault_of("mqtt://host:0"), HasSubstr("the port '0'"));
  EXPECT_THAT(fault_of("mqtt://host:65536"), HasSubstr("the port '65536'"));
  EXPECT_THAT(fault_of("mqtt://host:12x"), HasSubstr("the port '12x'"));
  EXPECT_THAT(fault_of("mqtt://host/path"), HasSubstr("a path"));
  EXPECT_THAT(fault_of("mqtt://me:secret@host"), HasSubstr("a user"));
  EXPECT_THAT(fault_of("mqtt://[::1"), HasSubstr("a bracket"));
  EXPECT_THAT(fault_of("mqtt://[::1]x"), HasSubstr("text behind"));
  EXPECT_THAT(fault_of("mqtt://a b"), HasSubstr("a blank"));
}

TEST(Broker, CredentialsAreTheFirstLineOfAFile) {
  const test::TemporaryFolder folder;
  Broker broker;
  ASSERT_TRUE(ReadCredentials(folder.Write("user", "anna:a:b\r\nmore\n"), broker).ok());
  EXPECT_EQ(broker.user, "anna");
  EXPECT_EQ(broker.password, "a:b");
  EXPECT_FALSE(ReadCredentials(folder.Write("none", ""), broker).ok());
  EXPECT_FALSE(ReadCredentials(folder.Write("wrong", "anna\n"), broker).ok());
  EXPECT_FALSE(ReadCredentials(folder.Path("missing"), broker).ok());
}

// Nothing listens on port 1 of this host.
TEST(Connections, AnUnreachableBrokerIsAnEventAndTriedAgain) {
  Connections connections({.host = "127.0.0.1", .port = 1});
  const std::size_t client = connections.Add({.id = "a"}).value();
  const std::vector<Event> events = connections.Wait(10.0);
  ASSERT_EQ(events.size(), 1U);
  const auto* const failed = std::get_if<Disconnected>(events.data());
  ASSERT_NE(failed, nullptr);
  EXPECT_EQ(failed->client, client);
  EXPECT_FALSE(failed->was_connected);
  EXPECT_THAT(failed->reason, HasSubstr("refused"));
  EXPECT_FALSE(connections.Publish(client, {"topic", "text"}));
  ASSERT_EQ(connections.Wait(10.0).size(), 1U);  // the second attempt, a second later
  connections.Close(1.0);
}

TEST(Connections, TopicsAndCertificatesAreChecked) {
  Connections connections({.host = "127.0.0.1", .port = 1});
  EXPECT_FALSE(connections.Add({.subscriptions = {"a/#/b"}}).ok());
  EXPECT_FALSE(connections.Add({.will = Message{"a/+", "x"}}).ok());
  Connections secured({.host = "127.0.0.1", .port = 1, .tls = true, .ca_file = "/no/such/file"});
  EXPECT_FALSE(secured.Add({}).ok());
}

}  // namespace
}  // namespace troupe::mqtt
