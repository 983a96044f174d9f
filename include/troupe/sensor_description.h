// SensorDescription: a sensor that is mounted on a robot, of any kind. A kind is an alternative of SensorParameters: a
// struct with its name (kType), its fields with their limits (fields.h), further rules (Check) if it has any, and a
// summary. From these the description is hashed, checked, sent and recorded; common/sensing has its measurement.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "troupe/color.h"
#include "troupe/fields.h"
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
inline constexpr double kMaxRadioDecibels = 1000.0;        // of powers and losses
inline constexpr double kMaxElevation = 85.0 / 180 * kPi;  // rad, of a ray of a scanner or the edge of an image

// One fan of rays, or several one above another. Frame S: the sensor; rays leave from its origin.
struct RaySensorDescription {
  Pose X_MS;
  Interval range{0.0, 5.0};
  double fov = 0.1;
  std::uint32_t samples = 1;
  double noise_variance = 0.0;
  double noise_proportional = 0.0;
  double noise_angle = 0.0;
  std::vector<double> elevations = {};

  // Planes of rays; 1 without elevations.
  std::size_t planes() const { return elevations.empty() ? 1 : elevations.size(); }
  bool operator==(const RaySensorDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &RaySensorDescription::X_MS, "in the ranger model's frame"},
        Field{"range", &RaySensorDescription::range}.In("m").AtLeast(0),
        Field{"fov", &RaySensorDescription::fov, "the fan spans -fov/2 .. +fov/2, both ends included"}
            .In("rad")
            .AtLeast(0),
        Field{"samples", &RaySensorDescription::samples, "1: a single ray straight ahead"}.Within(1, kMaxRaySamples),
        Field{"noise_variance", &RaySensorDescription::noise_variance, "of a hit's range, m^2"}.AtLeast(0),
        Field{"noise_proportional", &RaySensorDescription::noise_proportional,
              "a hit's range r gets r * this * uniform(-1, 1)"},
        Field{"noise_angle", &RaySensorDescription::noise_angle,
              "a ray's bearing gets uniform(-1, 1) * this * step / 2, as in Stage"}
            .In("rad"),
        Field{"elevations", &RaySensorDescription::elevations,
              "of the planes of a scanner, ascending; none: one horizontal plane"}
            .In("rad")
            .Within(-kMaxElevation, kMaxElevation),
    };
  }
};

// A ranger: one or more ray sensors (a laser scanner has one, a sonar ring many).
struct RangerParameters {
  static constexpr std::string_view kType = "ranger";
  Shared<std::vector<RaySensorDescription>> ray_sensors = {};

  Status Check() const;
  std::string Summary() const;  // "16 sensors, 16 rays"
  bool operator==(const RangerParameters&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"ray_sensors", &RangerParameters::ray_sensors, "one list for the robots of a macro"},
    };
  }
};

// A light beam across the gap of a gripper: broken when an object is between its ends. Frame G: the gripper's model.
struct BreakBeam {
  Vec2 from{0.0, 0.0};
  Vec2 to{0.0, 0.0};
  double z = 0.0;
  bool operator==(const BreakBeam&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"from", &BreakBeam::from, "in G"}.In("m"),
        Field{"to", &BreakBeam::to, "in G"}.In("m"),
        Field{"z", &BreakBeam::z, "in G"}.In("m"),
    };
  }
};

struct BreakBeamParameters {
  static constexpr std::string_view kType = "break_beam";
  std::vector<BreakBeam> beams = {};

  Status Check() const;  // never success: the beams of a robot follow from its grippers
  std::string Summary() const;
  bool operator==(const BreakBeamParameters&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"beams", &BreakBeamParameters::beams},
    };
  }
};

// A fiducial finder: recognizes models with a `fiducial_return` and its key. Frame S: the finder, looking along x.
struct FiducialParameters {
  static constexpr std::string_view kType = "fiducial";
  Pose X_MS = {};
  Interval range{0.0, 8.0};
  double id_range = 5.0;
  double fov = kPi;
  std::int32_t key = 0;
  bool ignores_height = false;

  std::string Summary() const;
  bool operator==(const FiducialParameters&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &FiducialParameters::X_MS},
        Field{"range", &FiducialParameters::range, "between the origins of the finder and the model"}.In("m").AtLeast(
            0),
        Field{"id_range", &FiducialParameters::id_range, "nearer models are identified"}.In("m").AtLeast(0),
        Field{"fov", &FiducialParameters::fov}.In("rad").Within(0, 2 * kPi),
        Field{"key", &FiducialParameters::key, "equal to the model's"},
        Field{"ignores_height", &FiducialParameters::ignores_height,
              "else the line of sight must end on the model's body, at the finder's height"},
    };
  }
};

// One side of a bumper: a straight strip. Frame B: its middle, x pointing away from the robot.
struct BumperSegment {
  Pose X_MB = {};
  double length = 0.0;
  bool operator==(const BumperSegment&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &BumperSegment::X_MB},
        Field{"length", &BumperSegment::length, "along y of B"}.In("m").AtLeast(0),
    };
  }
};

struct BumperParameters {
  static constexpr std::string_view kType = "bumper";
  std::vector<BumperSegment> segments = {};
  double height = 0.0;

  Status Check() const;
  std::string Summary() const;
  bool operator==(const BumperParameters&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"segments", &BumperParameters::segments},
        Field{"height", &BumperParameters::height, "of each segment, upwards from its pose"}.In("m").AtLeast(0),
    };
  }
};

// The contacts of all parts of the robot with other bodies.
struct ContactParameters {
  static constexpr std::string_view kType = "contact";

  std::string Summary() const { return {}; }
  bool operator==(const ContactParameters&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

// A finder of blobs of one colour in a picture of one row of rays. Frame S: the finder, looking along x.
struct BlobfinderParameters {
  static constexpr std::string_view kType = "blobfinder";
  Pose X_MS = {};
  std::uint32_t width = 80;
  std::uint32_t height = 60;
  double range = 12.0;
  double fov = 60.0 / 180 * kPi;
  std::vector<Color> colors = {};

  std::string Summary() const;
  bool operator==(const BlobfinderParameters&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &BlobfinderParameters::X_MS},
        Field{"width", &BlobfinderParameters::width, "of the image; one ray for each column"}.In("pixel").Within(
            1, kMaxImageSide),
        Field{"height", &BlobfinderParameters::height}.In("pixel").Within(1, kMaxImageSide),
        Field{"range", &BlobfinderParameters::range}.In("m").AtLeast(0),
        Field{"fov", &BlobfinderParameters::fov, "of the image's width"}.In("rad").Above(0).AtMost(2 * kPi),
        Field{"colors", &BlobfinderParameters::colors, "that it finds; none: all"},
    };
  }
};

// A camera of colour and depth: a perspective picture on a vertical image plane. Frame S: the camera, looking along x.
struct CameraParameters {
  static constexpr std::string_view kType = "camera";
  Pose X_MS = {};
  std::uint32_t width = 32;
  std::uint32_t height = 32;
  Interval range{0.2, 8.0};
  double fov = 70.0 / 180 * kPi;
  Interval elevation{-20.0 / 180 * kPi, 20.0 / 180 * kPi};

  // rad, upwards: the tilts that a controller can give the camera, added to `elevation`. They contain 0.
  Interval TiltLimits() const;

  Status Check() const;
  std::string Summary() const;
  bool operator==(const CameraParameters&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &CameraParameters::X_MS},
        Field{"width", &CameraParameters::width}.In("pixel").Within(1, kMaxImageSide),
        Field{"height", &CameraParameters::height}.In("pixel").Within(1, kMaxImageSide),
        Field{"range", &CameraParameters::range, "of depths"}.In("m").AtLeast(0),
        Field{"fov", &CameraParameters::fov, "of the width"}.In("rad").Above(0).AtMost(2 * kMaxElevation),
        Field{"elevation", &CameraParameters::elevation, "of the lower and the upper edge, in the middle"}
            .In("rad")
            .Within(-kMaxElevation, kMaxElevation),
    };
  }
};

// A radio: sends messages of the robot, and receives messages of other radios of its channel. Frame S: the antenna. How
// far a message reaches follows from the sender's parameters: its strength falls with the distance d as power - 10
// path_loss_exponent log10(d / 1 m), and by `wall_loss` and `body_loss` for each wall and body between the antennas; it
// is received if it is as strong as without them at the distance `range`.
struct RadioParameters {
  static constexpr std::string_view kType = "radio";
  Pose X_MS = {};
  std::int32_t channel = 0;
  double range = 10.0;
  double bandwidth = 10e3;
  double delay = 0.0;
  double loss = 0.0;
  double range_loss = 0.0;
  double power = 20.0;
  double path_loss_exponent = 2.0;
  double wall_loss = 10.0;
  double body_loss = 3.0;
  bool range_and_bearing = false;
  double range_noise = 0.0;
  double bearing_noise = 0.0;

  std::string Summary() const;
  bool operator==(const RadioParameters&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &RadioParameters::X_MS},
        Field{"channel", &RadioParameters::channel, "radios of other channels do not hear it"},
        Field{"range", &RadioParameters::range, "of its messages, between the antennas, without walls"}.In("m").AtLeast(
            0),
        Field{"bandwidth", &RadioParameters::bandwidth, "that it can send"}.In("byte/s").AtLeast(0),
        Field{"delay", &RadioParameters::delay, "until a message arrives, rounded up to whole ticks"}.In("s").Within(
            0, kMaxRadioDelay),
        Field{"loss", &RadioParameters::loss, "the probability that a receiver in range loses a message"}.Within(0, 1),
        Field{"range_loss", &RadioParameters::range_loss,
              "the probability of another loss, at `range`; in proportion to the distance"}
            .Within(0, 1),
        Field{"power", &RadioParameters::power, "of its messages at 1 m"}.In("dBm").Within(-kMaxRadioDecibels,
                                                                                           kMaxRadioDecibels),
        Field{"path_loss_exponent", &RadioParameters::path_loss_exponent,
              "how fast the strength falls; 2 as in free space"}
            .Within(1e-3, 100),
        Field{"wall_loss", &RadioParameters::wall_loss, "lost at each wall between the antennas"}.In("dB").Within(
            0, kMaxRadioDecibels),
        Field{"body_loss", &RadioParameters::body_loss, "lost at each robot or object between the antennas"}
            .In("dB")
            .Within(0, kMaxRadioDecibels),
        Field{"range_and_bearing", &RadioParameters::range_and_bearing,
              "it measures the ranges and bearings of the senders"},
        Field{"range_noise", &RadioParameters::range_noise, "standard deviation of the ranges"}.In("m").AtLeast(0),
        Field{"bearing_noise", &RadioParameters::bearing_noise, "standard deviation of the bearings"}.In("rad").AtLeast(
            0),
    };
  }
};

// An inertial measurement unit: its heading, its yaw rate and its specific force. Frame S: the unit. Errors are
// normally distributed with these standard deviations: noise is drawn for each measurement, a bias once for each unit.
struct ImuParameters {
  static constexpr std::string_view kType = "imu";
  Pose X_MS = {};
  double heading_noise = 0.0;
  double gyro_noise = 0.0;
  double gyro_bias = 0.0;
  double acceleration_noise = 0.0;
  double acceleration_bias = 0.0;

  std::string Summary() const { return {}; }
  bool operator==(const ImuParameters&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"pose", &ImuParameters::X_MS},
        Field{"heading_noise", &ImuParameters::heading_noise, "standard deviation of the heading"}.In("rad").AtLeast(0),
        Field{"gyro_noise", &ImuParameters::gyro_noise, "standard deviation of the yaw rate"}.In("rad/s").AtLeast(0),
        Field{"gyro_bias", &ImuParameters::gyro_bias, "standard deviation of its constant error"}.In("rad/s").AtLeast(
            0),
        Field{"acceleration_noise", &ImuParameters::acceleration_noise,
              "standard deviation of the force along each axis"}
            .In("m/s^2")
            .AtLeast(0),
        Field{"acceleration_bias", &ImuParameters::acceleration_bias, "standard deviation of its constant error"}
            .In("m/s^2")
            .AtLeast(0),
    };
  }
};

using SensorParameters =
    std::variant<RangerParameters, BreakBeamParameters, FiducialParameters, BumperParameters, ContactParameters,
                 BlobfinderParameters, CameraParameters, RadioParameters, ImuParameters>;

struct SensorDescription {
  std::string name = {};
  ModelId model = {};
  std::uint32_t period_ticks = 1;
  SensorParameters parameters = {};
  std::string frame = {};
  bool operator==(const SensorDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &SensorDescription::name,
              "unique on its robot: the model's name without the robot's, \"ranger:0\""},
        Field{"model", &SensorDescription::model, "frame M; in the robot's tree"},
        Field{"period", &SensorDescription::period_ticks, "due at every tick that is a multiple of this"}
            .In("tick")
            .AtLeast(1),
        Field{"parameters", &SensorDescription::parameters},
        Field{"frame", &SensorDescription::frame, "of its messages in ROS; empty: one with the name of its topic"},
    };
  }
};

// Name of a kind of sensor: "ranger", "break_beam", ...
std::string_view TypeOf(const SensorParameters& parameters);

// Parameters of this kind with their defaults; nothing if the kind is not known.
std::optional<SensorParameters> DefaultParameters(std::string_view type);

// Success for parameters that a robot may have: all fields within their limits, and the rules of the kind.
Status CheckParameters(const SensorParameters& parameters);

// A summary to be read, not parsed: "16 sensors, 16 rays"; may be empty.
std::string SummaryOf(const SensorParameters& parameters);

}  // namespace troupe
