#include "common/spatial/scene_cache.h"

#include <gtest/gtest.h>

#include "tests/support/small_world.h"

namespace troupe {
namespace {

TEST(SceneCacheTest, FindsTheSceneOfADescriptionWhileItIsInUse) {
  SceneCache scenes;
  auto scene = std::make_shared<const Scene>(Yard(1));
  const Shared<WorldDescription> equal = Yard(1);
  const Scene* const made = scene.get();
  EXPECT_EQ(scenes.Find(WorldOf(scene)), nullptr);
  scenes.Add(scene);
  scenes.Add(scene);
  EXPECT_EQ(scenes.Find(WorldOf(scene)), scene);
  EXPECT_EQ(scenes.Find(equal), nullptr) << "it is another object";

  std::optional<Shared<WorldDescription>> world = WorldOf(scene);  // as in a message
  scene.reset();
  EXPECT_EQ(scenes.Find(*world).get(), made);
  const WorldDescription copy = **world;
  world.reset();
  EXPECT_EQ(scenes.Find(copy), nullptr);
}

}  // namespace
}  // namespace troupe
