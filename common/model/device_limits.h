// The limits of a drive: the agent keeps its proposals within them, the world service refuses proposals beyond them.
//
// One function for both sides, so that they cannot disagree: the agent clamps what its controller wants, and the
// service, which must not trust an agent, checks the proposal by the same arithmetic up to rounding. Pure functions;
// twists in m/s and rad/s in frame R.
#pragma once

#include "troupe/pose.h"
#include "troupe/world_description.h"

namespace troupe {

// The twist, in R, nearest to `desired` that the drive reaches from `current` within `seconds`: within the velocity
// bounds, and changing no faster than the acceleration bounds, where the bounds leave room for that (a robot faster
// than its velocity bound brakes as hard as it can). A differential drive has no vy. For a car, `velocity.x` bounds the
// speed of the steered wheel and `velocity.heading` the steering angle.
Twist ClampToLimits(const DriveDescription& drive, const Twist& current, const Twist& desired, double seconds);

// True if ClampToLimits would not change `proposed`, up to rounding (1e-9).
bool WithinLimits(const DriveDescription& drive, const Twist& current, const Twist& proposed, double seconds);

// The twist of a car whose steered wheel runs at `speed` (m/s) with steering angle `steering` (rad): vx = speed
// cos(steering), wz = speed sin(steering) / wheelbase.
Twist CarTwist(double speed, double steering, double wheelbase);

}  // namespace troupe
