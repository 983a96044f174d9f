// Hand-overs of loads (LoadOrder) in worlds/fleet_hall.world.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

#include "troupe/simulation.h"

namespace troupe {
namespace {

class LoadsTest : public testing::Test {
 protected:
  static Simulation Load() {
    SimulationOptions options;
    options.run_controllers = false;
    Result<Simulation> loaded =
        Simulation::Load(std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/fleet_hall.world", options);
    if (!loaded.ok()) throw std::runtime_error(loaded.error().ToString());
    return std::move(loaded).value();
  }

  ModelId ModelOf(const std::string& name) const {
    const std::vector<ModelDescription>& models = simulation_.world().models;
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (models[i].name == name) return ModelId(i);
    }
    throw std::runtime_error("no model " + name);
  }
  Pose PoseOf(const std::string& name) const { return simulation_.FindPose(name).value(); }

  // Whether the order is accepted, and the object has been moved by it.
  bool Moves(const char* robot, const LoadOrder& order, const std::string& object) {
    const Pose before = PoseOf(object);
    const Status status = simulation_.Drive(*simulation_.FindRobot(robot), {.orders = {order}});
    EXPECT_TRUE(status.ok()) << status.error().message;
    simulation_.Step();
    return PoseOf(object).translation() != before.translation();
  }
  bool Takes(const char* robot, const std::string& object) { return Moves(robot, {.object = ModelOf(object)}, object); }
  bool PutsDown(const char* robot, const std::string& object, double x, double y) {
    return Moves(robot, {.object = ModelOf(object), .takes = false, .x = x, .y = y}, object);
  }

  Simulation simulation_ = Load();
};

TEST_F(LoadsTest, AnObjectRidesOnTheRobotAndIsPutDown) {
  ASSERT_TRUE(simulation_.SetPose("cart_1", {-5.0, 1.0, 0.0, 0.0}).ok());
  ASSERT_TRUE(Takes("cart_1", "pallet_1"));
  EXPECT_DOUBLE_EQ(PoseOf("pallet_1").z, 0.3);
  EXPECT_THAT(simulation_.events(), testing::Contains(testing::Field(&Event::type, EventType::kGripped)));
  ASSERT_TRUE(simulation_.DriveBy(*simulation_.FindRobot("cart_1"), {0.5, 0.0, 0.0}).ok());
  simulation_.Step(40);
  EXPECT_EQ(PoseOf("pallet_1").translation(), PoseOf("cart_1").translation());
  EXPECT_GT(PoseOf("pallet_1").x, -4.0);
  const double x = PoseOf("cart_1").x;
  ASSERT_TRUE(PutsDown("cart_1", "pallet_1", x, 2.0));
  simulation_.Step(20);
  EXPECT_DOUBLE_EQ(PoseOf("pallet_1").z, 0.0);
}

TEST_F(LoadsTest, AnOrderThatCannotBeExecutedHasNoEffect) {
  EXPECT_FALSE(Takes("cart_1", "pallet_1"));  // too far
  ASSERT_TRUE(simulation_.SetPose("cart_1", {-5.0, 1.0, 0.0, 0.0}).ok());
  EXPECT_FALSE(PutsDown("cart_1", "pallet_1", -3.0, 0.0));  // it does not carry it
  ASSERT_TRUE(simulation_.SetPose("pallet_2", {-5.4, 2.2, 0.55, 0.0}).ok());
  simulation_.Step(5);
  EXPECT_FALSE(Takes("cart_1", "pallet_1"));  // below another one
  ASSERT_TRUE(simulation_.SetPose("pallet_2", {-4.6, 2.2, 0.25, 0.0}).ok());
  simulation_.Step(5);
  ASSERT_TRUE(Takes("cart_1", "pallet_1"));
  EXPECT_FALSE(Takes("cart_1", "pallet_2"));  // no room
  ASSERT_TRUE(simulation_.SetPose("cart_2", {-3.5, 1.0, 0.0, 0.0}).ok());
  EXPECT_FALSE(Takes("cart_2", "pallet_1"));                // on another robot
  EXPECT_FALSE(PutsDown("cart_1", "pallet_1", -4.6, 2.2));  // taken
  EXPECT_FALSE(PutsDown("cart_1", "pallet_1", 3.0, 1.0));   // too far
}

TEST_F(LoadsTest, AnOrderForSomethingElseIsRefused) {
  const RobotId cart = *simulation_.FindRobot("cart_1");
  for (const char* const name : {"rack_a", "cart_2", "north"}) {
    EXPECT_FALSE(simulation_.Drive(cart, {.orders = {LoadOrder{.object = ModelOf(name)}}}).ok()) << name;
  }
  EXPECT_FALSE(simulation_.Drive(cart, {.orders = {LoadOrder{.object = ModelId(9999)}}}).ok());
  EXPECT_FALSE(simulation_.AddInput({.robot = cart, .order = LoadOrder{.object = ModelOf("pallet_1")}}).ok());
}

}  // namespace
}  // namespace troupe
