// The kinds of sensors, each in a source of its own: sensor_suite.h makes them by their type names.
//
// Each maker returns an immutable sensor for one mount, which checks nothing again: the description has passed
// CheckParameters.
#pragma once

#include <memory>

#include "common/sensing/sensor.h"

namespace troupe {

// The blobfinder: stretches of one colour in a row of horizontal rays, one for each column of its image. The first body
// of each ray counts, whatever its returns; its upper and lower edges are those of the block at the finder's height.
// REQUIRES: the description has BlobfinderParameters.
std::unique_ptr<const Sensor> MakeBlobfinder(const SensorMount& mount);

// Break beams: light beams across the gap of a gripper. A beam is broken by the object in it that is nearest to its
// first end (of equals the lowest id), held or not. Only objects break beams; an object that touches a beam does not.
// REQUIRES: the description has BreakBeamParameters.
std::unique_ptr<const Sensor> MakeBreakBeams(const SensorMount& mount);

// The camera: an image of colours, depths and models. The image plane is vertical, so that each column of the image is
// a half plane of the world (column_cast.h), in which every pixel is exact: sides, tops and undersides of blocks, and
// the ground at z 0. A camera that looks up or down is one with a shifted lens: verticals stay vertical.
// REQUIRES: the description has CameraParameters.
std::unique_ptr<const Sensor> MakeCamera(const SensorMount& mount);

// The fiducial finder: recognizes models with a fiducial_return by a clear line of sight, exact at the finder's height.
// Any body hides the ones behind it, whatever its returns; a model is seen by its own body and the parts on it.
// REQUIRES: the description has FiducialParameters.
std::unique_ptr<const Sensor> MakeFiducialFinder(const SensorMount& mount);

// The inertial measurement unit: heading, yaw rate and specific force from the executed motion of the robot and of the
// joints that carry the unit. A robot without motion measures gravity alone.
// REQUIRES: the description has ImuParameters.
std::unique_ptr<const Sensor> MakeImu(const SensorMount& mount);

// The radio: receives the messages of the radios of its channel that are near enough, as RadioParameters says. A
// reading has the messages that arrive at its tick; where the antennas are then decides. A radio does not hear its own
// robot. The draw that loses a message depends on the seed, both radios, the tick and the number of the message alone.
// REQUIRES: the description has RadioParameters.
std::unique_ptr<const Sensor> MakeRadio(const SensorMount& mount);

// The strength in dBm of a message of `radio` at a distance in m, after `losses` dB. A distance below 1 cm counts as 1
// cm.
double RadioStrength(const RadioParameters& radio, double distance, double losses);

// The ranger: laser scanners of one plane or several, and sonar rings. Each range is the exact distance along a ray,
// horizontal or at the elevation of its plane (then also to tops, undersides and the ground), with the noise of the
// description, clamped to the limits of the ray sensor. Noise is a function of (seed, robot, sensor, ray sensor,
// tick, ray).
// REQUIRES: the description has RangerParameters.
std::unique_ptr<const Sensor> MakeRanger(const SensorMount& mount);

}  // namespace troupe
