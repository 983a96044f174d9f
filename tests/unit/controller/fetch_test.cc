#include <gtest/gtest.h>

#include "tests/support/message_of.h"
#include "tests/unit/controller/controlled_robot.h"

namespace troupe {
namespace {

struct FetchCase {
  const char* parameters;
  const char* message;
};

TEST(FetchParameters, AreCheckedStepByStep) {
  const FetchCase cases[] = {
      {R"({"steps": [{"go_to": [1, 2]}, {"turn_to": 1}, {"drive": -1}, {"push": 1}, {"gripper": "open"}, {"lift": 50},
                     {"wait": 1}, {"wait_until": 9}, {"take": [1, 2, 3, 0]}, {"put": "shelf"}],
           "places": [{"name": "shelf", "at": [0, 0, 0, 100]}],
           "speed": 1, "turn_rate": 1, "reach": 0.5, "approach": 1, "raise": 3, "travel": 10})",
       ""},
      {"{}", "fetch: 'steps' is missing or empty, expected a list of steps"},
      {R"({"steps": [5]})", "fetch: step 1: expected an object with one key"},
      {R"({"steps": [{"wait": 1}, {"wait": 1, "lift": 2}]})", "fetch: step 2: expected an object with one key"},
      {R"({"steps": [{"jump": 1}]})",
       "fetch: step 1: found another key, expected one of: drive, go_to, gripper, lift, push, put, take, turn_to, "
       "wait, "
       "wait_until"},
      {R"({"steps": [{"lift": 140}]})", "fetch: step 1: 'lift' expects a number from 0 to 100"},
      {R"({"steps": [{"lift": "up"}]})", "fetch: step 1: 'lift' expects a number from 0 to 100"},
      {R"({"steps": [{"wait": -1}]})", "fetch: step 1: 'wait' expects a number from 0 to 1000000000"},
      {R"({"steps": [{"go_to": [1]}]})", "fetch: step 1: 'go_to' expects [x, y]"},
      {R"({"steps": [{"go_to": [1, 1e7]}]})", "fetch: step 1: 'go_to' expects [x, y]"},
      {R"({"steps": [{"gripper": "shut"}]})", "fetch: step 1: 'gripper' expects \"open\" or \"close\""},
      {R"({"steps": [{"take": "shelf"}]})", "fetch: step 1: names a place that is not in 'places'"},
      {R"({"steps": [{"put": [1, 2, 3]}]})",
       "fetch: step 1: expected the name of a place, or [x, y, heading, lift] with a lift of 0 to 100 percent"},
      {R"({"steps": [{"put": [1, 2, 3, 101]}]})",
       "fetch: step 1: expected the name of a place, or [x, y, heading, lift] with a lift of 0 to 100 percent"},
      {R"({"steps": [{"wait": 1}], "places": [{"name": "a", "at": [1]}]})",
       "fetch: place 1: expected {\"name\": \"...\", \"at\": [x, y, heading, lift]}, with a lift of 0 to 100 percent"},
      {R"({"steps": [{"wait": 1}], "reach": -1})", "fetch: 'reach' is -1, expected a number of at least 0"},
      {R"({"steps": [{"wait": 1}], "rech": 1})",
       "fetch: unknown parameter \"rech\", expected one of: approach, places, raise, reach, speed, steps, travel, "
       "turn_rate; did you mean 'reach'?"},
  };
  for (const FetchCase& c : cases)
    EXPECT_EQ(MessageOf(CheckController("fetch", c.parameters)), c.message) << c.parameters;
}

TEST(FetchWithoutGripper, IsAnErrorIfItNeedsOne) {
  const auto message_of = [](const std::string& step, DriveType drive = DriveType::kDifferential) {
    const RobotDescription robot = MakeRobot("fetch", R"({"steps": [)" + step + "]}", {}, drive);
    const auto controller = CreateFor(robot);
    return controller.ok() ? "" : controller.error().message;
  };
  const std::string message =
      "fetch: the robot has no gripper, expected one for the steps 'gripper', 'lift', 'take' and 'put'";
  EXPECT_EQ(message_of(R"({"gripper": "open"})"), message);
  EXPECT_EQ(message_of(R"({"lift": 5})"), message);
  EXPECT_EQ(message_of(R"({"take": [0, 0, 0, 0]})"), message);
  EXPECT_EQ(message_of(R"({"go_to": [1, 1]})"), "");
  EXPECT_EQ(message_of(R"({"drive": 1})", DriveType::kCar),
            "fetch: the robot is a car, expected one that turns on the spot");
}

// Drives a robot without inertia.
class FetchTest : public testing::Test {
 protected:
  void Follow(const std::string& steps, int ticks) {
    robot_ = MakeRobot("fetch", R"({"speed": 0.5, "turn_rate": 1, "steps": [)" + steps + "]}");
    robot_.drive.velocity = {{-1.0, 1.0}, {0.0, 0.0}, {-2.0, 2.0}};
    robot_.drive.acceleration = {{-1.0, 1.0}, {0.0, 0.0}, {-2.0, 2.0}};
    auto controller = CreateFor(robot_);
    ASSERT_TRUE(controller.ok()) << controller.error().message;
    for (int tick = 0; tick < ticks; ++tick) {
      Observation observation = At(static_cast<Tick>(tick), {}, stalled_);
      observation.pose_estimate = pose_;
      const Command command = controller.value()->Update(observation);
      EXPECT_LE(std::abs(command.twist.vx), 0.5);
      EXPECT_LE(std::abs(command.twist.wz), 1.0);
      Pose next = pose_ * Integrate(command.twist, observation.interval);
      stalled_ = next.x > wall_;
      if (!stalled_) pose_ = next;
    }
  }

  RobotDescription robot_;
  Pose pose_;
  bool stalled_ = false;
  double wall_ = 100.0;  // m: it gets no further along x
};

TEST_F(FetchTest, ReachesPointsAndHeadingsExactly) {
  Follow(R"({"go_to": [1, 2]}, {"go_to": [-1, 0.5]}, {"turn_to": 3.5})", 300);
  EXPECT_NEAR(pose_.x, -1.0, 1e-5);
  EXPECT_NEAR(pose_.y, 0.5, 1e-5);
  EXPECT_NEAR(pose_.heading, WrapAngle(3.5), 1e-9);
}

TEST_F(FetchTest, DrivesStraightAheadAndBack) {
  Follow(R"({"turn_to": 1.5707963267948966}, {"drive": 2}, {"drive": -0.5})", 300);
  EXPECT_NEAR(pose_.x, 0.0, 1e-9);
  EXPECT_NEAR(pose_.y, 1.5, 1e-5);
}

TEST_F(FetchTest, PushesUntilItIsStopped) {
  wall_ = 0.7;
  Follow(R"({"push": 2}, {"drive": -0.5})", 100);
  EXPECT_NEAR(pose_.x, 0.2, 0.05);
}

TEST_F(FetchTest, Waits) {
  Follow(R"({"wait": 1}, {"wait_until": 2.5}, {"drive": 0.2})", 25);
  EXPECT_EQ(pose_.x, 0.0);
}

}  // namespace
}  // namespace troupe
