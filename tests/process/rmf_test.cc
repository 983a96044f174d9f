// Open-RMF's messages operate whole runs.
#include "ros/messages/rmf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
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

  // The guesthouse without people, where tiny_1 follows paths.
  std::string WriteSlotcar() {
    folder_.Write("slotcar.json", R"({"world": ")" + WorldPath(kHouse) + R"(", "people": [],
      "robots": [{"name": "tiny_1", "controller": {"name": "slotcar"}}]})");
    return folder_.Path("slotcar.json");
  }
  // x, y, speed limit (0: none) and time of each point.
  void RequestPath(const std::string& task, const std::vector<std::array<double, 4>>& points) {
    dds::WireArena arena;
    ros::PathRequest request{};
    request.fleet_name = arena.Copy("any");
    request.robot_name = arena.Copy("tiny_1");
    request.task_id = arena.Copy(task);
    ros::LocationMessage* location = arena.Fill(request.path, points.size());
    for (const auto& [x, y, limit, time] : points) {
      location->t = {static_cast<std::int32_t>(time), 0};
      location->x = static_cast<float>(x);
      location->y = static_cast<float>(y);
      location->yaw = 1.0F;
      location->obey_approach_speed_limit = limit > 0.0;
      location->approach_speed_limit = static_cast<float>(limit);
      location->level_name = arena.Copy("L1");
      location->index = static_cast<std::uint64_t>(location - request.path._buffer);
      ++location;
    }
    path_requests_.Write(request);
  }
  void RequestPause(std::uint32_t type, std::uint64_t number) {
    ros::PauseRequest request{};
    request.fleet_name = Text("any");
    request.robot_name = Text("tiny_1");
    request.mode_request_id = number;
    request.type = type;
    pause_requests_.Write(request);
  }
  bool AwaitRobot() {
    return Eventually(
        [&] { return path_requests_.wanted() && pause_requests_.wanted() && !Robot("tiny_1").name.empty(); });
  }
  const ros::RmfRobot& Robot(const std::string& name) {
    robot_states_.Drain([&](const ros::RobotStateMessage& state) {
      const ros::RmfRobot robot = ros::FromRobotState(state);
      robots_[robot.name] = robot;
      const double dx = robot.location.x - last_.x;
      const double seconds = robot.location.time.sec - last_.time.sec +
                             1e-9 * (static_cast<double>(robot.location.time.nanosec) - last_.time.nanosec);
      if (robot.name != "tiny_1") return;
      if (seconds > 0.0) fastest_ = std::max(fastest_, std::abs(dx) / seconds);
      last_ = robot.location;
    });
    return robots_[name];
  }
  bool RobotIsAt(double x, double y) {
    return Eventually(
        [&] {
          const ros::RmfLocation& at = Robot("tiny_1").location;
          return std::hypot(at.x - x, at.y - y) < 0.03 && Robot("tiny_1").mode == ros::RobotMode::kIdle;
        },
        60.0);
  }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("rmf");
  ros::RosParticipant participant_;
  ros::RosNode node_;
  ros::RosWriter<ros::DoorRequest> door_requests_{node_, "/door_requests", ros::Stream(10)};
  ros::RosWriter<ros::LiftRequest> lift_requests_{node_, "/lift_requests", ros::Stream(100)};
  ros::RosReader<ros::DoorStateMessage> door_states_{node_, "/door_states", ros::Stream(100)};
  ros::RosReader<ros::LiftStateMessage> lift_states_{node_, "/lift_states", ros::Stream(100)};
  ros::RosWriter<ros::PathRequest> path_requests_{node_, "/robot_path_requests", ros::Stream(10)};
  ros::RosWriter<ros::PauseRequest> pause_requests_{node_, "/robot_pause_requests", ros::Stream(10)};
  ros::RosReader<ros::RobotStateMessage> robot_states_{node_, "/robot_state", ros::Stream(100)};
  std::map<std::string, ros::RmfRobot> robots_;
  ros::RmfLocation last_;
  double fastest_ = 0.0;  // m/s along x between two states of tiny_1
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

// tiny_1 is at (1.5, -2); lanes lead it to (3, -3.75) and (5, -3.75).
TEST_F(Rmf, ASlotcarDrivesAlongItsPath) {
  Start({"--speed", "20", "--record", folder_.Path("run.mcap")}, WriteSlotcar());
  ASSERT_TRUE(AwaitRobot());
  const ros::RmfRobot begin = Robot("tiny_1");
  EXPECT_EQ(begin.model, "position");
  EXPECT_EQ(begin.location.level, "L1");
  EXPECT_EQ(begin.battery, 100.0F);
  EXPECT_TRUE(Eventually([&] { return !Robot("delivery_1").name.empty(); })) << "others have states, too";
  const double x = begin.location.x;
  const double y = begin.location.y;
  RequestPath("first", {{x, y, 0, 0}, {3, -3.75, 0, 0}, {5, -3.75, 0.2, 0}});
  ASSERT_TRUE(Eventually([&] { return Robot("tiny_1").mode == ros::RobotMode::kMoving; }));
  EXPECT_EQ(Robot("tiny_1").task, "first");
  EXPECT_FALSE(Robot("tiny_1").path.empty());
  ASSERT_TRUE(Eventually([&] { return Robot("tiny_1").path.size() == 1; }, 60.0)) << "towards the last point";
  fastest_ = 0.0;
  ASSERT_TRUE(RobotIsAt(5, -3.75)) << Robot("tiny_1").location.x << " " << Robot("tiny_1").location.y;
  EXPECT_LT(fastest_, 0.22) << "the speed limit of the lane";
  EXPECT_GT(fastest_, 0.15);
  EXPECT_TRUE(Robot("tiny_1").path.empty());
  EXPECT_NEAR(Robot("tiny_1").location.yaw, 1.0, 0.05);

  RequestPath("first", {{5, -3.75, 0, 0}, {3, -3.75, 0, 0}});  // a repeated task
  RequestPath("far", {{9, -3.75, 0, 0}, {3, -3.75, 0, 0}});
  run_->WaitForLine("robot 'tiny_1' stops: the path of task 'far' begins at (9.00, -3.75), farther than 1 m away");
  ASSERT_TRUE(Eventually([&] { return Robot("tiny_1").mode == ros::RobotMode::kAdapterError; }));
  EXPECT_NEAR(Robot("tiny_1").location.x, 5.0, 0.03);

  RequestPath("back", {{5, -3.75, 0, 0}, {3, -3.75, 0, 0}});
  ASSERT_TRUE(Eventually([&] { return Robot("tiny_1").location.x < 4.8F; }));
  RequestPause(0, 7);
  ASSERT_TRUE(Eventually([&] { return Robot("tiny_1").mode == ros::RobotMode::kPaused; }));
  EXPECT_EQ(Robot("tiny_1").mode_request, 7u);
  const double rest = Robot("tiny_1").location.x;
  const auto seq = Robot("tiny_1").seq;
  ASSERT_TRUE(Eventually([&] { return Robot("tiny_1").seq > seq + 10; }));
  EXPECT_NEAR(Robot("tiny_1").location.x, rest, 0.4) << "but for the way of its brakes";
  EXPECT_GT(Robot("tiny_1").location.x, 3.1F);
  RequestPause(2, 8);
  ASSERT_TRUE(RobotIsAt(3, -3.75));
  run_->Interrupt();
  OutputOf(Troupe({"replay", folder_.Path("run.mcap"), "--verify"}));
}

TEST_F(Rmf, ASlotcarLeavesAPointAtItsTime) {
  Start({"--speed", "20"}, WriteSlotcar());
  ASSERT_TRUE(AwaitRobot());
  const ros::RmfLocation begin = Robot("tiny_1").location;
  const double leaves = begin.time.sec + 30;
  RequestPath("timed", {{begin.x, begin.y, 0, 0}, {3, -3.75, 0, leaves}, {5, -3.75, 0, 0}});
  ASSERT_TRUE(Eventually([&] { return std::hypot(Robot("tiny_1").location.x - 3, last_.y + 3.75) < 0.05; }, 60.0));
  ASSERT_TRUE(Eventually([&] { return Robot("tiny_1").location.x > 3.2F; }, 60.0));
  EXPECT_GE(Robot("tiny_1").location.time.sec, static_cast<std::int32_t>(leaves));
}

// The requests of tick 10, and so all hashes, are the same in every run whose ticks wait for the node that sends them.
TEST_F(Rmf, RequestsOfANodeInTheLockstepRepeat) {
  const std::string world = WriteSlotcar();
  ros::RosReader<ros::Header> ticks(node_, "/world/tick", ros::Latched());
  ros::RosWriter<ros::Header> answers(node_, "/world/tick_done", ros::Stream(10));
  participant_.Announce();
  int runs = 0;
  const auto hashes_of = [&](const std::vector<std::string>& more) {
    const std::string name = std::to_string(runs++);
    const std::vector<std::string> options = Words("--ticks 120 --ros-lockstep rmf --hash-log % --record %",
                                                   {folder_.Path(name), folder_.Path(name + ".mcap")});
    run_.emplace(Troupe(Words("run % --headless --domain %", {world, std::to_string(TestDomain())}) +
                        RosArguments(options + more)));
    bool has_begun = false;
    const auto answer = [&](const ros::Header& tick) {
      if (!has_begun) has_begun = AwaitReaders() && Eventually([&] { return path_requests_.wanted(); });
      if (TickOf(tick.stamp) == 10) {
        RequestDoor("lobby_door", ros::DoorMode::kClosed);
        RequestDoor("front_door", ros::DoorMode::kClosed);
        RequestLift("L2", "anna");
        RequestPath("repeats", {{1.5, -2, 0, 0}, {3, -3.75, 0, 0}});
      }
      dds::WireArena arena;
      answers.Write({tick.stamp, arena.Copy("rmf")});
    };
    while (!run_->HasEnded()) {
      EXPECT_TRUE(Eventually([&] {
        bool is_new = false;
        ticks.Drain([&](const ros::Header& tick) {
          answer(tick);
          is_new = true;
        });
        return is_new || run_->HasEnded();
      }));
    }
    EXPECT_EQ(run_->Wait(), 0) << run_->output();
    OutputOf(Troupe({"replay", folder_.Path(name + ".mcap"), "--verify"}));
    return folder_.Read(name);
  };
  const std::string expected = hashes_of({});
  ASSERT_FALSE(expected.empty());
  EXPECT_TRUE(hashes_of({"--speed", "max"}) == expected);
  EXPECT_TRUE(hashes_of({"--in-process"}) == expected);
  OutputOf(Troupe(Words("run % --headless --in-process --ticks 120 --hash-log %", {world, folder_.Path("idle")})));
  EXPECT_FALSE(folder_.Read("idle") == expected) << "the requests had effect";
}

}  // namespace
}  // namespace troupe::test
