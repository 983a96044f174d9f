#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ros/messages/text_messages.h"
#include "tests/support/gripper_world.h"

namespace troupe::ros {
namespace {

class GripperStateTest : public testing::Test {
 protected:
  GripperStateTest() : parts_(world_.AddGripperRobot({})), box_(world_.AddObject({0.35, 0.0, 0.0, 0.0})) {}
  nlohmann::json Json(const WorldState& state) const {
    return nlohmann::json::parse(GripperJson(world_.world, parts_.gripper, state));
  }

  test::GripperWorld world_;
  test::GripperRobot parts_;
  ObjectId box_;
};

TEST_F(GripperStateTest, ReportsTheMotionOfTheFingers) {
  WorldState state = PlacedState(world_.world);
  EXPECT_EQ(Json(state), nlohmann::json({{"tick", 0},
                                         {"fingers", "open"},
                                         {"opening", 0.3},
                                         {"largest_opening", 0.3},
                                         {"lift", 0.0},
                                         {"lift_blocked", false}}));
  state.joints[parts_.left.index()] = {0.05, 0.5, false};
  EXPECT_EQ(Json(state)["fingers"], "closing");
  EXPECT_NEAR(Json(state)["opening"].get<double>(), 0.25, 1e-12);
  state.joints[parts_.left.index()] = {0.05, -0.5, false};
  EXPECT_EQ(Json(state)["fingers"], "opening");
  state.joints[parts_.left.index()] = {0.05, 0.0, true};
  EXPECT_EQ(Json(state)["fingers"], "closed");
  const GripperMotion motion = MotionOf(world_.world, parts_.gripper, state);
  EXPECT_FALSE(motion.moves);
  EXPECT_TRUE(motion.blocked);
}

TEST_F(GripperStateTest, ReportsTheHeldObject) {
  test::GripperRun run(world_.world);
  run.Step({{.fingers = 0.5}}, 5);
  ASSERT_TRUE(run.state.objects[box_.index()].holder);
  const std::string name = world_.model(world_.world.objects[0]).name;
  const nlohmann::json json = Json(run.state);
  for (const char* key : {"held", "clamped", "left_contact", "right_contact"}) EXPECT_EQ(json[key], name) << key;
  EXPECT_NEAR(json["opening"].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(json["fingers"], "closed");

  WorldState state = run.state;
  state.objects[box_.index()].holder.reset();
  EXPECT_FALSE(Json(state).contains("held"));
  EXPECT_TRUE(Json(state).contains("clamped"));
}

}  // namespace
}  // namespace troupe::ros
