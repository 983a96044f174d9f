#include "common/model/state_hash.h"

#include "common/base/hash.h"

namespace troupe {

std::uint64_t StateHash(const WorldState& state) {
  Hasher hasher;
  hasher.Add(state.tick);
  for (const RobotState& robot : state.robots) {
    hasher.Add(robot.X_WR.x);
    hasher.Add(robot.X_WR.y);
    hasher.Add(robot.X_WR.z);
    hasher.Add(robot.X_WR.heading);
    hasher.Add(robot.twist.vx);
    hasher.Add(robot.twist.vy);
    hasher.Add(robot.twist.wz);
    hasher.Add(std::uint64_t{robot.stalled});
  }
  return hasher.value();
}

}  // namespace troupe
