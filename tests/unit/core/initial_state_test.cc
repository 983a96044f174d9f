#include <gtest/gtest.h>

#include "common/model/states.h"
#include "tests/support/gripper_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

TEST(InitialState, ObjectsOnASupportRestAndThoseInTheAirStayPlaced) {
  test::GripperWorld world;
  const ModelId table = world.AddModel(test::Square(1.0), {0.6, 0.7});
  const ObjectId on_table = world.AddObject({0.0, 0.0, 0.7, 0.0});
  const ObjectId on_ground = world.AddObject({5.0, 0.0, 0.0, 0.0});
  const ObjectId in_air = world.AddObject({8.0, 0.0, 1.0, 0.0});
  const Scene scene(world.world);
  const WorldState state = InitialState(scene);
  EXPECT_EQ(state.tick, 0u);
  EXPECT_EQ(state.objects[on_table.index()].mode, ObjectMode::kResting);
  EXPECT_EQ(state.objects[on_table.index()].support, table);
  EXPECT_EQ(state.objects[on_ground.index()].mode, ObjectMode::kResting);
  EXPECT_EQ(state.objects[on_ground.index()].support, std::nullopt);
  EXPECT_EQ(state.objects[in_air.index()].mode, ObjectMode::kPlaced);
}

TEST(InitialState, HasTheHashOfTheDescriptionsPoses) {
  test::GripperWorld world;
  world.AddModel(test::Square(1.0), {0.6, 0.7});
  world.AddObject({0.0, 0.0, 0.7, 0.0});
  const Scene scene(world.world);
  WorldState state = InitialState(scene);
  EXPECT_NE(state, PlacedState(world.world));
  EXPECT_EQ(StateHash(state), StateHash(PlacedState(world.world)));
  state.tick = 1;
  WorldState unsupported = PlacedState(world.world);
  unsupported.tick = 1;
  EXPECT_NE(StateHash(state), StateHash(unsupported));
}

TEST(InitialState, AStepWithoutProposalsKeepsIt) {
  test::GripperWorld world;
  world.AddModel(test::Square(1.0), {0.6, 0.7});
  world.AddObject({0.0, 0.0, 0.7, 0.0});
  world.AddObject({5.0, 0.0, 0.0, 0.0});
  const Scene scene(world.world);
  const WorldState state = InitialState(scene);
  const StepResult next = Step(scene, state, {});
  EXPECT_EQ(next.state.objects, state.objects);
  EXPECT_TRUE(next.events.empty());
}

}  // namespace
}  // namespace troupe
