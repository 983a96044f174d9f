// The velocity of a point of a robot, with the motion of its drive and of the joints that move the point.
#pragma once

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/world_state.h"

namespace troupe {

struct PointVelocity {
  Vec2 xy{0.0, 0.0};  // m/s, in W
  double z = 0.0;     // m/s
  double turn = 0.0;  // rad/s, about z
};

// Of the origin of frame S, at X_MS on `model`, with the twist and the joint velocities of `state`.
// REQUIRES: `bodies` is an index of `scene` at `state`, and `model` is of a robot.
PointVelocity VelocityOf(const Scene& scene, const BodyIndex& bodies, const WorldState& state, ModelId model,
                         const Pose& X_MS);

}  // namespace troupe
