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
#include "troupe/fields.h"
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
  double fov = 0.0;
  std::size_t count = 1;

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
  static constexpr auto Fields() {
    return std::tuple{
        Field{"fov", &RayFan::fov, "from the first ray to the last; the width of the cone of a single ray"}.In("rad"),
        Field{"count", &RayFan::count, "rays; a single one points straight ahead"},
    };
  }
};

// The fans of rays of a ray sensor from the origin of S, one for each plane. A flat sensor has one plane, z = 0 of S.
struct ScanGeometry {
  RayFan fan = {};
  std::vector<double> elevations = {};
  Pose X_RS = {};
  Interval limits = {};
  double variance = 0.0;

  std::size_t planes() const { return elevations.empty() ? 1 : elevations.size(); }
  double elevation(std::size_t plane) const { return elevations.empty() ? 0.0 : elevations[plane]; }
  std::size_t rays() const { return planes() * fan.count; }
  bool operator==(const ScanGeometry&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"fan", &ScanGeometry::fan, "of each plane"},
        Field{"elevations", &ScanGeometry::elevations,
              "above the horizontal, by plane, ascending; none: one horizontal plane"}
            .In("rad"),
        Field{"pose", &ScanGeometry::X_RS, "of the sensor in R at the measurement: a lift or an arm moves it"},
        Field{"limits", &ScanGeometry::limits}.In("m"),
        Field{"variance", &ScanGeometry::variance, "of the noise that does not depend on the range, m^2"},
    };
  }
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
// scans are one list, and robots that are alike share the geometry: a swarm has many readings, and measures all of them
// in each tick.
struct RangerReading {
  std::vector<double> ranges = {};
  std::vector<double> intensities = {};
  Shared<std::vector<ScanGeometry>> geometry = {};

  // Copies of the scans. REQUIRES: i < geometry->size()
  RangeScan scan(std::size_t i) const;
  std::vector<RangeScan> scans() const;
  // Where the scan begins in `ranges`.
  std::size_t first_ray(std::size_t scan) const;

  bool operator==(const RangerReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"ranges", &RangerReading::ranges, "of all scans, scan by scan, as in RangeScan"}.In("m"),
        Field{"intensities", &RangerReading::intensities, "of all scans, scan by scan, as in RangeScan"},
        Field{"geometry", &RangerReading::geometry, "by scan"},
    };
  }
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
    BreakBeam beam = {};
    std::optional<ObjectId> broken_by = {};
    bool operator==(const Beam&) const = default;
    static constexpr auto Fields() {
      return std::tuple{
          Field{"beam", &Beam::beam, "in G"},
          Field{"broken_by", &Beam::broken_by, "the object in the beam that is nearest to its first end"},
      };
    }
  };
  ModelId gripper_model = {};
  std::vector<Beam> beams = {};
  bool operator==(const BreakBeamReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"gripper_model", &BreakBeamReading::gripper_model, "frame G"},
        Field{"beams", &BreakBeamReading::beams},
    };
  }
};

// A model that a fiducial finder recognizes.
struct Fiducial {
  std::int32_t id = 0;
  ModelId model = {};
  double range = 0.0;
  double bearing = 0.0;
  Pose X_SF = {};
  Pose X_WF = {};
  double size_x = 0.0;
  double size_y = 0.0;
  double size_z = 0.0;
  bool operator==(const Fiducial&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"id", &Fiducial::id, "its fiducial_return; 0 if it is too far to be identified"},
        Field{"model", &Fiducial::model},
        Field{"range", &Fiducial::range, "between the origins, in the plane"}.In("m"),
        Field{"bearing", &Fiducial::bearing, "in S"}.In("rad"),
        Field{"pose_in_sensor", &Fiducial::X_SF, "of the model F in S"},
        Field{"pose", &Fiducial::X_WF, "of the model F in W"},
        Field{"size_x", &Fiducial::size_x, "of the model"}.In("m"),
        Field{"size_y", &Fiducial::size_y, "of the model"}.In("m"),
        Field{"size_z", &Fiducial::size_z, "of the model"}.In("m"),
    };
  }
};

struct FiducialReading {
  Pose X_RS = {};
  Interval limits = {};
  double fov = 0.0;
  std::vector<Fiducial> fiducials = {};
  bool operator==(const FiducialReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &FiducialReading::X_RS, "of the sensor in R"},
        Field{"limits", &FiducialReading::limits}.In("m"),
        Field{"fov", &FiducialReading::fov}.In("rad"),
        Field{"fiducials", &FiducialReading::fiducials, "by model id"},
    };
  }
};

struct BumperReading {
  struct Segment {
    Pose X_RB = {};
    double length = 0.0;
    std::optional<ModelId> pressed_by = {};
    bool operator==(const Segment&) const = default;
    static constexpr auto Fields() {
      return std::tuple{
          Field{"pose", &Segment::X_RB, "of its middle in R, x pointing away from the robot"},
          Field{"length", &Segment::length, "along y of B"}.In("m"),
          Field{"pressed_by", &Segment::pressed_by,
                "the body in contact with it, of several the one with the least id"},
      };
    }
  };
  double height = 0.0;
  std::vector<Segment> segments = {};
  bool operator==(const BumperReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"height", &BumperReading::height, "of each segment, upwards"}.In("m"),
        Field{"segments", &BumperReading::segments},
    };
  }
};

// A part of the robot that touches another body.
struct BodyContact {
  ModelId part = {};
  ModelId other = {};
  Vec2 point{0.0, 0.0};
  double z_min = 0.0;
  double z_max = 0.0;
  bool operator==(const BodyContact&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"part", &BodyContact::part, "of the robot"},
        Field{"other", &BodyContact::other, "the body"},
        Field{"point", &BodyContact::point, "in W, the middle between the nearest points"}.In("m"),
        Field{"z_min", &BodyContact::z_min, "in W, of the heights at which they touch"}.In("m"),
        Field{"z_max", &BodyContact::z_max, "in W, of the heights at which they touch"}.In("m"),
    };
  }
};

struct ContactReading {
  std::vector<BodyContact> contacts = {};
  bool operator==(const ContactReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"contacts", &ContactReading::contacts, "by part, then by other; each pair once"},
    };
  }
};

// A stretch of neighbouring columns of the image in which the same colour is seen. Pixels count from the upper left
// corner; right and bottom are beyond the last ones.
struct Blob {
  Color color = {};
  std::uint32_t left = 0;
  std::uint32_t top = 0;
  std::uint32_t right = 0;
  std::uint32_t bottom = 0;
  double range = 0.0;
  bool operator==(const Blob&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"color", &Blob::color},
        Field{"left", &Blob::left}.In("pixel"),
        Field{"top", &Blob::top}.In("pixel"),
        Field{"right", &Blob::right, "beyond the last"}.In("pixel"),
        Field{"bottom", &Blob::bottom, "beyond the last"}.In("pixel"),
        Field{"range", &Blob::range, "the shortest of its columns"}.In("m"),
    };
  }
};

struct BlobfinderReading {
  Pose X_RS = {};
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double fov = 0.0;
  double range = 0.0;
  std::vector<Blob> blobs = {};
  bool operator==(const BlobfinderReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &BlobfinderReading::X_RS, "of the sensor in R"},
        Field{"width", &BlobfinderReading::width}.In("pixel"),
        Field{"height", &BlobfinderReading::height}.In("pixel"),
        Field{"fov", &BlobfinderReading::fov, "of the width"}.In("rad"),
        Field{"range", &BlobfinderReading::range}.In("m"),
        Field{"blobs", &BlobfinderReading::blobs, "from left to right"},
    };
  }
};

// An image on a vertical plane ahead of the camera: a perspective picture, as by a pinhole camera with the focal
// lengths and the principal point (center_x, center_y). Rows from the top, in each from the left.
struct CameraReading {
  Pose X_RS = {};
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double focal_length_x = 0.0;
  double focal_length_y = 0.0;
  double center_x = 0.0;
  double center_y = 0.0;
  Interval limits = {};
  std::vector<std::uint8_t> colors = {};
  std::vector<float> depths = {};
  std::vector<std::int32_t> models = {};
  static constexpr std::int32_t kGround = -1;
  static constexpr std::int32_t kNothing = -2;
  bool operator==(const CameraReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &CameraReading::X_RS, "of the sensor in R"},
        Field{"width", &CameraReading::width}.In("pixel"),
        Field{"height", &CameraReading::height}.In("pixel"),
        Field{"focal_length_x", &CameraReading::focal_length_x, "of the columns"}.In("pixel"),
        Field{"focal_length_y", &CameraReading::focal_length_y, "of the rows"}.In("pixel"),
        Field{"center_x", &CameraReading::center_x, "from the left edge"}.In("pixel"),
        Field{"center_y", &CameraReading::center_y,
              "from the upper edge; may be outside of the image, as of a shifted lens"}
            .In("pixel"),
        Field{"limits", &CameraReading::limits}.In("m"),
        Field{"colors", &CameraReading::colors, "red, green, blue of each pixel"},
        Field{"depths", &CameraReading::depths,
              "ahead (not along the ray); -Inf: below the limits, +Inf: beyond, or no hit"}
            .In("m"),
        Field{"models", &CameraReading::models, "the model seen; kGround, kNothing"},
    };
  }
};

// A message that a radio receives.
struct RadioReception {
  // The place of the sender's antenna, seen from the receiver's.
  struct Place {
    double range = 0.0;
    double bearing = 0.0;
    double elevation = 0.0;
    bool operator==(const Place&) const = default;
    static constexpr auto Fields() {
      return std::tuple{
          Field{"range", &Place::range}.In("m"),
          Field{"bearing", &Place::bearing, "in S"}.In("rad"),
          Field{"elevation", &Place::elevation, "above the horizontal"}.In("rad"),
      };
    }
  };
  RobotId from = {};
  bool to_all = false;
  std::vector<std::uint8_t> bytes = {};
  double rssi = 0.0;
  Tick tick = 0;
  std::optional<Place> place = {};
  bool operator==(const RadioReception&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"from", &RadioReception::from},
        Field{"to_all", &RadioReception::to_all, "else to this robot alone"},
        Field{"bytes", &RadioReception::bytes},
        Field{"rssi", &RadioReception::rssi, "strength with which it arrives"}.In("dBm"),
        Field{"tick", &RadioReception::tick, "in which it was sent"}.In("tick"),
        Field{"place", &RadioReception::place, "of a radio with range_and_bearing"},
    };
  }
};

// The reading of a radio: the messages that arrive at the tick of the reading.
struct RadioReading {
  Pose X_RS = {};
  double range = 0.0;
  std::vector<RadioReception> receptions = {};
  bool operator==(const RadioReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &RadioReading::X_RS, "of the sensor in R"},
        Field{"range", &RadioReading::range, "of the messages that it sends"}.In("m"),
        Field{"receptions", &RadioReading::receptions, "by tick, then by sender, then in the order of sending"},
    };
  }
};

// The reading of an inertial measurement unit: an accelerometer and a gyroscope that measure the executed motion.
struct ImuReading {
  Pose X_RS = {};
  double heading = 0.0;
  double turn = 0.0;
  Vec2 force_xy{0.0, 0.0};
  double force_z = 0.0;
  double heading_noise = 0.0;
  double turn_noise = 0.0;
  double force_noise = 0.0;
  bool operator==(const ImuReading&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &ImuReading::X_RS, "of the sensor in R"},
        Field{"heading", &ImuReading::heading, "of S in W"}.In("rad"),
        Field{"turn", &ImuReading::turn, "about z"}.In("rad/s"),
        Field{"force", &ImuReading::force_xy,
              "specific force along x and y of S: the mean acceleration from the tick before to this one"}
            .In("m/s^2"),
        Field{"force_z", &ImuReading::force_z, "specific force along z, upwards, with gravity"}.In("m/s^2"),
        Field{"heading_noise", &ImuReading::heading_noise, "standard deviation"}.In("rad"),
        Field{"turn_noise", &ImuReading::turn_noise, "standard deviation"}.In("rad/s"),
        Field{"force_noise", &ImuReading::force_noise, "standard deviation"}.In("m/s^2"),
    };
  }
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
