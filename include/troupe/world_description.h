// WorldDescription: everything about a world that only edits change after loading. Plain values: the content of a world
// file, in SI units, with every default filled in. Together with a WorldState (world_state.h) it is the whole
// simulation.
//
// Invariants (Validate checks them):
// - a model's parent has a smaller id than the model;
// - names are unique, but for removed models, and not empty; numbers are finite and within kMaxMagnitude
//   (geometry/limits.h); outlines are normalized (geometry/polygon.h);
// - robots are in the order of their root models; a robot's root has no parent (its tree moves freely);
// - joints are in the order of their models, which belong to robots and are no roots; one model, one joint;
// - no two robots that are there have one ROS domain of their own;
// - grippers are in the order of their models; their joints and pads are of the same robot and below its root;
// - only models that never move, so neither robots nor objects nor parts of them, have shapes with an area;
// - objects are in order, have gripper_return or are leaves of doors or cabins of lifts, have no parent, and are no
// roots of robots;
// - doors are in the order of their models, which never move, and so are lifts; an object is at most once a leaf or a
// cabin;
// - people are in the order of their root models, which have no parent and are neither robots nor objects; the leader
// of a person precedes it and has none; goal sets and the choices among them exist;
// - levels ascend, and so do the numbers of lane graphs; the vertices, doors, lifts and floors that lanes name exist.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/color.h"
#include "troupe/door_description.h"
#include "troupe/enum_names.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/interval.h"
#include "troupe/person_description.h"
#include "troupe/pixel_area.h"
#include "troupe/polygon.h"
#include "troupe/pose.h"
#include "troupe/rectangle.h"
#include "troupe/result.h"
#include "troupe/sensor_description.h"
#include "troupe/site_description.h"
#include "troupe/z_range.h"

namespace troupe {

// A prism: an outline in the model's frame M, extruded over a height interval above the model's base.
struct Block {
  Polygon outline;
  ZRange z;
  bool operator==(const Block&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"outline", &Block::outline, "normalized, in M"}.In("m"),
        Field{"z", &Block::z, "above the model's pose"}.In("m"),
    };
  }
};

// The solid body of one or more models of the same geometry.
struct Shape {
  std::vector<Block> blocks;
  std::vector<Rectangle> rectangles;
  ZRange rectangles_z;
  // The same for a bitmap with too many rectangles for its pixels, instead of a list. Only shapes of static models have
  // one.
  std::optional<PixelArea> area = {};

  bool empty() const { return blocks.empty() && rectangles.empty() && !area; }
  bool operator==(const Shape&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"blocks", &Shape::blocks},
        Field{"rectangles", &Shape::rectangles, "occupied area of a bitmap, in M; they do not overlap"},
        Field{"rectangles_z", &Shape::rectangles_z, "of all rectangles, or of the area"},
        Field{"areas", &Shape::area, "at most one, in place of rectangles"},
    };
  }
};

// The shape with the rectangles of its area as a list, or as blocks where the area is turned.
Shape Listed(Shape shape);

// A light that blinks while it is switched on. In each period it is on first; a period of 0: it is not
// a light.
struct Blinking {
  std::int64_t period_ns = 0;
  std::int64_t on_ns = 0;
  bool is_switched_on = true;

  bool is_light() const { return period_ns > 0; }
  bool IsOnAt(std::int64_t time_ns) const { return time_ns % period_ns < on_ns; }  // REQUIRES: is_light()
  bool operator==(const Blinking&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"blink_period", &Blinking::period_ns, "of a light; 0: it is none"}.In("ns").AtLeast(0),
        Field{"blink_on", &Blinking::on_ns, "from the beginning of each period; 0: always off; the period: always on"}
            .In("ns")
            .AtLeast(0),
        Field{"switched_on", &Blinking::is_switched_on,
              "at load; a robot's controller switches its lights (LightState)"},
    };
  }
};

inline constexpr double kMaxEnergy = 1e12;  // J, W or kg

// The energy of a model: what it consumes, stores, gives and takes. A model is fed by its own store, or by that of its
// nearest ancestor that has one; a model without either consumes nothing.
struct PowerDescription {
  bool has_store = false;
  bool endless = false;
  double joules = 0.0;
  double capacity = 0.0;
  double watts = 0.0;
  double mass = 0.0;
  double give_watts = 0.0;
  double take_watts = 0.0;
  bool operator==(const PowerDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"has_store", &PowerDescription::has_store},
        Field{"endless", &PowerDescription::endless, "the store never empties"},
        Field{"joules", &PowerDescription::joules, "in the store at load"}.In("J").Within(0, kMaxEnergy),
        Field{"capacity", &PowerDescription::capacity}.In("J").Within(0, kMaxEnergy),
        Field{"watts", &PowerDescription::watts, "consumed all the time"}.In("W").Within(0, kMaxEnergy),
        Field{"mass", &PowerDescription::mass, "of a robot: it consumes 10 W per kg and m/s or rad/s while it moves"}
            .In("kg")
            .Within(0, kMaxEnergy),
        Field{"give_watts", &PowerDescription::give_watts, "given, at the most, to models that touch it"}
            .In("W")
            .Within(0, kMaxEnergy),
        Field{"take_watts", &PowerDescription::take_watts, "taken, at the most, from models that it touches"}
            .In("W")
            .Within(0, kMaxEnergy),
    };
  }
};

// The pixels of a ROS map that a model was made from, occupied or not: its image begins at the model's origin. Only the
// maps that are made of a world depend on it, so it does not count for a world's hash.
struct MapGrid {
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  double resolution = 0.0;
  bool operator==(const MapGrid&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"map_columns", &MapGrid::columns, "0: the model is no map"},
        Field{"map_rows", &MapGrid::rows},
        Field{"map_resolution", &MapGrid::resolution, "side of a pixel"}.In("m").AtLeast(0),
    };
  }
};

struct ModelDescription {
  std::string name;
  std::string type;
  std::optional<ModelId> parent;
  Pose X_PM;
  ShapeId shape;
  double size_x = 0.0;
  double size_y = 0.0;
  double size_z = 0.0;
  Color color;
  bool obstacle_return = true;
  double ranger_return = 1.0;
  bool gripper_return = false;
  std::int32_t fiducial_return = 0;
  std::int32_t fiducial_key = 0;
  bool show_nose = false;
  Blinking blinking = {};
  PowerDescription power = {};
  MapGrid map = {};
  bool removed = false;
  bool operator==(const ModelDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &ModelDescription::name, "unique; of a child \"parent.child\""},
        Field{"type", &ModelDescription::type, "as in the world file: \"model\", \"position\", \"ranger\", ..."},
        Field{"parent", &ModelDescription::parent},
        Field{"pose_in_parent", &ModelDescription::X_PM,
              "at load, in the world's frame without parent; stacking is included"},
        Field{"shape", &ModelDescription::shape},
        Field{"size_x", &ModelDescription::size_x, "as declared"}.In("m"),
        Field{"size_y", &ModelDescription::size_y, "as declared"}.In("m"),
        Field{"size_z", &ModelDescription::size_z, "as declared"}.In("m"),
        Field{"color", &ModelDescription::color},
        Field{"obstacle_return", &ModelDescription::obstacle_return, "collides"},
        Field{"ranger_return", &ModelDescription::ranger_return,
              "intensity of a ranger's hit; negative: transparent to rangers"},
        Field{"gripper_return", &ModelDescription::gripper_return, "may be gripped, moved and dropped"},
        Field{"fiducial_return", &ModelDescription::fiducial_return, "identifier for fiducial finders; 0: none"},
        Field{"fiducial_key", &ModelDescription::fiducial_key, "only finders with the same key find it"},
        Field{"show_nose", &ModelDescription::show_nose, "pictures show its heading"},
        Field{"blinking", &ModelDescription::blinking, "of a light"},
        Field{"power", &ModelDescription::power},
        Field{"map", &ModelDescription::map},
        Field{"removed", &ModelDescription::removed,
              "by an edit: it keeps its id, but has no body, and its name is free"},
    };
  }
};

// The colour of the model's body at a simulated time: that of a light that is off is dark. `is_switched_on`: of a
// light.
Color ColorAt(const ModelDescription& model, std::int64_t time_ns, bool is_switched_on);

enum class DriveType : std::uint8_t {
  kDifferential,  // vx, wz
  kOmni,          // vx, vy, wz
  kCar,           // speed and steering angle; the twist is vx, wz
};
constexpr auto NamesOf(DriveType) {
  return std::array{"differential", "omni", "car"};
}
constexpr auto StageWordsOf(DriveType) {
  return std::array{"diff", "omni", "car"};
}

// Bounds of each component of a twist (m/s, m/s, rad/s) or of its rate of change (m/s^2, m/s^2, rad/s^2).
struct TwistBounds {
  Interval x;
  Interval y;
  Interval heading;
  bool operator==(const TwistBounds&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"x", &TwistBounds::x},
        Field{"y", &TwistBounds::y},
        Field{"heading", &TwistBounds::heading},
    };
  }
};

struct DriveDescription {
  DriveType type = DriveType::kDifferential;
  double wheelbase = 1.0;
  TwistBounds velocity;
  TwistBounds acceleration;
  bool operator==(const DriveDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"type", &DriveDescription::type},
        Field{"wheelbase", &DriveDescription::wheelbase, "of a car"}.In("m").Above(0),
        Field{"velocity", &DriveDescription::velocity},
        Field{"acceleration", &DriveDescription::acceleration,
              "min: strongest braking or reversing (<= 0); max: strongest speeding up (>= 0)"},
    };
  }
};

enum class LocalizationType : std::uint8_t {
  kGps,       // the pose estimate is the true pose
  kOdometry,  // the pose estimate adds up motion, with errors
};
constexpr auto NamesOf(LocalizationType) {
  return std::array{"gps", "odometry"};
}
constexpr auto StageWordsOf(LocalizationType) {
  return std::array{"gps", "odom"};
}

struct LocalizationDescription {
  LocalizationType type = LocalizationType::kGps;
  Pose origin;
  double error_x = 0.0;
  double error_y = 0.0;
  double error_heading = 0.0;
  bool operator==(const LocalizationDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"type", &LocalizationDescription::type},
        Field{"origin", &LocalizationDescription::origin, "of frame odom"},
        Field{"error_x", &LocalizationDescription::error_x,
              "of odometry, relative: a motion d is read as d * (1 + error)"},
        Field{"error_y", &LocalizationDescription::error_y, "of odometry, relative, as error_x"},
        Field{"error_heading", &LocalizationDescription::error_heading, "of odometry, relative, as error_x"},
    };
  }
};

enum class JointType : std::uint8_t {
  kPrismatic,  // shifts the model along the axis
  kRevolute,   // turns it about the vertical through its origin
};
constexpr auto NamesOf(JointType) {
  return std::array{"prismatic", "revolute"};
}
constexpr auto StageWordsOf(JointType) {
  return std::array{"linear", "rotational"};
}

// One degree of freedom of a robot: its model, with everything below, moves relative to the parent. At position q the
// model's pose is X_PM * (a shift by q * axis, or a turn by q).
struct JointDescription {
  std::string name;
  RobotId robot;
  ModelId model;
  JointType type = JointType::kPrismatic;
  Vec2 axis_xy{0.0, 0.0};
  double axis_z = 1.0;
  Interval position;
  double start = 0.0;
  double max_speed = 1.0;
  bool operator==(const JointDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &JointDescription::name, "the model's name without the robot's: \"gripper.lift\""},
        Field{"robot", &JointDescription::robot},
        Field{"model", &JointDescription::model, "in the robot's tree, not its root"},
        Field{"type", &JointDescription::type},
        Field{"axis", &JointDescription::axis_xy,
              "with axis_z a unit vector in the model's frame; revolute: (0, 0, 1)"},
        Field{"axis_z", &JointDescription::axis_z},
        Field{"position", &JointDescription::position, "limits"}.In("m or rad"),
        Field{"start", &JointDescription::start, "position at load"}.In("m or rad"),
        Field{"max_speed", &JointDescription::max_speed, "to both sides"}.In("m/s or rad/s").AtLeast(0),
    };
  }
};

// Two fingers that close on an object, and perhaps a lift that raises them. Finger joints are at their minimum when
// open and move up towards each other. Frame G: the model that the fingers are mounted on.
struct GripperDescription {
  std::string name;
  RobotId robot;
  ModelId model;
  JointId left;
  JointId right;
  ModelId left_pad;
  ModelId right_pad;
  std::optional<JointId> lift = {};
  std::vector<BreakBeam> beams;
  bool autosnatch = false;
  bool operator==(const GripperDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &GripperDescription::name, "the model's name without the robot's"},
        Field{"robot", &GripperDescription::robot},
        Field{"model", &GripperDescription::model, "frame G; moved by the lift"},
        Field{"left", &GripperDescription::left, "the joint of the finger"},
        Field{"right", &GripperDescription::right, "the joint of the finger"},
        Field{"left_pad", &GripperDescription::left_pad,
              "the model that must touch an object to hold it; moved by the left finger"},
        Field{"right_pad", &GripperDescription::right_pad,
              "the model that must touch an object to hold it; moved by the right finger"},
        Field{"lift", &GripperDescription::lift, "0 percent is its minimum, 100 percent its maximum"},
        Field{"beams", &GripperDescription::beams},
        Field{"autosnatch", &GripperDescription::autosnatch,
              "closes by itself when a beam is broken, and opens when none is"},
    };
  }
};

struct ControllerDescription {
  std::string name = "idle";
  std::string parameters = "{}";
  bool operator==(const ControllerDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &ControllerDescription::name, "a built-in controller, or a file (NamesLibrary)"},
        Field{"parameters", &ControllerDescription::parameters, "a JSON object"},
    };
  }
};

// True if a controller of this name is a file: a shared library, whose name contains a slash or ends in ".so", or a
// class in Python, "FILE.py:CLASS".
bool NamesLibrary(const std::string& controller);
// The path of that file: the name without the class.
std::string ControllerFile(const std::string& controller);

// The ports of a higher domain would exceed 65535.
inline constexpr std::uint32_t kMaxRosDomain = 230;

// How a robot appears in ROS 2. It changes no result.
struct RosIdentity {
  std::optional<std::uint32_t> domain = {};
  std::string name_space = {};
  bool operator==(const RosIdentity&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"ros_domain", &RosIdentity::domain,
              "its own ROS domain, where its topics have plain names; none: the run's"}
            .Within(0, kMaxRosDomain),
        Field{"ros_namespace", &RosIdentity::name_space, "of its topics, \"/fleet/anna\"; empty: its name"},
    };
  }
};
// A pose that a scenario names, for instance of a goal. It changes no result.
struct NamedPlace {
  std::string name;
  std::string description;
  std::vector<std::string> tags;
  Pose X_WN;
  bool operator==(const NamedPlace&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &NamedPlace::name},
        Field{"description", &NamedPlace::description},
        Field{"tags", &NamedPlace::tags},
        Field{"pose", &NamedPlace::X_WN, "in W"},
    };
  }
};

// A named frame that is fixed on a model of a robot, as on a link of its URDF: unlike a pose it may be tilted, first by
// `roll` about x, then by `pitch` about y, then by the heading. It concerns ROS alone, and changes no result.
struct MountedFrame {
  std::string name;
  ModelId model;
  Pose X_MF = {};
  double roll = 0.0;
  double pitch = 0.0;
  bool operator==(const MountedFrame&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &MountedFrame::name},
        Field{"model", &MountedFrame::model, "in the robot's tree; frame M"},
        Field{"pose_in_model", &MountedFrame::X_MF},
        Field{"roll", &MountedFrame::roll}.In("rad"),
        Field{"pitch", &MountedFrame::pitch}.In("rad"),
    };
  }
};

struct RobotDescription {
  std::string name;
  ModelId root;
  DriveDescription drive;
  LocalizationDescription localization;
  std::vector<SensorDescription> sensors;
  ControllerDescription controller;
  RosIdentity ros = {};
  std::vector<MountedFrame> frames = {};
  bool operator==(const RobotDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &RobotDescription::name, "the root model's name"},
        Field{"root", &RobotDescription::root},
        Field{"drive", &RobotDescription::drive},
        Field{"localization", &RobotDescription::localization},
        Field{"sensors", &RobotDescription::sensors, "in the order of the world file; break beams are their grippers'"},
        Field{"controller", &RobotDescription::controller},
        Field{"ros", &RobotDescription::ros},
        Field{"frames", &RobotDescription::frames,
              "of its URDF or SDF, the first that of the root model, which is its base in tf; empty: base_link"},
    };
  }
};

inline constexpr double kMaxInterval_ns = 1e12;  // of a tick

struct WorldDescription {
  std::string name;
  std::uint64_t seed = 0;
  std::int64_t interval_ns = 100'000'000;
  std::vector<Shape> shapes;
  std::vector<ModelDescription> models;
  std::vector<RobotDescription> robots;
  std::vector<JointDescription> joints;
  std::vector<GripperDescription> grippers;
  std::vector<ModelId> objects;
  double gravity = 9.81;
  std::vector<NamedPlace> places = {};
  std::vector<DoorDescription> doors = {};
  std::vector<LiftDescription> lifts = {};
  std::vector<GoalSet> goal_sets = {};
  std::vector<PersonDescription> people = {};
  std::vector<LevelDescription> levels = {};
  std::vector<LaneGraph> lane_graphs = {};
  std::vector<ZoneDescription> zones = {};
  std::vector<GoodsFlow> flows = {};
  std::vector<TimedAction> timed_actions = {};
  std::vector<LaneTrip> lane_trips = {};
  std::vector<VisitorFlow> visitor_flows = {};
  std::vector<VisitorDescription> visitors = {};
  std::vector<std::uint32_t> exits = {};

  double interval_seconds() const { return static_cast<double>(interval_ns) * 1e-9; }
  const ModelDescription& model(ModelId id) const { return models[id.index()]; }
  const Shape& shape(ShapeId id) const { return shapes[id.index()]; }
  const RobotDescription& robot(RobotId id) const { return robots[id.index()]; }
  const JointDescription& joint(JointId id) const { return joints[id.index()]; }
  const GripperDescription& gripper(GripperId id) const { return grippers[id.index()]; }
  const PersonDescription& person(PersonId id) const { return people[id.index()]; }
  bool operator==(const WorldDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &WorldDescription::name},
        Field{"seed", &WorldDescription::seed},
        Field{"interval", &WorldDescription::interval_ns, "length of a tick"}.In("ns").Within(1, kMaxInterval_ns),
        Field{"shapes", &WorldDescription::shapes},
        Field{"models", &WorldDescription::models},
        Field{"robots", &WorldDescription::robots},
        Field{"joints", &WorldDescription::joints},
        Field{"grippers", &WorldDescription::grippers},
        Field{"objects", &WorldDescription::objects, "the roots of movable objects, which may be gripped and fall"},
        Field{"gravity", &WorldDescription::gravity, "0: a released object stays in the air"}.In("m/s^2").AtLeast(0),
        Field{"places", &WorldDescription::places},
        Field{"doors", &WorldDescription::doors},
        Field{"lifts", &WorldDescription::lifts},
        Field{"goal_sets", &WorldDescription::goal_sets},
        Field{"people", &WorldDescription::people},
        Field{"levels", &WorldDescription::levels,
              "of a building, or the floors of lifts; none: the world is one level"},
        Field{"lane_graphs", &WorldDescription::lane_graphs},
        Field{"zones", &WorldDescription::zones},
        Field{"flows", &WorldDescription::flows},
        Field{"timed_actions", &WorldDescription::timed_actions, "ascending by their times"},
        Field{"lane_trips", &WorldDescription::lane_trips, "of robots, ascending"},
        Field{"visitor_flows", &WorldDescription::visitor_flows},
        Field{"visitors", &WorldDescription::visitors, "ascending by their people"},
        Field{"exits", &WorldDescription::exits, "goal sets at whose points people leave the world; ascending"},
    };
  }
};

// True if the model is `root` or below it.
bool IsInTree(const WorldDescription& world, ModelId model, ModelId root);

// False for a robot that was removed.
bool RobotExists(const WorldDescription& world, RobotId robot);

// The robot called `name`, if there is one.
std::optional<RobotId> FindRobot(const WorldDescription& world, const std::string& name);

// The door called `name`, by its number, if there is one.
std::optional<std::size_t> FindDoor(const WorldDescription& world, const std::string& name);

// The lift called `name`, by its number, if there is one.
std::optional<std::size_t> FindLift(const WorldDescription& world, const std::string& name);

// The row of a person among the visitors, if it is one.
std::optional<std::size_t> FindVisitor(const WorldDescription& world, PersonId person);

// Checks the invariants above. For input from a peer; loaders guarantee them.
Status Validate(const WorldDescription& world);

// The models with a store of energy, removed ones included, in id order: StoreState of a state is in this order.
std::vector<ModelId> FindStores(const WorldDescription& world);

// A light on a robot.
struct LightPlace {
  RobotId robot;
  ModelId model;
  bool operator==(const LightPlace&) const = default;
};
// In the order of robots, then of models, removed ones included: LightState of a state is in this order.
std::vector<LightPlace> FindLights(const WorldDescription& world);

// The parameters of number `sensor` of the robot's sensors; null if that is no camera.
const CameraParameters* FindCamera(const RobotDescription& robot, std::size_t sensor);

// Number `sensor` of the sensors of `robot`.
struct SensorPlace {
  RobotId robot;
  std::size_t sensor = 0;
  auto operator<=>(const SensorPlace&) const = default;
};
// The inertial measurement units of all robots, removed ones included, ascending: ImuState of a state is in this order.
std::vector<SensorPlace> FindImus(const WorldDescription& world);
// The cameras of all robots, in the order of CameraState.
std::vector<SensorPlace> FindCameras(const WorldDescription& world);

// A hash of everything in the description: peers that agree on it simulate the same world.
std::uint64_t Hash(const WorldDescription& world);

}  // namespace troupe
