// SensorDescription: a sensor that is mounted on a robot, of any kind. A kind is an alternative of SensorParameters: a
// struct with its name (kType), its parts (VisitFields), its rules (Check) and a summary. From these the description is
// hashed, checked, sent and recorded; common/sensing has its measurement.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "troupe/color.h"
#include "troupe/ids.h"
#include "troupe/interval.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/shared.h"
#include "troupe/vec2.h"

namespace troupe {

inline constexpr std::uint32_t kMaxRaySamples = 100'000;   // of one ray sensor, in one plane
inline constexpr std::uint32_t kMaxRays = 4'000'000;       // of one ray sensor, in all its planes
inline constexpr std::uint32_t kMaxImageSide = 4096;       // pixels
inline constexpr std::uint32_t kMaxBumpers = 1000;         // segments of one bumper
inline constexpr double kMaxRadioDelay = 60.0;             // s
inline constexpr double kMaxElevation = 85.0 / 180 * kPi;  // rad, of a ray of a scanner or the edge of an image

// One fan of rays, or several one above another. Frame S: the sensor; rays leave from its origin.
struct RaySensorDescription {
  Pose X_MS;                        // in the ranger model's frame
  Interval range{0.0, 5.0};         // m
  double fov = 0.1;                 // rad; the fan spans -fov/2 .. +fov/2, both ends included
  std::uint32_t samples = 1;        // 1 to kMaxRaySamples; 1: a single ray straight ahead
  double noise_variance = 0.0;      // m^2, added to a hit's range
  double noise_proportional = 0.0;  // a hit's range r gets r * this * uniform(-1, 1)
  double noise_angle = 0.0;         // rad: a ray's bearing gets uniform(-1, 1) * this * step / 2, as in Stage
  // rad, above the horizontal: of each plane of a scanner with several, ascending. Empty: one horizontal plane.
  std::vector<double> elevations = {};

  // Planes of rays; 1 without elevations.
  std::size_t planes() const { return elevations.empty() ? 1 : elevations.size(); }
  bool operator==(const RaySensorDescription&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("pose", self.X_MS);
    visit("range", self.range);
    visit("fov", self.fov);
    visit("samples", self.samples);
    visit("noise_variance", self.noise_variance);
    visit("noise_proportional", self.noise_proportional);
    visit("noise_angle", self.noise_angle);
    visit("elevations", self.elevations);
  }
};

// A ranger: one or more ray sensors (a laser scanner has one, a sonar ring many).
struct RangerParameters {
  static constexpr std::string_view kType = "ranger";
  Shared<std::vector<RaySensorDescription>> ray_sensors = {};  // robots of one macro have one list

  Status Check() const;
  std::string Summary() const;  // "16 sensors, 16 rays"
  bool operator==(const RangerParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("ray_sensors", self.ray_sensors);
  }
};

// A light beam across the gap of a gripper: broken when an object is between its ends. Frame G: the gripper's model.
struct BreakBeam {
  Vec2 from{0.0, 0.0};  // m, in frame G
  Vec2 to{0.0, 0.0};    // m, in frame G
  double z = 0.0;       // m, in frame G
  bool operator==(const BreakBeam&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("from", self.from);
    visit("to", self.to);
    visit("z", self.z);
  }
};

struct BreakBeamParameters {
  static constexpr std::string_view kType = "break_beam";
  std::vector<BreakBeam> beams = {};

  Status Check() const;  // never success: the beams of a robot follow from its grippers
  std::string Summary() const;
  bool operator==(const BreakBeamParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("beams", self.beams);
  }
};

// A fiducial finder: recognizes models with a `fiducial_return` and its key. Frame S: the finder, looking along x.
struct FiducialParameters {
  static constexpr std::string_view kType = "fiducial";
  Pose X_MS = {};
  Interval range{0.0, 8.0};     // m, between the origins of the finder and the model
  double id_range = 5.0;        // m: nearer models are identified
  double fov = kPi;             // rad; up to 2 pi
  std::int32_t key = 0;         // equal to the model's
  bool ignores_height = false;  // else the line of sight must end on the model's body, at the finder's height

  Status Check() const;
  std::string Summary() const;
  bool operator==(const FiducialParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("pose", self.X_MS);
    visit("range", self.range);
    visit("id_range", self.id_range);
    visit("fov", self.fov);
    visit("key", self.key);
    visit("ignores_height", self.ignores_height);
  }
};

// One side of a bumper: a straight strip. Frame B: its middle, x pointing away from the robot.
struct BumperSegment {
  Pose X_MB = {};
  double length = 0.0;  // m, along y of B
  bool operator==(const BumperSegment&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("pose", self.X_MB);
    visit("length", self.length);
  }
};

struct BumperParameters {
  static constexpr std::string_view kType = "bumper";
  std::vector<BumperSegment> segments = {};
  double height = 0.0;  // m, of every segment, upwards from its pose

  Status Check() const;
  std::string Summary() const;
  bool operator==(const BumperParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("segments", self.segments);
    visit("height", self.height);
  }
};

// The contacts of all parts of the robot with other bodies.
struct ContactParameters {
  static constexpr std::string_view kType = "contact";

  Status Check() const { return {}; }
  std::string Summary() const { return {}; }
  bool operator==(const ContactParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& /*self*/, Visit /*visit*/) {}
};

// A finder of blobs of one colour in a picture of one row of rays. Frame S: the finder, looking along x.
struct BlobfinderParameters {
  static constexpr std::string_view kType = "blobfinder";
  Pose X_MS = {};
  std::uint32_t width = 80;  // pixels of the image; one ray for each column
  std::uint32_t height = 60;
  double range = 12.0;             // m
  double fov = 60.0 / 180 * kPi;   // rad, of the image's width; up to 2 pi
  std::vector<Color> colors = {};  // that it finds; empty: all

  Status Check() const;
  std::string Summary() const;
  bool operator==(const BlobfinderParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("pose", self.X_MS);
    visit("width", self.width);
    visit("height", self.height);
    visit("range", self.range);
    visit("fov", self.fov);
    visit("colors", self.colors);
  }
};

// A camera of colour and depth: a perspective picture on a vertical image plane. Frame S: the camera, looking along x.
struct CameraParameters {
  static constexpr std::string_view kType = "camera";
  Pose X_MS = {};
  std::uint32_t width = 32;  // pixels
  std::uint32_t height = 32;
  Interval range{0.2, 8.0};                                 // m, of depths
  double fov = 70.0 / 180 * kPi;                            // rad, of the width; below pi
  Interval elevation{-20.0 / 180 * kPi, 20.0 / 180 * kPi};  // rad, of the lower and the upper edge, in the middle

  // rad, upwards: the tilts that a controller can give the camera, added to `elevation`. They contain 0.
  Interval TiltLimits() const;

  Status Check() const;
  std::string Summary() const;
  bool operator==(const CameraParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("pose", self.X_MS);
    visit("width", self.width);
    visit("height", self.height);
    visit("range", self.range);
    visit("fov", self.fov);
    visit("elevation", self.elevation);
  }
};

// A radio: sends messages of the robot, and receives those of other radios of its channel. Frame S: the antenna. How
// far a message reaches follows from the sender's parameters: its strength falls with the distance d as power - 10
// path_loss_exponent log10(d / 1 m), and by `wall_loss` and `body_loss` for each wall and body between the antennas; it
// is received if it is as strong as without them at the distance `range`.
struct RadioParameters {
  static constexpr std::string_view kType = "radio";
  Pose X_MS = {};
  std::int32_t channel = 0;
  double range = 10.0;              // m, between the antennas, without walls
  double bandwidth = 10e3;          // bytes/s that it can send
  double delay = 0.0;               // s until a message arrives, rounded up to whole ticks
  double loss = 0.0;                // the probability that a receiver in range loses a message
  double range_loss = 0.0;          // the probability of another loss, at `range`; in proportion to the distance
  double power = 20.0;              // dBm, at 1 m
  double path_loss_exponent = 2.0;  // 2: as in free space
  double wall_loss = 10.0;          // dB, of each wall between the antennas
  double body_loss = 3.0;           // dB, of each robot or object between them
  // It measures the ranges and bearings of the senders of the messages that it receives, with these standard deviations
  // in m and rad.
  bool range_and_bearing = false;
  double range_noise = 0.0;
  double bearing_noise = 0.0;

  Status Check() const;
  std::string Summary() const;
  bool operator==(const RadioParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("pose", self.X_MS);
    visit("channel", self.channel);
    visit("range", self.range);
    visit("bandwidth", self.bandwidth);
    visit("delay", self.delay);
    visit("loss", self.loss);
    visit("range_loss", self.range_loss);
    visit("power", self.power);
    visit("path_loss_exponent", self.path_loss_exponent);
    visit("wall_loss", self.wall_loss);
    visit("body_loss", self.body_loss);
    visit("range_and_bearing", self.range_and_bearing);
    visit("range_noise", self.range_noise);
    visit("bearing_noise", self.bearing_noise);
  }
};

// An inertial measurement unit: its heading, its yaw rate and its specific force. Frame S: the unit. Each error is a
// normal one: noise is drawn anew for each measurement, a bias once for each unit, and all with these standard
// deviations.
struct ImuParameters {
  static constexpr std::string_view kType = "imu";
  Pose X_MS = {};
  double heading_noise = 0.0;       // rad
  double gyro_noise = 0.0;          // rad/s
  double gyro_bias = 0.0;           // rad/s
  double acceleration_noise = 0.0;  // m/s^2, along each axis, like the next
  double acceleration_bias = 0.0;   // m/s^2

  Status Check() const;
  std::string Summary() const { return {}; }
  bool operator==(const ImuParameters&) const = default;
  template <typename Self, typename Visit>
  static void VisitFields(Self& self, Visit visit) {
    visit("pose", self.X_MS);
    visit("heading_noise", self.heading_noise);
    visit("gyro_noise", self.gyro_noise);
    visit("gyro_bias", self.gyro_bias);
    visit("acceleration_noise", self.acceleration_noise);
    visit("acceleration_bias", self.acceleration_bias);
  }
};

using SensorParameters =
    std::variant<RangerParameters, BreakBeamParameters, FiducialParameters, BumperParameters, ContactParameters,
                 BlobfinderParameters, CameraParameters, RadioParameters, ImuParameters>;

struct SensorDescription {
  std::string name = {};           // unique on its robot: the model's name without the robot's, "ranger:0"
  ModelId model = {};              // frame M; in the robot's tree
  std::uint32_t period_ticks = 1;  // due at every tick that is a multiple of this
  SensorParameters parameters = {};
  bool operator==(const SensorDescription&) const = default;
};

// Name of a kind of sensor: "ranger", "break_beam", ...
std::string_view TypeOf(const SensorParameters& parameters);

// The parameters as named lists of numbers, in SI units and in the order of VisitFields.
struct SensorField {
  std::string name;
  std::vector<double> numbers;
};
std::vector<SensorField> FieldsOf(const SensorParameters& parameters);
// The inverse. The error names the type or the field that is not known, not complete or out of range.
Result<SensorParameters> ParametersFrom(std::string_view type, std::span<const SensorField> fields);

// Success for parameters that a robot may have: all numbers within kMaxMagnitude, and the rules of the kind.
Status CheckParameters(const SensorParameters& parameters);

// For people: "16 sensors, 16 rays"; may be empty.
std::string SummaryOf(const SensorParameters& parameters);

}  // namespace troupe
