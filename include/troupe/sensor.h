// The readings of sensors, as controllers receive them and Simulation::Measure returns them. SensorReading is the
// result of one measurement of one sensor, of any kind, with the geometry that gives the numbers their meaning: a
// consumer needs no description of the sensor. Plain values; a reading has no errors.
//
//   SensorReading ── RangerReading: scans, one for each ray sensor ── RangeScan: ranges and intensities by ray
//                 ├─ BreakBeamReading: beams of one gripper
//                 ├─ FiducialReading: the models that a fiducial finder recognizes
//                 ├─ BumperReading: the segments of a bumper, pressed or not
//                 ├─ ContactReading: the contacts of all parts of the robot
//                 ├─ BlobfinderReading: blobs of one colour
//                 ├─ CameraReading: an image of colours, depths and models
//                 ├─ RadioReading: the messages that a radio receives
//                 └─ ImuReading: heading, yaw rate and specific force
//
// The descriptions of sensors (SensorDescription, RangerParameters, ...) come with this header.
//
// Frames: W world, R robot, S sensor, G the model of a gripper; X_RS is the pose of S in R, x ahead. Units: m, rad.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "troupe/color.h"
#include "troupe/ids.h"
#include "troupe/interval.h"
#include "troupe/pose.h"
#include "troupe/sensor_description.h"
#include "troupe/shared.h"
#include "troupe/vec2.h"

namespace troupe {

// The bearings of a fan of rays. All users of a fan (ray casting, controllers, pictures, ROS messages) obtain its
// bearings here.
struct RayFan {
  double fov = 0.0;       // rad, from the first ray to the last; the width of the cone of a single ray
  std::size_t count = 1;  // rays; a single one points straight ahead

  // Bearing of ray i in frame S, rad, counter-clockwise. The first is exactly -fov/2, the last exactly fov/2, and ray i
  // exactly the negative of ray count - 1 - i. REQUIRES: i < count
  double Bearing(std::size_t i) const {
    if (count < 2) return 0.0;
    const double last = static_cast<double>(count - 1);
    // From the middle outwards, for the symmetry.
    return fov * ((2.0 * static_cast<double>(i) - last) / (2.0 * last));
  }

  // rad. Bearing(i) is angle_min() + i * angle_increment() up to rounding.
  double angle_min() const { return Bearing(0); }
  double angle_max() const { return count < 2 ? 0.0 : Bearing(count - 1); }
  double angle_increment() const { return count < 2 ? 0.0 : fov / static_cast<double>(count - 1); }

  bool operator==(const RayFan&) const = default;
};

// The fans of rays of a ray sensor from the origin of S, one for each plane. A flat sensor has one plane, z = 0 of S.
struct ScanGeometry {
  RayFan fan = {};                      // of each plane
  std::vector<double> elevations = {};  // rad above the horizontal, by plane, ascending; empty: one horizontal plane
  Pose X_RS = {};                       // at the measurement: a lift or an arm moves it
  Interval limits = {};                 // m
  double variance = 0.0;                // m^2, of the noise that does not depend on the range

  std::size_t planes() const { return elevations.empty() ? 1 : elevations.size(); }
  double elevation(std::size_t plane) const { return elevations.empty() ? 0.0 : elevations[plane]; }
  std::size_t rays() const { return planes() * fan.count; }
  bool operator==(const ScanGeometry&) const = default;
};

// The plane nearest to the horizontal.
inline std::size_t FlattestPlane(const ScanGeometry& scan) {
  std::size_t flattest = 0;
  for (std::size_t plane = 1; plane < scan.planes(); ++plane) {
    if (std::abs(scan.elevation(plane)) < std::abs(scan.elevation(flattest))) flattest = plane;
  }
  return flattest;
}

// The scan of one ray sensor: ranges[p * fan.count + i] and intensities[...] belong to the bearing fan.Bearing(i) in
// frame S, at the elevation of plane p.
struct RangeScan : ScanGeometry {
  std::vector<double> ranges = {};       // m along the ray, within `limits`; limits.max without a hit
  std::vector<double> intensities = {};  // ranger_return of the hit, 0 without one
  bool operator==(const RangeScan&) const = default;
};

// The reading of a ranger: one scan for each of its ray sensors, in the order of the world file. The numbers of all
// scans are one list, and robots that are alike share the geometry: a swarm has many readings, and measures them anew
// in each tick.
struct RangerReading {
  std::vector<double> ranges = {};                  // of all scans, scan by scan, as in RangeScan
  std::vector<double> intensities = {};             // likewise
  Shared<std::vector<ScanGeometry>> geometry = {};  // by scan

  // Copies of the scans. REQUIRES: i < geometry->size()
  RangeScan scan(std::size_t i) const;
  std::vector<RangeScan> scans() const;
  // Where the scan begins in `ranges`.
  std::size_t first_ray(std::size_t scan) const;

  bool operator==(const RangerReading&) const = default;
};

inline std::size_t RangerReading::first_ray(std::size_t scan) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < scan; ++i) first += (*geometry)[i].rays();
  return first;
}

inline RangeScan RangerReading::scan(std::size_t i) const {
  RangeScan scan{(*geometry)[i]};
  const auto first = static_cast<std::ptrdiff_t>(first_ray(i));
  const auto end = first + static_cast<std::ptrdiff_t>(scan.rays());
  scan.ranges.assign(ranges.begin() + first, ranges.begin() + end);
  scan.intensities.assign(intensities.begin() + first, intensities.begin() + end);
  return scan;
}

inline std::vector<RangeScan> RangerReading::scans() const {
  std::vector<RangeScan> scans;
  for (std::size_t i = 0; i < geometry->size(); ++i) scans.push_back(scan(i));
  return scans;
}

// The reading of the break beams of a gripper.
struct BreakBeamReading {
  struct Beam {
    BreakBeam beam = {};                     // in G
    std::optional<ObjectId> broken_by = {};  // the object in the beam that is nearest to its first end
    bool operator==(const Beam&) const = default;
  };
  ModelId gripper_model = {};  // frame G
  std::vector<Beam> beams = {};
  bool operator==(const BreakBeamReading&) const = default;
};

// A model that a fiducial finder recognizes.
struct Fiducial {
  std::int32_t id = 0;  // its fiducial_return; 0 if it is too far to be identified
  ModelId model = {};
  double range = 0.0;    // m, between the origins, in the plane
  double bearing = 0.0;  // rad, in S
  Pose X_SF = {};        // of the model F
  Pose X_WF = {};
  double size_x = 0.0;  // m, of the model
  double size_y = 0.0;
  double size_z = 0.0;
  bool operator==(const Fiducial&) const = default;
};

struct FiducialReading {
  Pose X_RS = {};
  Interval limits = {};                  // m
  double fov = 0.0;                      // rad
  std::vector<Fiducial> fiducials = {};  // by model id
  bool operator==(const FiducialReading&) const = default;
};

struct BumperReading {
  struct Segment {
    Pose X_RB = {};                          // its middle, x pointing away from the robot
    double length = 0.0;                     // m, along y of B
    std::optional<ModelId> pressed_by = {};  // the body in contact with it, of several the one with the least id
    bool operator==(const Segment&) const = default;
  };
  double height = 0.0;  // m, of each segment, upwards
  std::vector<Segment> segments = {};
  bool operator==(const BumperReading&) const = default;
};

// A part of the robot that touches another body.
struct BodyContact {
  ModelId part = {};     // of the robot
  ModelId other = {};    // the body
  Vec2 point{0.0, 0.0};  // m, in W: the middle between the nearest points
  double z_min = 0.0;    // m, in W: the heights at which they touch
  double z_max = 0.0;
  bool operator==(const BodyContact&) const = default;
};

struct ContactReading {
  std::vector<BodyContact> contacts = {};  // by part, then by other; each pair once
  bool operator==(const ContactReading&) const = default;
};

// A stretch of neighbouring columns of the image in which the same colour is seen. Pixels count from the upper left
// corner; right and bottom are beyond the last ones.
struct Blob {
  Color color = {};
  std::uint32_t left = 0;
  std::uint32_t top = 0;
  std::uint32_t right = 0;
  std::uint32_t bottom = 0;
  double range = 0.0;  // m, the shortest of its columns
  bool operator==(const Blob&) const = default;
};

struct BlobfinderReading {
  Pose X_RS = {};
  std::uint32_t width = 0;  // pixels
  std::uint32_t height = 0;
  double fov = 0.0;              // rad, of the width
  double range = 0.0;            // m
  std::vector<Blob> blobs = {};  // from left to right
  bool operator==(const BlobfinderReading&) const = default;
};

// An image on a vertical plane ahead of the camera: a perspective picture, as by a pinhole camera with the focal
// lengths and the principal point (center_x, center_y). Rows from the top, in each from the left.
struct CameraReading {
  Pose X_RS = {};
  std::uint32_t width = 0;  // pixels
  std::uint32_t height = 0;
  double focal_length_x = 0.0;  // pixels, of the columns
  double focal_length_y = 0.0;  // pixels, of the rows
  double center_x = 0.0;        // pixels from the left edge
  double center_y = 0.0;        // pixels from the upper edge; may be outside of the image, as of a shifted lens
  Interval limits = {};         // m
  std::vector<std::uint8_t> colors = {};  // red, green, blue of each pixel
  std::vector<float> depths = {};  // m ahead (not along the ray); -Inf: below the limits, +Inf: beyond, or no hit
  std::vector<std::int32_t> models = {};  // the model seen; kGround, kNothing
  static constexpr std::int32_t kGround = -1;
  static constexpr std::int32_t kNothing = -2;
  bool operator==(const CameraReading&) const = default;
};

// A message that a radio receives.
struct RadioReception {
  // The place of the sender's antenna, seen from the receiver's.
  struct Place {
    double range = 0.0;      // m
    double bearing = 0.0;    // rad, in S
    double elevation = 0.0;  // rad, above the horizontal
    bool operator==(const Place&) const = default;
  };
  RobotId from = {};
  bool to_all = false;  // else to this robot alone
  std::vector<std::uint8_t> bytes = {};
  double rssi = 0.0;                // dBm, the strength with which it arrives
  Tick tick = 0;                    // in which it was sent
  std::optional<Place> place = {};  // of a radio with range_and_bearing
  bool operator==(const RadioReception&) const = default;
};

// The reading of a radio: the messages that arrive at the tick of the reading.
struct RadioReading {
  Pose X_RS = {};
  double range = 0.0;                           // m, of the messages that it sends
  std::vector<RadioReception> receptions = {};  // by tick, then by sender, then in the order of sending
  bool operator==(const RadioReading&) const = default;
};

// The reading of an inertial measurement unit: an accelerometer and a gyroscope that measure the executed motion.
struct ImuReading {
  Pose X_RS = {};
  double heading = 0.0;  // rad, of S in W
  double turn = 0.0;     // rad/s, about z
  // The specific force along x, y and z of S, m/s^2: the mean acceleration from the tick before to this one, and
  // upwards that of gravity.
  Vec2 force_xy{0.0, 0.0};
  double force_z = 0.0;
  // The standard deviations of the noise in the above.
  double heading_noise = 0.0;
  double turn_noise = 0.0;
  double force_noise = 0.0;
  bool operator==(const ImuReading&) const = default;
};

struct SensorReading {
  Tick tick = 0;  // of the measurement; a sensor with a long period keeps its last reading
  // The reading of each kind of sensor; std::monostate: never measured.
  std::variant<std::monostate, RangerReading, BreakBeamReading, FiducialReading, BumperReading, ContactReading,
               BlobfinderReading, CameraReading, RadioReading, ImuReading>
      content = {};

  bool empty() const { return std::holds_alternative<std::monostate>(content); }
  // Null if the reading is empty or of another kind. Not of a temporary, which ends before its content is read.
  const RangerReading* ranger() const& { return std::get_if<RangerReading>(&content); }
  const RangerReading* ranger() const&& = delete;
  const BreakBeamReading* break_beams() const& { return std::get_if<BreakBeamReading>(&content); }
  const BreakBeamReading* break_beams() const&& = delete;
  // The same for any kind: As<FiducialReading>().
  template <typename Reading>
  const Reading* As() const& {
    return std::get_if<Reading>(&content);
  }
  template <typename Reading>
  const Reading* As() const&& = delete;

  bool operator==(const SensorReading&) const = default;
};

}  // namespace troupe
