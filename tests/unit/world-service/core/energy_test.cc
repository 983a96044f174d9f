#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/model/states.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "world-service/core/step.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

constexpr double kTick = 0.1;  // s

// A robot with a store, east of whose front at x = 0.2 a charger begins.
class EnergyTest : public testing::Test {
 protected:
  EnergyTest() : robot_(world_.AddRobot("r", {})) {
    Power(robot_) = {.has_store = true, .joules = 50.0, .capacity = 100.0, .watts = 4.0, .take_watts = 30.0};
  }

  PowerDescription& Power(RobotId robot) { return world_.world().models[world_.robot(robot).root.index()].power; }
  PowerDescription& AddCharger(double x = 0.4, double z = 0.0) {
    ModelDescription& charger = world_.AddBox("charger", x, 0.0, 0.4, 0.4, {z, z + 0.5});
    charger.power = {.has_store = true, .endless = true, .give_watts = 20.0};
    return charger.power;
  }
  // The state after some steps with the same twist.
  WorldState After(int ticks, const Twist& twist = {}) {
    const Scene scene(world_.world());
    EXPECT_TRUE(Validate(scene.world()).ok()) << Validate(scene.world()).error().message;
    WorldState state = InitialState(scene);
    for (int i = 0; i < ticks; ++i) {
      StepResult result = Step(scene, state, {{{robot_, twist}}});
      state = std::move(result.state);
      for (const Event& event : result.events) events_.push_back(event);
    }
    EXPECT_TRUE(CheckState(scene.world(), state).ok());
    return state;
  }

  SmallWorld world_;
  RobotId robot_;
  std::vector<Event> events_;
};

TEST_F(EnergyTest, AStoreLosesWhatItsModelsConsume) {
  world_.AddPart(robot_, "lamp", {}, 0.1, 0.1, {0.0, 0.1}).power.watts = 3.0;
  const WorldState state = After(20);
  EXPECT_NEAR(state.stores.at(0).joules, 50.0 - 20 * kTick * 7.0, 1e-9);
  EXPECT_EQ(state.stores[0].charge_watts, 0.0);
}

TEST_F(EnergyTest, MotionConsumesByTheMass) {
  Power(robot_).mass = 2.0;
  const WorldState state = After(10, {.vx = -0.5, .wz = 0.25});
  EXPECT_NEAR(state.stores.at(0).joules, 50.0 - 10 * kTick * (4.0 + 10.0 * 2.0 * 0.75), 1e-9);
}

TEST_F(EnergyTest, APartWithAStoreOfItsOwnIsFedByThat) {
  PowerDescription& part = world_.AddPart(robot_, "lamp", {}, 0.1, 0.1, {0.0, 0.1}).power;
  part = {.has_store = true, .joules = 9.0, .capacity = 9.0, .watts = 3.0};
  const WorldState state = After(10);
  EXPECT_NEAR(state.stores.at(0).joules, 46.0, 1e-9);
  EXPECT_NEAR(state.stores.at(1).joules, 6.0, 1e-9);
}

TEST_F(EnergyTest, ARobotWithoutEnergyStopsWithOneEvent) {
  Power(robot_).joules = 1.0;  // of which a tick consumes 0.4 J
  const WorldState state = After(10, {.vx = 0.5});
  EXPECT_EQ(state.stores.at(0).joules, 0.0);
  EXPECT_NEAR(state.robots[0].X_WR.x, 3 * 0.05, 1e-12);
  EXPECT_TRUE(state.robots[0].twist.IsZero());
  ASSERT_EQ(events_.size(), 1u);
  EXPECT_EQ(events_[0], (Event{.tick = 3, .type = EventType::kOutOfEnergy, .robot = robot_}));
}

TEST_F(EnergyTest, ARobotWithoutEnergySendsNothing) {
  test::AddSensor(world_.world(), robot_, {}, RadioParameters{});
  Power(robot_).joules = 0.0;
  const Scene scene(world_.world());
  Proposal proposal{robot_, {}};
  proposal.messages.push_back({0, {}, {1}});
  EXPECT_TRUE(Step(scene, InitialState(scene), {{proposal}}).state.transmissions.empty());
}

TEST_F(EnergyTest, AnEmptyRobotAtAChargerDrivesAgain) {
  Power(robot_).joules = 0.0;
  AddCharger();
  const WorldState state = After(2, {.vx = -0.5});
  EXPECT_NEAR(state.robots[0].X_WR.x, -0.05, 1e-12) << "charged in the first tick, it drives in the second";
}

TEST_F(EnergyTest, ChargesAtTheLesserRateUpToTheCapacity) {
  AddCharger();
  EXPECT_NEAR(After(10).stores.at(0).joules, 50.0 + 10 * kTick * (20.0 - 4.0), 1e-9);
  EXPECT_EQ(After(10).stores[0].charge_watts, 20.0);
  EXPECT_NEAR(After(1000).stores[0].joules, 100.0, 1e-9);
  EXPECT_NEAR(After(1000).stores[0].charge_watts, 4.0, 1e-9) << "what it consumes";
  Power(robot_).take_watts = 10.0;
  EXPECT_NEAR(After(10).stores.at(0).joules, 50.0 + 10 * kTick * (10.0 - 4.0), 1e-9);
}

TEST_F(EnergyTest, ChargesOnlyInContact) {
  AddCharger(0.4 + 0.9e-3);
  EXPECT_GT(After(1).stores.at(0).joules, 50.0);
  world_.world().models.back().X_PM.x += 0.2e-3;
  EXPECT_LT(After(1).stores.at(0).joules, 50.0);
  world_.world().models.back().X_PM = {0.3, 0.0, 0.402, 0.0};  // above the robot
  EXPECT_LT(After(1).stores.at(0).joules, 50.0);
  world_.world().models.back().X_PM.z = 0.4;  // on it
  EXPECT_GT(After(1).stores.at(0).joules, 50.0);
}

TEST_F(EnergyTest, AChargerNeedNotCollide) {
  AddCharger(0.0);
  world_.world().models.back().obstacle_return = false;
  EXPECT_GT(After(1).stores.at(0).joules, 50.0);
}

TEST_F(EnergyTest, ATakerTouchesWithItsChildren) {
  AddCharger(0.5);
  EXPECT_LT(After(1).stores.at(0).joules, 50.0);
  world_.AddPart(robot_, "plug", {0.25, 0.0, 0.0, 0.0}, 0.1, 0.1, {0.0, 0.1});
  EXPECT_GT(After(1).stores.at(0).joules, 50.0);
}

TEST_F(EnergyTest, AGiverTouchesWithItsChildren) {
  AddCharger(0.5);
  const ModelId charger(world_.world().models.size() - 1);
  EXPECT_LT(After(1).stores.at(0).joules, 50.0);
  world_.AddBox("socket", -0.25, 0.0, 0.1, 0.1, {0.0, 0.1}).parent = charger;
  EXPECT_GT(After(1).stores.at(0).joules, 50.0);
}

TEST_F(EnergyTest, ARobotChargesAStaticModel) {
  Power(robot_) = {.has_store = true, .joules = 30.0, .capacity = 30.0, .give_watts = 50.0};
  AddCharger() = {.has_store = true, .joules = 0.0, .capacity = 100.0, .take_watts = 20.0};
  const WorldState state = After(5);
  EXPECT_NEAR(state.stores.at(0).joules, 30.0 - 5 * kTick * 20.0, 1e-9);
  EXPECT_NEAR(state.stores.at(1).joules, 5 * kTick * 20.0, 1e-9);
}

TEST_F(EnergyTest, AGiverGivesItsRateAndItsStockInAllTakersTogether) {
  PowerDescription& charger = AddCharger();
  charger.endless = false;
  charger.joules = charger.capacity = 5.0;
  const RobotId other = world_.AddRobot("other", {0.8, 0.0, 0.0, 0.0});  // on the other side of the charger
  Power(other) = {.has_store = true, .joules = 0.0, .capacity = 100.0, .take_watts = 15.0};
  Power(robot_).take_watts = 12.0;
  Power(robot_).watts = 0.0;
  WorldState state = After(1);
  ASSERT_EQ(state.stores.size(), 3u);
  EXPECT_NEAR(state.stores[0].joules, 51.2, 1e-9);
  EXPECT_NEAR(state.stores[1].joules, 3.0, 1e-9) << "20 W are given";
  EXPECT_NEAR(state.stores[2].joules, 0.8, 1e-9) << "what the first taker has left";
  state = After(10);
  EXPECT_NEAR(state.stores[1].joules, 0.0, 1e-9);
  EXPECT_NEAR(state.stores[0].joules + state.stores[2].joules, 55.0, 1e-9);
}

TEST_F(EnergyTest, ARobotChargesAnother) {
  const RobotId other = world_.AddRobot("other", {0.4, 0.0, 0.0, 0.0});
  Power(other) = {.has_store = true, .joules = 30.0, .capacity = 30.0, .give_watts = 50.0};
  const WorldState state = After(5);
  EXPECT_NEAR(state.stores.at(0).joules, 50.0 + 5 * kTick * (30.0 - 4.0), 1e-9);
  EXPECT_NEAR(state.stores.at(1).joules, 30.0 - 5 * kTick * 30.0, 1e-9);
}

TEST_F(EnergyTest, StoresChangeTheHashOnlyWhereThereAreAny) {
  WorldState state = After(1);
  const std::uint64_t hash = StateHash(state);
  state.stores[0].joules += 1.0;
  EXPECT_NE(StateHash(state), hash);
  WorldState without = state;
  without.stores.clear();
  Power(robot_) = {};
  EXPECT_EQ(StateHash(without), StateHash(After(1)));
}

TEST_F(EnergyTest, ThreadsChangeNothing) {
  for (int i = 1; i < 40; ++i) {
    const RobotId robot = world_.AddRobot("r" + std::to_string(i), {0.7 * (i % 8), 0.7 * (i / 8), 0.0, 0.1 * i});
    Power(robot) = {.has_store = true,
                    .joules = 1.0 + i,
                    .capacity = 60.0,
                    .watts = 2.0,
                    .mass = 1.0,
                    .give_watts = i % 3 == 0 ? 9.0 : 0.0,
                    .take_watts = 5.0};
  }
  const Scene scene(world_.world());
  WorldState one = InitialState(scene);
  WorldState two = one;
  Stepper stepper(scene, std::make_shared<ThreadPool>(3));
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < 40; ++i) proposals.push_back({RobotId(i), {.vx = 0.3, .wz = 0.2}});
  for (int tick = 0; tick < 100; ++tick) {
    one = Step(scene, one, proposals).state;
    two = stepper.Step(two, proposals).state;
    ASSERT_EQ(one, two);
  }
}

}  // namespace
}  // namespace troupe
