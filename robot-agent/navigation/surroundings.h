// Surroundings: the world as a robot that watches other bodies sees it in a tick, and the first thing that its own body
// would meet.
//
// The view is of the whole state, as the agent has it; how far a controller looks is its own affair. It lives for one
// decision and is cheap to copy.
#pragma once

#include <optional>

#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/vec2.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

class BodyIndex;
class Scene;

const WorldDescription& WorldIn(const Scene& scene);

// A state with its scene and its bodies, in one tick.
struct Surroundings {
  const Scene& scene;
  const BodyIndex& bodies;
  const WorldState& state;

  const WorldDescription& world() const;
  const Pose& PoseOf(RobotId robot) const;  // X_WR
};

// The first contact of the robot, if it were at X_WR and moved by `way` m along `direction` (a unit vector, W) without
// turning. Nothing: there is none.
struct ContactAhead {
  ModelId model;      // with which
  double room = 0.0;  // m, that the robot can move until then
};
std::optional<ContactAhead> FindContactAhead(const Surroundings& around, RobotId own, const Pose& X_WR,
                                             const Vec2& direction, double way);
// The same, if it turned on the spot by `angle` rad (to the left, if positive); `room` is in rad then.
std::optional<ContactAhead> FindContactInTurn(const Surroundings& around, RobotId own, const Pose& X_WR, double angle);

// The root of the model that a link or a part belongs to.
ModelId RootOf(const Surroundings& around, ModelId model);

// A controller that sees the other bodies of its world.
class RobotWatcher {
 public:
  virtual ~RobotWatcher() = default;
  // Called before each Update, with the same tick; all of it lives until that has returned.
  virtual void WatchRobots(const Surroundings& around) = 0;
};

}  // namespace troupe
