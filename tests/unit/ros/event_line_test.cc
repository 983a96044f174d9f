#include <gtest/gtest.h>

#include "tests/support/small_world.h"
#include "world-service/service/event_log.h"

namespace troupe {
namespace {

TEST(EventLine, NamesTheRobotAndTheObstacle) {
  SmallWorld world;
  world.AddRobot("r0", {});
  world.AddBox("wall", 5.0, 0.0, 2.0, 1.0, {0.0, 0.5});
  Event event;
  event.tick = 7;
  event.robot = RobotId(0);
  event.other = ModelId(1);
  EXPECT_EQ(EventLine(world.world(), event),
            R"({"detail":"","event":"stall_began","other":"wall","robot":"r0","tick":7})");
}

}  // namespace
}  // namespace troupe
