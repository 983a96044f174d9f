#include <gtest/gtest.h>

#include <thread>

#include "tests/support/dds_domain.h"
#include "tests/unit/dds/keyed_status_type.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"

namespace troupe::dds {
namespace {

using test::Eventually;
using Sample = troupe_test_KeyedStatus;

TEST(WaitSetTest, ReturnsNoConditionAfterTheTimeout) {
  const DomainParticipant participant(test::TestConfig());
  const GuardCondition guard(participant);
  WaitSet waits(participant);
  waits.attach(guard, 1);
  EXPECT_TRUE(waits.wait(0.0).empty());
}

TEST(WaitSetTest, AGuardConditionWakesAnotherThread) {
  const DomainParticipant participant(test::TestConfig());
  GuardCondition guard(participant);
  const GuardCondition other(participant);
  WaitSet waits(participant);
  waits.attach(guard, 7);
  waits.attach(other, 8);
  std::thread waker([&] { guard.trigger_value(true); });
  EXPECT_EQ(std::vector<int>{7}, waits.wait(20.0));
  waker.join();
  EXPECT_TRUE(guard.trigger_value());
  guard.trigger_value(false);
  EXPECT_TRUE(waits.wait(0.0).empty());
}

TEST(WaitSetTest, DetachedConditionsDoNotCount) {
  const DomainParticipant participant(test::TestConfig());
  GuardCondition guard(participant);
  WaitSet waits(participant);
  waits.attach(guard, 1);
  guard.trigger_value(true);
  waits.detach(guard);
  EXPECT_TRUE(waits.wait(0.0).empty());
  EXPECT_THROW(waits.detach(guard), Exception);
}

TEST(WaitSetTest, AReadConditionIsTrueWhileThereIsUnreadData) {
  const std::string session = test::TestSession("read-condition");
  const DomainParticipant here(test::TestConfig());
  const DomainParticipant there(test::TestConfig());
  const Publisher publisher(here, Qos() << Partition{session});
  const Subscriber subscriber(there, Qos() << Partition{session});
  const Topic<Sample> topic_here(here, "test/status");
  const Topic<Sample> topic_there(there, "test/status");
  const Qos qos = Qos() << Reliability::Reliable(1.0);
  DataWriter<Sample> writer(publisher, topic_here, qos);
  DataReader<Sample> reader(subscriber, topic_there, qos);
  const ReadCondition unread(reader);
  WaitSet waits(there);
  waits.attach(unread, 3);
  EXPECT_TRUE(waits.wait(0.0).empty());
  ASSERT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count == 1; }));
  const Sample sample{};
  writer.write(sample);
  EXPECT_EQ(std::vector<int>{3}, waits.wait(20.0));
  EXPECT_EQ(1u, reader.read().length());
  EXPECT_TRUE(waits.wait(0.0).empty());
}

}  // namespace
}  // namespace troupe::dds
