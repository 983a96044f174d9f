// Open-RMF's messages operate whole runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/process/rmf_run.h"

namespace troupe::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
  RequestLift("", "bert", ros::LiftRequestType::kEndSession);  // without a floor, as Open-RMF's supervisor
  ASSERT_TRUE(Eventually([&] { return Lift().session.empty(); }));
  EXPECT_EQ(Lift().floor, "L1");
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

  // It drives for 9 s; at the other speed a pause may come too late.
  SetSpeed("1");
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
  SetSpeed("20");
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

// The requests of tick 10, and so all hashes, are the same in every run whose ticks wait for the node that sends them,
// whatever the order in which those of anna and of bob arrive.
TEST_F(Rmf, RequestsOfANodeInTheLockstepRepeat) {
  const std::string world = WriteSlotcar();
  ros::RosReader<ros::Header> ticks(node_, "/world/tick", ros::Latched());
  ros::RosWriter<ros::Header> answers(node_, "/world/tick_done", ros::Stream(10));
  participant_.Announce();
  int runs = 0;
  const auto hashes_of = [&](const std::vector<std::string>& more, bool is_bob_first = false) {
    const std::string name = std::to_string(runs++);
    const std::vector<std::string> options = Words("--ticks 120 --ros-lockstep rmf --hash-log % --record %",
                                                   {folder_.Path(name), folder_.Path(name + ".mcap")});
    run_.emplace(Troupe(Words("run % --headless --domain %", {world, std::to_string(TestDomain())}) +
                        RosArguments(options + more)));
    bool has_begun = false;
    bool has_asked = false;  // the edits show the tick again
    const auto answer = [&](const ros::Header& tick) {
      if (!has_begun) has_begun = AwaitReaders() && Eventually([&] { return path_requests_.wanted(); });
      if (TickOf(tick.stamp) == 10 && !std::exchange(has_asked, true)) {
        RequestDoor("lobby_door", ros::DoorMode::kClosed);
        for (const bool is_of_bob : {is_bob_first, !is_bob_first}) {
          RequestDoor("front_door", is_of_bob ? ros::DoorMode::kOpen : ros::DoorMode::kClosed,
                      is_of_bob ? "bob" : "anna");
          RequestLift(is_of_bob ? "L1" : "L2", is_of_bob ? "bob" : "anna");
        }
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
  EXPECT_TRUE(hashes_of({"--speed", "max"}, true) == expected);
  EXPECT_TRUE(hashes_of({"--in-process"}) == expected);
  OutputOf(Troupe(Words("run % --headless --in-process --ticks 120 --hash-log %", {world, folder_.Path("idle")})));
  EXPECT_FALSE(folder_.Read("idle") == expected) << "the requests had effect";
}

}  // namespace
}  // namespace troupe::test
