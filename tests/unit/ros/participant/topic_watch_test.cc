// Messages on watched topics count for the round that is armed, whoever watches.
#include "ros/participant/topic_watch.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/link/host_connection.h"
#include "ros/messages/messages.h"
#include "tests/support/dds_domain.h"
#include "tests/support/host_participant.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_graph.h"

namespace troupe::ros {
namespace {

using test::Eventually;

constexpr const char* kTopic = "rt/plan";

// A process whose ticks wait for the topic.
class Waiting {
 public:
  explicit Waiting(const test::HostParticipant& host) : connection_(host.Connect()) {
    MakeNode(*connection_, "/", "world");
    connection_->WatchTopics([] {});
    watch_ = connection_->Watch(kTopic);
    connection_->Announce();
  }

  void Arm(const std::string& text) {
    connection_->Arm(text);
    EXPECT_TRUE(Eventually([&] { return connection_->watched().armed == text; }));
  }
  bool has_message() { return connection_->watched().arrived.contains(watch_); }
  bool is_timed() { return connection_->watched().timed.contains(watch_); }
  bool GetsMessage() {
    return Eventually([this] { return has_message(); });
  }

 private:
  std::unique_ptr<HostConnection> connection_;
  std::uint32_t watch_ = 0;
};

class TopicWatchTest : public testing::Test {
 protected:
  // On the topic, once it is read.
  void WritePlan() {
    EXPECT_TRUE(Eventually([this] { return plans_.wanted(); }));
    plans_.Write({});
  }

  const RosNetwork network_ = test::TestRosNetwork();
  RosParticipant participant_{network_};
  RosNode planner_ = MakeNode(participant_, "/", "planner");
  RosWriter<Clock> plans_{planner_, "/plan", Stream(1)};
  test::HostParticipant host_{network_};
};

TEST_F(TopicWatchTest, AMessageCountsForTheTextThatIsArmed) {
  Waiting run(host_);
  run.Arm("1");
  EXPECT_FALSE(run.has_message());
  WritePlan();
  EXPECT_TRUE(run.GetsMessage());
  run.Arm("2");
  EXPECT_FALSE(run.has_message());
  run.Arm("1");  // again
  EXPECT_TRUE(run.GetsMessage());
  run.Arm("3");
  WritePlan();
  EXPECT_TRUE(run.GetsMessage());
}

TEST_F(TopicWatchTest, ASuccessorHasTheMessagesOfTheOneBefore) {
  std::optional<Waiting> run(std::in_place, host_);
  run->Arm("1");
  WritePlan();
  EXPECT_TRUE(run->GetsMessage());
  run->Arm("2");
  test::RosGraph graph(network_);
  EXPECT_TRUE(Eventually([&] { return graph.HasNode("/world"); }));
  run.reset();
  // While there is none.
  EXPECT_TRUE(Eventually([&] { return !graph.HasNode("/world"); }));
  WritePlan();
  Waiting next(host_);
  next.Arm("2");
  EXPECT_TRUE(next.GetsMessage());
  next.Arm("1");
  EXPECT_TRUE(next.GetsMessage());
  next.Arm("3");
  EXPECT_FALSE(next.has_message());
}

TEST_F(TopicWatchTest, ATopicIsTimedWhileItsProgramReadsTheClock) {
  Waiting run(host_);
  RosParticipant other(network_);
  const RosNode viewer = MakeNode(other, "/", "viewer");
  const RosReader<Clock> of_other(viewer, "/clock", Stream(1));
  run.Arm("1");
  WritePlan();
  EXPECT_TRUE(run.GetsMessage());
  EXPECT_FALSE(run.is_timed());
  std::optional<RosReader<Clock>> clock(std::in_place, planner_, "/clock", Stream(1));
  EXPECT_TRUE(Eventually([&] { return run.is_timed(); }));
  clock.reset();
  EXPECT_TRUE(Eventually([&] { return !run.is_timed(); }));
}

}  // namespace
}  // namespace troupe::ros
