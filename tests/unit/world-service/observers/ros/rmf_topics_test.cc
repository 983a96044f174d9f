#include "world-service/observers/ros/rmf_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/files.h"
#include "tests/support/values.h"
#include "transport/dds/binding/wire.h"
#include "world-service/core/step.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kWorldOfRmf = R"(
door ( name "gate" pose [0 5 0 0] size [2 0.05 2] )
position ( name "carrier" pose [3 0 0 0] size [0.4 0.4 0.3] )
position ( name "stand" pose [5 0 0 0] size [0.4 0.4 0.3] )
model ( name "can" pose [5 1 0 0] size [0.1 0.1 0.2] gripper_return 1 )
model ( name "tin" pose [5 -1 0 0] size [0.1 0.1 0.2] gripper_return 1 )

)";

// Without a network: its readers have the samples that a test sends.
class LocalConnection final : public ros::RosConnection {
 public:
  LocalConnection() : RosConnection(ros::Distribution::kJazzy) {}

  std::size_t AddNode(const std::string&, const std::string&) override { return 0; }
  std::unique_ptr<ros::TopicWriter> MakeWriter(std::size_t, const ros::TopicSpec&) override {
    return std::make_unique<Writer>();
  }
  std::unique_ptr<ros::TopicReader> MakeReader(std::size_t, const ros::TopicSpec& spec, ros::Part,
                                               std::function<void()> on_arrival) override {
    auto reader = std::make_unique<Reader>(std::move(on_arrival));
    readers_[spec.topic] = reader.get();
    return reader;
  }
  std::unique_ptr<ros::ServiceServer> MakeService(std::size_t, const ros::ServiceSpec&,
                                                  ros::ServiceServer::Handler) override {
    return nullptr;
  }
  void Announce() override {}
  std::vector<std::string> DrainMismatches() override { return {}; }

  template <typename Message>
  void Send(const std::string& topic, const Message& message) {
    readers_.at(topic)->Receive(std::make_shared<Message>(message));
  }

 private:
  class Writer final : public ros::TopicWriter {
    bool Write(const void*) noexcept override { return true; }
  };
  class Reader final : public ros::TopicReader {
   public:
    explicit Reader(std::function<void()> on_arrival) : on_arrival_(std::move(on_arrival)) {}
    void Receive(std::shared_ptr<const void> sample) {
      samples_.push_back(std::move(sample));
      SetArrived();
      on_arrival_();
    }

   private:
    void ConsumeArrived(const Consume& consume) override {
      for (const auto& sample : std::exchange(samples_, {})) consume(sample.get());
    }
    const std::function<void()> on_arrival_;
    std::vector<std::shared_ptr<const void>> samples_;
  };
  std::map<std::string, Reader*> readers_;
};

// Notes what it is asked for; the test answers.
class NotedControl final : public WorldControl {
 public:
  void Request(const control::Request& request, ControlReplyTo reply) override {
    requests.push_back(request);
    replies.push_back(std::move(reply));
  }
  void Wake() override { ++wakes; }

  std::vector<control::Request> requests;
  std::vector<ControlReplyTo> replies;
  int wakes = 0;
};

class RmfTopicsTest : public testing::Test {
 protected:
  RmfTopicsTest() {
    LoadedWorld loaded = test::ValueOf(LoadWorld(folder_.Write("rmf.world", kWorldOfRmf), {}));
    loaded.world.places = {{"first", "", {"dispenser:stand"}, {5.0, 0.0, 0.0, 0.0}}};
    scene_ = std::make_shared<const Scene>(std::move(loaded.world));
    frame_.state = InitialState(*scene_);
    rmf_.emplace(ros::MakeNode(connection_, "/", "world"), scene_, control_, RmfWorkcells::Results::kWithTicks,
                 [this](const std::string& line) { lines_.push_back(line); });
  }

  void SendDoorRequest(const std::string& requester, ros::DoorMode mode, const std::string& door = "gate") {
    ros::DoorRequest request{};
    request.requester_id = arena_.Copy(requester);
    request.door_name = arena_.Copy(door);
    request.requested_mode.value = static_cast<std::uint32_t>(mode);
    connection_.Send("rt/door_requests", request);
  }
  void SendDispenserRequest(const std::string& number, const std::string& transporter = "") {
    ros::DispenserRequest request{};
    request.request_guid = arena_.Copy(number);
    request.target_guid = arena_.Copy("stand");
    request.transporter_type = arena_.Copy(transporter);
    connection_.Send("rt/dispenser_requests", request);
  }
  // As the turn of the run that an arrival leads to.
  void WakeUp() {
    if (rmf_->ConsumeArrival()) rmf_->OnWake();
  }
  void Answer(std::size_t request) { control_.replies.at(request)({.done = true, .problem = ""}); }
  double OpeningOf(std::size_t request) { return std::get<control::Door>(control_.requests.at(request)).opening; }

  test::TemporaryFolder folder_;
  dds::WireArena arena_;
  LocalConnection connection_;
  NotedControl control_;
  std::shared_ptr<const Scene> scene_;
  FrameMessage frame_;
  std::vector<std::string> lines_;
  std::optional<RmfTopics> rmf_;
};

TEST_F(RmfTopicsTest, RequestsWaitForTheFirstStateAndAreThenExecutedAsTheyArrive) {
  SendDoorRequest("fleet", ros::DoorMode::kOpen);
  WakeUp();
  EXPECT_THAT(control_.requests, IsEmpty()) << "no state is known";
  rmf_->OnCommit(frame_, false);
  rmf_->OnTick(frame_);
  ASSERT_THAT(control_.requests, SizeIs(1));
  Answer(0);
  SendDoorRequest("fleet", ros::DoorMode::kClosed);
  WakeUp();
  EXPECT_THAT(control_.requests, SizeIs(2));
}

TEST_F(RmfTopicsTest, RequestsOfATickThatNodesAnswerAreExecutedTogetherByName) {
  rmf_->OnCommit(frame_, true);
  rmf_->OnTick(frame_);
  SendDoorRequest("b", ros::DoorMode::kClosed);
  SendDoorRequest("a", ros::DoorMode::kOpen);
  WakeUp();
  EXPECT_THAT(control_.requests, IsEmpty());
  EXPECT_FALSE(rmf_->Settle());
  ASSERT_THAT(control_.requests, SizeIs(2));
  EXPECT_EQ(OpeningOf(0), 1.0);
  EXPECT_EQ(OpeningOf(1), 0.0);
  Answer(0);
  EXPECT_FALSE(rmf_->Settle());
  EXPECT_EQ(control_.wakes, 0);
  Answer(1);
  EXPECT_EQ(control_.wakes, 1);
  EXPECT_TRUE(rmf_->Settle());
}

// A run that is paused at the tick has no next one that would read it.
TEST_F(RmfTopicsTest, ALateRequestIsExecutedAfterTheTickHasSettled) {
  rmf_->OnCommit(frame_, true);
  SendDoorRequest("a", ros::DoorMode::kOpen);
  EXPECT_FALSE(rmf_->Settle());
  SendDoorRequest("b", ros::DoorMode::kClosed);
  WakeUp();
  EXPECT_THAT(control_.requests, SizeIs(1));
  Answer(0);
  control_.wakes = 0;
  EXPECT_TRUE(rmf_->Settle());
  EXPECT_EQ(control_.wakes, 1) << "a turn that reads it";
  rmf_->OnWake();
  EXPECT_THAT(control_.requests, SizeIs(2));
}

TEST_F(RmfTopicsTest, ATurnPlansOneMove) {
  rmf_->OnCommit(frame_, true);
  for (const char* const number : {"1", "2", "3"}) SendDispenserRequest(number);
  EXPECT_FALSE(rmf_->Settle());
  EXPECT_THAT(control_.requests, SizeIs(1));
  EXPECT_EQ(control_.wakes, 1);
  EXPECT_FALSE(rmf_->Settle());
  EXPECT_THAT(control_.requests, SizeIs(1)) << "the same turn";
  Answer(0);
  EXPECT_FALSE(rmf_->Settle()) << "requests without a plan are left";
  rmf_->OnWake();
  EXPECT_THAT(control_.requests, SizeIs(2));
  Answer(1);
  EXPECT_FALSE(rmf_->Settle());
  EXPECT_THAT(lines_, IsEmpty());
  // The state still has both items at the stand.
  rmf_->OnWake();
  ASSERT_THAT(control_.requests, SizeIs(3));
  Answer(2);
  EXPECT_TRUE(rmf_->Settle());
}

TEST_F(RmfTopicsTest, LongTextsAreRefusedInShortLines) {
  const std::string huge(2'000'000, 'x');
  rmf_->OnCommit(frame_, false);
  SendDoorRequest("fleet", ros::DoorMode::kOpen, huge);
  SendDoorRequest(huge, ros::DoorMode::kOpen);
  SendDoorRequest("fleet", ros::DoorMode::kOpen, huge.substr(0, 999));
  SendDispenserRequest(huge);
  SendDispenserRequest("1", huge);
  WakeUp();
  EXPECT_THAT(control_.requests, IsEmpty());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("/door_requests: found a text of 2000000 bytes, expected at most 1000"),
                                  HasSubstr("the world has no door 'xxx"),
                                  HasSubstr("found a transporter_type of 2000000 bytes, expected at most 256"),
                                  HasSubstr("found a request_guid of 2000000 bytes, expected at most 256")));
  for (const std::string& line : lines_) EXPECT_LT(line.size(), 400U);
}

}  // namespace
}  // namespace troupe
