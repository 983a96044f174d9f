// The poses of the models of a state: forward kinematics of robots, joints and objects.
#pragma once

#include <span>
#include <vector>

#include "troupe/pose.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// The motion of the joint's model at position `q` (m or rad): X_PM(q) = X_PM * JointMotion(q).
Pose JointMotion(const JointDescription& joint, double q);

// Poses of all models in a state, frame W, in id order. REQUIRES: the state belongs to the world.
std::vector<Pose> ModelPoses(const WorldDescription& world, const WorldState& state);

}  // namespace troupe
