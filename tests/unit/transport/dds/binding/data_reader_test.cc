#include "transport/dds/binding/data_reader.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <thread>

#include "tests/support/dds_domain.h"
#include "tests/unit/transport/dds/binding/keyed_status_type.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/qos.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/qos_profiles.h"

namespace troupe::dds {
namespace {

using test::Eventually;
using StatusSample = troupe_test_KeyedStatus;  // keyed by `run`

StatusSample Make(std::uint64_t run, std::uint64_t tick) {
  StatusSample sample{};
  sample.run = run;
  sample.tick = tick;
  return sample;
}

Qos Reliable() {
  return Qos() << Reliability::Reliable(1.0) << History::KeepAll();
}

// A writer and a reader in participants of their own, in a partition of the test's own.
class DataReaderTest : public testing::Test {
 protected:
  DataReaderTest()
      : session_(test::TestSession(testing::UnitTest::GetInstance()->current_test_info()->name())),
        publisher_(here_, Qos() << Partition{session_}),
        subscriber_(there_, Qos() << Partition{session_}) {}

  static bool Matched(const DataWriter<StatusSample>& writer, std::uint32_t readers = 1) {
    return Eventually([&] { return writer.publication_matched_status().current_count == readers; });
  }

  std::string session_;
  DomainParticipant here_{test::TestConfig()};
  DomainParticipant there_{test::TestConfig()};
  Publisher publisher_;
  Subscriber subscriber_;
  Topic<StatusSample> topic_here_{here_, "test/status"};
  Topic<StatusSample> topic_there_{there_, "test/status"};
};

TEST_F(DataReaderTest, TakesEachSampleOnce) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  ASSERT_TRUE(Matched(writer));
  std::string first = "r0";
  std::string second = "r1";
  char* names[] = {first.data(), second.data()};
  StatusSample sample = Make(5, 77);
  sample.real_time_factor = 1.25;
  sample.waiting_for = {2, 2, names, false};
  writer.write(sample);

  std::optional<LoanedSamples<StatusSample>> loan;
  ASSERT_TRUE(Eventually([&] {
    loan.emplace(reader.take());
    return !loan->empty();
  }));
  ASSERT_EQ(1u, loan->length());
  for (const auto& taken : *loan) {
    EXPECT_TRUE(taken.info().valid());
    EXPECT_TRUE(taken.info().instance_alive());
    EXPECT_EQ(5u, taken.data().run);
    EXPECT_EQ(77u, taken.data().tick);
    EXPECT_EQ(1.25, taken.data().real_time_factor);
    ASSERT_EQ(2u, taken.data().waiting_for._length);
    EXPECT_STREQ("r1", taken.data().waiting_for._buffer[1]);
  }
  EXPECT_TRUE(reader.take().empty());
}

TEST_F(DataReaderTest, ReadingLeavesTheSample) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  ASSERT_TRUE(Matched(writer));
  writer.write(Make(1, 1));
  ASSERT_TRUE(Eventually([&] { return !reader.read().empty(); }));
  EXPECT_EQ(1u, reader.read().length());
  EXPECT_EQ(1u, reader.take().length());
}

TEST_F(DataReaderTest, SeveralLoansAreOutAtATime) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  ASSERT_TRUE(Matched(writer));
  constexpr std::size_t kMany = 2 * LoanedSamples<StatusSample>::kMaxSamples;
  for (std::size_t i = 0; i < kMany; ++i) writer.write(Make(1, i));
  ASSERT_TRUE(writer.wait_for_acknowledgments(10.0));
  const auto first = reader.take();
  LoanedSamples<StatusSample> moved_from = reader.take();
  const LoanedSamples<StatusSample> second = std::move(moved_from);
  EXPECT_EQ(kMany, first.length() + second.length());
  EXPECT_EQ(0u, first[0].data().tick);
  EXPECT_EQ(kMany - 1, second[second.length() - 1].data().tick);
  EXPECT_TRUE(reader.take().empty());
}

TEST_F(DataReaderTest, KeepLastKeepsTheLatestOfEachInstance) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  DataReader<StatusSample> reader(subscriber_, topic_there_,
                                  Qos() << Reliability::Reliable(1.0) << History::KeepLast(1));
  ASSERT_TRUE(Matched(writer));
  for (std::uint64_t tick = 0; tick < 5; ++tick) {
    writer.write(Make(1, tick));
    writer.write(Make(2, 10 + tick));
  }
  ASSERT_TRUE(writer.wait_for_acknowledgments(10.0));
  const auto samples = reader.take();
  ASSERT_EQ(2u, samples.length());
  for (const auto& sample : samples) EXPECT_EQ(sample.data().run == 1 ? 4u : 14u, sample.data().tick);
}

TEST_F(DataReaderTest, ReportsADisposedInstance) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  ASSERT_TRUE(Matched(writer));
  writer.write(Make(9, 1));
  ASSERT_TRUE(Eventually([&] { return !reader.take().empty(); }));
  writer.dispose(Make(9, 0));
  std::optional<LoanedSamples<StatusSample>> loan;
  ASSERT_TRUE(Eventually([&] {
    loan.emplace(reader.take());
    return !loan->empty();
  }));
  EXPECT_FALSE((*loan)[0].info().valid());
  EXPECT_TRUE((*loan)[0].info().instance_disposed());
  EXPECT_EQ(9u, (*loan)[0].data().run);
}

TEST_F(DataReaderTest, DeletingTheWriterEndsItsInstances) {
  std::optional<DataWriter<StatusSample>> writer(std::in_place, publisher_, topic_here_, Reliable());
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  ASSERT_TRUE(Matched(*writer));
  writer->write(Make(9, 1));
  ASSERT_TRUE(Eventually([&] { return !reader.take().empty(); }));
  writer.reset();
  EXPECT_TRUE(Eventually([&] {
    const auto samples = reader.take();
    return !samples.empty() && !samples[0].info().instance_alive() && samples[0].data().run == 9;
  }));
}

TEST_F(DataReaderTest, LatecomersReceiveTheSamplesThatATransientLocalWriterKept) {
  const Qos kept = Reliable() << Durability::TransientLocal() << DurabilityService{History::KeepLast(1)};
  DataWriter<StatusSample> writer(publisher_, topic_here_, kept);
  writer.write(Make(1, 1));
  writer.write(Make(1, 2));
  DataReader<StatusSample> reader(subscriber_, topic_there_, kept);
  std::optional<LoanedSamples<StatusSample>> loan;
  ASSERT_TRUE(Eventually([&] {
    loan.emplace(reader.take());
    return !loan->empty();
  }));
  EXPECT_EQ(1u, loan->length());
  EXPECT_EQ(2u, (*loan)[0].data().tick);
}

TEST_F(DataReaderTest, LatecomersReceiveNoSampleOfAVolatileWriter) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  writer.write(Make(1, 1));
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  ASSERT_TRUE(Matched(writer));
  ASSERT_TRUE(Eventually([&] { return reader.subscription_matched_status().current_count == 1; }));
  writer.write(Make(1, 2));
  std::optional<LoanedSamples<StatusSample>> loan;
  ASSERT_TRUE(Eventually([&] {
    loan.emplace(reader.take());
    return !loan->empty();
  }));
  EXPECT_EQ(2u, (*loan)[0].data().tick);
}

TEST_F(DataReaderTest, PartitionsSeparateAndWildcardsJoin) {
  const Subscriber elsewhere(there_, Qos() << Partition{session_ + "-elsewhere"});
  const Subscriber everywhere(there_, Qos() << Partition{session_ + "*"});
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  DataReader<StatusSample> other(elsewhere, topic_there_, Reliable());
  DataReader<StatusSample> same(subscriber_, topic_there_, Reliable());
  DataReader<StatusSample> all(everywhere, topic_there_, Reliable());
  // The last reader was made after the first one, and discovery keeps the order.
  ASSERT_TRUE(Matched(writer, 2));
  writer.write(Make(1, 1));
  EXPECT_TRUE(Eventually([&] { return !same.take().empty(); }));
  EXPECT_TRUE(Eventually([&] { return !all.take().empty(); }));
  EXPECT_EQ(0u, other.subscription_matched_status().total_count);
  EXPECT_TRUE(other.take().empty());
}

TEST_F(DataReaderTest, IncompatibleQosIsReportedOnBothSides) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Qos() << Reliability::BestEffort());
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  EXPECT_TRUE(Eventually([&] { return writer.offered_incompatible_qos_status().total_count == 1; }));
  EXPECT_TRUE(Eventually([&] { return reader.requested_incompatible_qos_status().total_count == 1; }));
  EXPECT_EQ(static_cast<std::uint32_t>(DDS_RELIABILITY_QOS_POLICY_ID),
            reader.requested_incompatible_qos_status().last_policy_id);
  EXPECT_EQ(0u, writer.publication_matched_status().total_count);
}

TEST_F(DataReaderTest, AnotherTypeOfTheSameTopicNameDoesNotMatch) {
  const Topic<troupe_wire_Join> imposter(here_, topic_there_.name());
  DataWriter<troupe_wire_Join> wrong(publisher_, imposter, Reliable());
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  DataWriter<StatusSample> right(publisher_, topic_here_, Reliable());
  ASSERT_TRUE(Matched(right));  // discovered after the wrong one
  EXPECT_EQ(0u, wrong.publication_matched_status().total_count);
}

TEST_F(DataReaderTest, AReaderAndItsWriterCanBeMoved) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  DataReader<StatusSample> reader(subscriber_, topic_there_, Reliable());
  ASSERT_TRUE(Matched(writer));
  DataWriter<StatusSample> moved_writer = std::move(writer);
  DataReader<StatusSample> moved_reader = std::move(reader);
  moved_writer.write(Make(1, 1));
  EXPECT_TRUE(Eventually([&] { return !moved_reader.take().empty(); }));
}

TEST_F(DataReaderTest, WaitingForAcknowledgmentsTakesAsLongAsItIsGiven) {
  DataWriter<StatusSample> writer(publisher_, topic_here_, Reliable());
  EXPECT_TRUE(writer.wait_for_acknowledgments(0.0));  // without a reader
}

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

TEST(QosTest, HasThePoliciesThatWereSet) {
  Qos qos;
  qos << Reliability::Reliable(0.25) << History::KeepLast(3) << Durability::TransientLocal();
  dds_reliability_kind_t reliability;
  dds_duration_t blocking = 0;
  ASSERT_TRUE(dds_qget_reliability(qos.get(), &reliability, &blocking));
  EXPECT_EQ(DDS_RELIABILITY_RELIABLE, reliability);
  EXPECT_EQ(DDS_MSECS(250), blocking);
  dds_history_kind_t history;
  std::int32_t depth = 0;
  ASSERT_TRUE(dds_qget_history(qos.get(), &history, &depth));
  EXPECT_EQ(DDS_HISTORY_KEEP_LAST, history);
  EXPECT_EQ(3, depth);
  dds_durability_kind_t durability;
  ASSERT_TRUE(dds_qget_durability(qos.get(), &durability));
  EXPECT_EQ(DDS_DURABILITY_TRANSIENT_LOCAL, durability);
}

TEST(QosTest, LeavesOtherPoliciesAlone) {
  dds_history_kind_t history;
  std::int32_t depth = 0;
  EXPECT_FALSE(dds_qget_history((Qos() << Durability::Volatile()).get(), &history, &depth));
}

TEST(QosTest, CopiesAreIndependent) {
  const Qos first = Qos() << History::KeepLast(1);
  Qos second = first;
  EXPECT_EQ(first, second);
  second << History::KeepLast(2);
  EXPECT_FALSE(first == second);
  second = first;
  EXPECT_EQ(first, second);
}

TEST(DurationTest, AcceptsAnyNumberOfSeconds) {
  EXPECT_EQ(DDS_MSECS(1500), ToDuration(1.5));
  EXPECT_EQ(0, ToDuration(-1.0));
  EXPECT_EQ(DDS_INFINITY, ToDuration(kInfinite));
  EXPECT_EQ(DDS_INFINITY, ToDuration(1e300));
  EXPECT_EQ(kInfinite, ToSeconds(DDS_INFINITY));
  EXPECT_DOUBLE_EQ(1.5, ToSeconds(DDS_MSECS(1500)));
}

// Cyclone leaves defaults out of its announcements, and some peers then cannot read them.
TEST(QosProfilesTest, NeverUseTheDefaultBlockingTime) {
  using namespace qos_profiles;
  for (const Qos& qos : {Description(1.0), Join(1.0), Admission(), Frame(), Proposal(), qos_profiles::Status()}) {
    dds_reliability_kind_t kind;
    dds_duration_t blocking = 0;
    ASSERT_TRUE(dds_qget_reliability(qos.get(), &kind, &blocking));
    EXPECT_EQ(DDS_RELIABILITY_RELIABLE, kind);
    EXPECT_NE(DDS_MSECS(100), blocking);
  }
}

}  // namespace
}  // namespace troupe::dds
