#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <stdexcept>

#include "tests/support/dds_domain.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/convert/convert.h"

namespace troupe::dds {
namespace {

using test::Eventually;
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
