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
#include "troupe/ids.h"
#include "troupe/interval.h"
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
  Polygon outline;  // normalized, m, frame M
  ZRange z;         // m above the model's pose
  bool operator==(const Block&) const = default;
};

// The solid body of one or more models of the same geometry.
struct Shape {
  std::vector<Block> blocks;
  // The occupied area of a bitmap: rectangles that do not overlap, m, frame M, all of one height interval.
  std::vector<Rectangle> rectangles;
  ZRange rectangles_z;
  // The same for a bitmap with too many rectangles for its pixels, instead of a list; of that height interval as well.
  // Only shapes of static models have one.
  std::optional<PixelArea> area = {};

  bool empty() const { return blocks.empty() && rectangles.empty() && !area; }
  bool operator==(const Shape&) const = default;
};

// The shape with the rectangles of its area as a list, or as blocks where the area is turned.
Shape Listed(Shape shape);

// A light that is on and off by turns while it is switched on. In each period it is on first; a period of 0: it is not
// a light.
struct Blinking {
  std::int64_t period_ns = 0;
  std::int64_t on_ns = 0;      // 0: always off; the period: always on
  bool is_switched_on = true;  // at load; that of a robot is switched by its controller (LightState)

  bool is_light() const { return period_ns > 0; }
  bool IsOnAt(std::int64_t time_ns) const { return time_ns % period_ns < on_ns; }  // REQUIRES: is_light()
  bool operator==(const Blinking&) const = default;
};

// The energy of a model: what it consumes, stores, gives and takes. A model is fed by its own store, or by that of its
// nearest ancestor that has one; a model without either consumes nothing.
struct PowerDescription {
  bool has_store = false;
  bool endless = false;     // the store never empties
  double joules = 0.0;      // J, in the store at load
  double capacity = 0.0;    // J
  double watts = 0.0;       // W that the model consumes all the time
  double mass = 0.0;        // kg, of a robot: it consumes 10 W per kg and m/s or rad/s while it moves
  double give_watts = 0.0;  // W that it gives, at the most, to models that touch it
  double take_watts = 0.0;  // W that it takes, at the most, from models that it touches
  bool operator==(const PowerDescription&) const = default;
};

// The pixels of a ROS map that a model was made from, occupied or not: its image begins at the model's origin. Only the
// maps that are made of a world depend on it, so it does not count for a world's hash.
struct MapGrid {
  std::uint32_t columns = 0;  // 0: the model is no map
  std::uint32_t rows = 0;
  double resolution = 0.0;  // m, side of a pixel
  bool operator==(const MapGrid&) const = default;
};

struct ModelDescription {
  std::string name;  // unique, children as "parent.child"
  std::string type;  // as in the world file: "model", "position", "ranger", ...
  std::optional<ModelId> parent;
  Pose X_PM;  // pose at load in the parent's frame (the world's without parent); stacking is included
  ShapeId shape;
  double size_x = 0.0;  // m, as declared
  double size_y = 0.0;  // m
  double size_z = 0.0;  // m
  Color color;
  bool obstacle_return = true;       // collides
  double ranger_return = 1.0;        // intensity of a ranger's hit; negative: transparent to rangers
  bool gripper_return = false;       // may be gripped, moved and dropped
  std::int32_t fiducial_return = 0;  // the id that a fiducial finder reads; 0: none
  std::int32_t fiducial_key = 0;     // only finders with the same key find it
  bool show_nose = false;            // pictures show its heading
  Blinking blinking = {};            // of a light
  PowerDescription power = {};
  MapGrid map = {};
  bool removed = false;  // by an edit: it keeps its id, but has no body, and its name is free
  bool operator==(const ModelDescription&) const = default;
};

// The colour of the model's body at a simulated time: that of a light that is off is dark. `is_switched_on`: of a
// light.
Color ColorAt(const ModelDescription& model, std::int64_t time_ns, bool is_switched_on);

enum class DriveType : std::uint8_t {
  kDifferential,  // vx, wz
  kOmni,          // vx, vy, wz
  kCar,           // speed and steering angle; the twist is vx, wz
};

// Bounds of each component of a twist (m/s, m/s, rad/s) or of its rate of change (m/s^2, m/s^2, rad/s^2).
struct TwistBounds {
  Interval x;
  Interval y;
  Interval heading;
  bool operator==(const TwistBounds&) const = default;
};

struct DriveDescription {
  DriveType type = DriveType::kDifferential;
  double wheelbase = 1.0;  // m, car only
  TwistBounds velocity;
  TwistBounds acceleration;  // min: strongest braking or reversing (<= 0); max: strongest speeding up (>= 0)
  bool operator==(const DriveDescription&) const = default;
};

enum class LocalizationType : std::uint8_t {
  kGps,       // the pose estimate is the true pose
  kOdometry,  // the pose estimate adds up motion, with errors
};

struct LocalizationDescription {
  LocalizationType type = LocalizationType::kGps;
  Pose origin;  // odometry starts here (frame: odom)
  // Odometry's relative errors of x, y and heading: a motion d is read as d * (1 + error).
  double error_x = 0.0;
  double error_y = 0.0;
  double error_heading = 0.0;
  bool operator==(const LocalizationDescription&) const = default;
};

enum class JointType : std::uint8_t {
  kPrismatic,  // shifts the model along the axis
  kRevolute,   // turns it about the vertical through its origin
};

// One degree of freedom of a robot: its model, with everything below, moves relative to the parent. At position q the
// model's pose is X_PM * (a shift by q * axis, or a turn by q).
struct JointDescription {
  std::string name;  // the model's name without the robot's: "gripper.lift"
  RobotId robot;
  ModelId model;  // in the robot's tree, not its root
  JointType type = JointType::kPrismatic;
  Vec2 axis_xy{0.0, 0.0};  // with axis_z a unit vector in the model's frame; revolute: (0, 0, 1)
  double axis_z = 1.0;
  Interval position;       // limits, m or rad
  double start = 0.0;      // position at load
  double max_speed = 1.0;  // m/s or rad/s, to both sides
  bool operator==(const JointDescription&) const = default;
};

// Two fingers that close on an object, and perhaps a lift that raises them. Finger joints are at their minimum when
// open and move up towards each other. Frame G: the model that the fingers are mounted on.
struct GripperDescription {
  std::string name;  // the model's name without the robot's
  RobotId robot;
  ModelId model;  // frame G; moved by the lift
  JointId left;
  JointId right;
  ModelId left_pad;  // the model that must touch an object to hold it; moved by the left finger
  ModelId right_pad;
  std::optional<JointId> lift = {};  // 0 percent is its minimum, 100 percent its maximum
  std::vector<BreakBeam> beams;
  bool autosnatch = false;  // closes by itself when a beam is broken, and opens when none is
  bool operator==(const GripperDescription&) const = default;
};

struct ControllerDescription {
  std::string name = "idle";      // a built-in controller, or a file (NamesLibrary)
  std::string parameters = "{}";  // a JSON object
  bool operator==(const ControllerDescription&) const = default;
};

// True if a controller of this name is a file: a shared library, whose name contains a slash or ends in ".so", or a
// class in Python, "FILE.py:CLASS".
bool NamesLibrary(const std::string& controller);
// The path of that file: the name without the class.
std::string ControllerFile(const std::string& controller);

// A leaf of a door: an object that only its door moves.
struct DoorLeaf {
  ObjectId object;
  Pose X_WH;           // of the object's root while the door is closed
  double turn = 0.0;   // rad, of a door that opens: the leaf turns about the origin of H
  double shift = 0.0;  // m, or slides along the x axis of H; one of both is 0
  bool operator==(const DoorLeaf&) const = default;

  // At an opening from 0, closed, to 1.
  Pose X_WH_at(double opening) const { return X_WH * Pose{opening * shift, 0.0, 0.0, WrapAngle(opening * turn)}; }
};

// One or more leaves that open and close together.
struct DoorDescription {
  ModelId model;  // has no body; its name is the door's
  std::vector<DoorLeaf> leaves;
  double seconds = 3.0;     // from closed to open
  double reach = 0.0;       // m: it opens for robots that are nearer to its model; 0: for none
  double opening = 0.0;     // at load
  bool is_operated = true;  // false: it stays as it is
  bool operator==(const DoorDescription&) const = default;
};

// A height at which a lift stops.
struct LiftFloor {
  std::string name;
  double z = 0.0;                  // m, of the cabin's floor
  std::vector<std::size_t> doors;  // in WorldDescription::doors: those of the cabin and of the shaft that open here
  bool operator==(const LiftFloor&) const = default;
};

// A cabin that moves along z, with what stands in it, while all of its doors are closed.
struct LiftDescription {
  ModelId model;                         // has no body; its name is the lift's
  ObjectId cabin;                        // an object that only the lift moves; at the height of the floor at load
  std::vector<std::size_t> cabin_doors;  // that move with it
  std::vector<LiftFloor> floors;
  std::uint32_t floor = 0;  // at load
  double speed = 1.0;       // m/s
  bool operator==(const LiftDescription&) const = default;
};

// How a robot appears in ROS 2. It changes no result.
struct RosIdentity {
  std::optional<std::uint32_t> domain = {};  // its own ROS domain, where its topics have plain names; none: the run's
  std::string name_space = {};               // of its topics, "/fleet/anna"; empty: its name
  bool operator==(const RosIdentity&) const = default;
};
inline constexpr std::uint32_t kLastRosDomain = 230;

// A pose that a scenario names, for instance of a goal. It changes no result.
struct NamedPlace {
  std::string name;
  std::string description;
  std::vector<std::string> tags;
  Pose X_WN;
  bool operator==(const NamedPlace&) const = default;
};

struct RobotDescription {
  std::string name;  // the root model's name
  ModelId root;
  DriveDescription drive;
  LocalizationDescription localization;
  std::vector<SensorDescription> sensors;  // in the order of the world file; break beams are their grippers'
  ControllerDescription controller;
  RosIdentity ros = {};
  bool operator==(const RobotDescription&) const = default;
};

// The reaction of a person to a robot.
enum class PersonReaction : std::uint8_t {
  kRegular = 0,   // avoids it like a walker who does not avoid in turn
  kCurious = 1,   // walks up to it and watches it for a while
  kScared = 2,    // keeps away from it
  kCareless = 3,  // ignores it, and only stops at a contact
};
constexpr PersonReaction LastOf(PersonReaction) {
  return PersonReaction::kCareless;
}

// A goal set that may follow another one.
struct NextGoals {
  std::uint32_t goals = 0;  // in WorldDescription::goal_sets
  double weight = 1.0;      // of the choice, relative to those of the others
  bool operator==(const NextGoals&) const = default;
};

// Goals of people: a person chooses one of the points, walks there, waits, and chooses among the next sets.
struct GoalSet {
  std::string name;
  std::vector<Vec2> points;          // m, frame W; none: the person stays where it is
  double reach = 0.5;                // m: so near to the point the person has arrived
  Interval wait;                     // s, at the goal; drawn between these
  std::vector<NextGoals> next;       // none: the person stays at its goal
  std::vector<double> heights = {};  // m, of the points; none: on the level on which the person starts
  bool operator==(const GoalSet&) const = default;
};

// A walker of the world: it is moved by the step, and is a body like all others.
struct PersonDescription {
  ModelId root;            // the body, without joints; its name is the person's
  double radius = 0.25;    // m: no part of the body is farther from its axis
  double speed = 1.3;      // m/s, without an obstacle
  double max_speed = 1.8;  // m/s
  PersonReaction reaction = PersonReaction::kRegular;
  std::uint32_t goals = 0;              // its first goal set
  std::optional<PersonId> leader = {};  // with whom it walks, to the leader's goals
  bool operator==(const PersonDescription&) const = default;
};

struct WorldDescription {
  std::string name;
  std::uint64_t seed = 0;
  std::int64_t interval_ns = 100'000'000;  // length of a tick
  std::vector<Shape> shapes;
  std::vector<ModelDescription> models;
  std::vector<RobotDescription> robots;
  std::vector<JointDescription> joints;
  std::vector<GripperDescription> grippers;
  std::vector<ModelId> objects;  // movable objects, which may be gripped and fall: the roots of their trees
  double gravity = 9.81;         // m/s^2; 0: a released object stays in the air
  std::vector<NamedPlace> places = {};
  std::vector<DoorDescription> doors = {};
  std::vector<LiftDescription> lifts = {};
  std::vector<GoalSet> goal_sets = {};
  std::vector<PersonDescription> people = {};
  std::vector<LevelDescription> levels = {};  // of a building, or the floors of lifts; none: the world is one level
  std::vector<LaneGraph> lane_graphs = {};

  double interval_seconds() const { return static_cast<double>(interval_ns) * 1e-9; }
  const ModelDescription& model(ModelId id) const { return models[id.index()]; }
  const Shape& shape(ShapeId id) const { return shapes[id.index()]; }
  const RobotDescription& robot(RobotId id) const { return robots[id.index()]; }
  const JointDescription& joint(JointId id) const { return joints[id.index()]; }
  const GripperDescription& gripper(GripperId id) const { return grippers[id.index()]; }
  const PersonDescription& person(PersonId id) const { return people[id.index()]; }
  bool operator==(const WorldDescription&) const = default;
};

// True if the model is `root` or below it.
bool IsInTree(const WorldDescription& world, ModelId model, ModelId root);

// False for a robot that was removed.
bool RobotExists(const WorldDescription& world, RobotId robot);

// The robot called `name`, if there is one.
std::optional<RobotId> FindRobot(const WorldDescription& world, const std::string& name);

// The door called `name`, by its number, if there is one.
std::optional<std::size_t> FindDoor(const WorldDescription& world, const std::string& name);

// The lift called `name`, likewise.
std::optional<std::size_t> FindLift(const WorldDescription& world, const std::string& name);

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
