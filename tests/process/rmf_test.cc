// Open-RMF's messages operate whole runs.
#include "ros/messages/rmf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"

namespace troupe::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kHouse = "../../../worlds/sites/guesthouse.building.yaml";

struct LiftSeen {
  std::string floor;
  std::string session;
  std::uint8_t doors = 0;
  std::uint8_t motion = 0;
};

// An Open-RMF beside a run of the guesthouse.
class Rmf : public testing::Test {
 protected:
  Rmf() : participant_(TestRosNetwork()), node_(ros::MakeNode(participant_, "/", "rmf")) { participant_.Announce(); }

  void Start(const std::vector<std::string>& more, const std::string& world = WorldPath(kHouse)) {
    run_.emplace(
        Troupe(Words("run % --headless --session % --domain %", {world, session_, std::to_string(TestDomain())}) +
               RosArguments(more)));
    run_->WaitForLine(", ready");
  }

  void RequestDoor(const char* door, ros::DoorMode mode) {
    ros::DoorRequest request{};
    request.requester_id = Text("test");
    request.door_name = Text(door);
    request.requested_mode.value = static_cast<std::uint32_t>(mode);
    door_requests_.Write(request);
  }
  void RequestLift(const char* floor, const char* session, ros::LiftRequestType type = ros::LiftRequestType::kAgv) {
    ros::LiftRequest request{};
    request.lift_name = Text("guest_lift");
    request.session_id = Text(session);
    request.request_type = static_cast<std::uint8_t>(type);
    request.destination_floor = Text(floor);
    request.door_state = 2;
    lift_requests_.Write(request);
  }
  bool AwaitReaders() {
    return Eventually([&] { return door_requests_.wanted() && lift_requests_.wanted(); });
  }

  std::map<std::string, std::uint32_t>& Doors() {
    door_states_.Drain([&](const ros::DoorStateMessage& state) { doors_[state.door_name] = state.current_mode.value; });
    return doors_;
  }
  bool DoorBecomes(const std::string& door, ros::DoorMode mode) {
    return Eventually([&] {
      const auto found = Doors().find(door);
      return found != doors_.end() && found->second == static_cast<std::uint32_t>(mode);
    });
  }
  const LiftSeen& Lift() {
    lift_states_.Drain([&](const ros::LiftStateMessage& state) {
      lift_ = {state.current_floor, state.session_id, state.door_state, state.motion_state};
      motions_.insert(state.motion_state);
      floors_ = dds::Strings(state.available_floors);
    });
    return lift_;
  }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("rmf");
  ros::RosParticipant participant_;
  ros::RosNode node_;
  ros::RosWriter<ros::DoorRequest> door_requests_{node_, "/door_requests", ros::Stream(10)};
  ros::RosWriter<ros::LiftRequest> lift_requests_{node_, "/lift_requests", ros::Stream(100)};
  ros::RosReader<ros::DoorStateMessage> door_states_{node_, "/door_states", ros::Stream(100)};
  ros::RosReader<ros::LiftStateMessage> lift_states_{node_, "/lift_states", ros::Stream(100)};
  std::map<std::string, std::uint32_t> doors_;
  LiftSeen lift_;
  std::set<std::uint8_t> motions_;
  std::vector<std::string> floors_;
  std::optional<Program> run_;
};

TEST_F(Rmf, ADoorFollowsTheNewestRequest) {
  Start({"--speed", "20", "--record", folder_.Path("run.mcap")});
  ASSERT_TRUE(AwaitReaders());
  ASSERT_TRUE(DoorBecomes("front_door", ros::DoorMode::kOpen));
  RequestDoor("front_door", ros::DoorMode::kClosed);
  ASSERT_TRUE(DoorBecomes("front_door", ros::DoorMode::kClosed));
  RequestDoor("front_door", ros::DoorMode::kOpen);
  ASSERT_TRUE(DoorBecomes("front_door", ros::DoorMode::kOpen));
  RequestDoor("no_door", ros::DoorMode::kOpen);
  run_->WaitForLine("/door_requests: the world has no door 'no_door' that takes requests");
  std::vector<std::string> names;
  for (const auto& door : Doors()) names.push_back(door.first);
  EXPECT_THAT(names, ElementsAre("back_door", "closet_door", "front_door", "lobby_door", "room_1_door"))
      << "none of the lift's";
  run_->Interrupt();
  OutputOf(Troupe({"replay", folder_.Path("run.mcap"), "--verify"}));
}

TEST_F(Rmf, ALiftServesOneSessionAfterTheOther) {
  Start({"--speed", "20", "--record", folder_.Path("run.mcap")});
  ASSERT_TRUE(AwaitReaders());
  ASSERT_TRUE(Eventually([&] { return Lift().floor == "L1" && Lift().doors == 2; }));
  EXPECT_THAT(floors_, ElementsAre("L1", "L2"));
  EXPECT_EQ(Lift().session, "");
  RequestLift("L2", "anna");
  RequestLift("L1", "bert");  // the lift is on its way
  run_->WaitForLine("lift 'guest_lift' is on its way to L2 for 'anna': ignored the request of 'bert'");
  ASSERT_TRUE(Eventually([&] { return Lift().floor == "L2" && Lift().doors == 2; }));
  EXPECT_EQ(Lift().session, "anna");
  EXPECT_TRUE(motions_.contains(static_cast<std::uint8_t>(ros::LiftMotion::kUp)));
  EXPECT_FALSE(motions_.contains(static_cast<std::uint8_t>(ros::LiftMotion::kDown)));
  RequestLift("L2", "anna", ros::LiftRequestType::kEndSession);
  ASSERT_TRUE(Eventually([&] { return Lift().session.empty(); }));
  EXPECT_EQ(Lift().floor, "L2");
  ASSERT_TRUE(Eventually([&] {
    RequestLift("L1", "bert");  // again and again, as Open-RMF's adapters do
    return Lift().session == "bert" && Lift().floor == "L1" && Lift().doors == 2;
  })) << Lift().session
      << " at " << Lift().floor << ", doors " << int{Lift().doors} << ", motion " << int{Lift().motion} << "\n"
      << run_->output();
  run_->Interrupt();
  OutputOf(Troupe({"replay", folder_.Path("run.mcap"), "--verify"}));
}

}  // namespace
}  // namespace troupe::test
