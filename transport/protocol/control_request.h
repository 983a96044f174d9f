// What tools ask of a run (troupe ctl, the page, services of ROS 2): one struct for each request, with its parameters.
// Their fields are listed once: from the lists come the sample of idl/control.idl and the decoder of the page's JSON.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "troupe/fields.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"

namespace troupe {

// How the service executes a request.
enum class RequestKind : std::uint8_t {
  kQuestion,  // answered at once; changes nothing
  kTime,      // pauses, resumes or paces the run
  kInput,     // enters the next step, without a pause, and is answered at once
  kEdit,      // makes the next edition, in a pause of its own if the run plays; answered when all agents have the world
};

inline constexpr std::uint64_t kMaxCommandTicks = 1'000'000;

// The scopes of a reset; a sum of these.
inline constexpr std::uint8_t kResetTime = 1;     // back to tick 0
inline constexpr std::uint8_t kResetState = 2;    // robots and objects back to their first state; controllers restart
inline constexpr std::uint8_t kResetSpawned = 4;  // deletes the spawned entities
inline constexpr std::uint8_t kResetAll = 255;    // the world as loaded, with the entities deleted since

namespace control {

// The state of the run, which each reply has.
struct GetStatus {
  static constexpr std::string_view kName = "status";
  static constexpr RequestKind kKind = RequestKind::kQuestion;
  bool operator==(const GetStatus&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

// After the open tick; answered when the pause is quiescent.
struct Pause {
  static constexpr std::string_view kName = "pause";
  static constexpr RequestKind kKind = RequestKind::kTime;
  bool operator==(const Pause&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

struct Play {
  static constexpr std::string_view kName = "play";
  static constexpr RequestKind kKind = RequestKind::kTime;
  bool operator==(const Play&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

// From a pause: some ticks, and pause again; answered when that pause is quiescent.
struct Step {
  static constexpr std::string_view kName = "step";
  static constexpr RequestKind kKind = RequestKind::kTime;
  std::uint64_t ticks = 1;
  bool operator==(const Step&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"ticks", &Step::ticks}}; }
};

struct Reset {
  static constexpr std::string_view kName = "reset";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::uint8_t scopes = kResetAll;
  bool operator==(const Reset&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"scopes", &Reset::scopes}}; }
};

// Replaces the world. Without a file and a text by an empty one.
struct LoadWorld {
  static constexpr std::string_view kName = "load_world";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string source = {};  // the file
  std::string text = {};    // of a file, in its place
  bool operator==(const LoadWorld&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"source", &LoadWorld::source},
        Field{"text", &LoadWorld::text},
    };
  }
};

// Adds an entity.
struct Spawn {
  static constexpr std::string_view kName = "spawn";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string source = {};  // a model of the run's world file, a file with one model, or FILE#MODEL
  std::string text = {};    // of a file, in its place
  std::string name = {};    // empty: derived from the source
  Pose pose = {};           // in W
  bool rename = false;      // choose another name if this one is in use
  std::optional<std::uint32_t> ros_domain = {};  // RosIdentity::domain of the robot; none: as its source says
  std::string ros_namespace = {};                // RosIdentity::name_space of the robot
  std::string controller = {};                   // name of the robot's; empty: as its source says
  bool operator==(const Spawn&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"source", &Spawn::source},
        Field{"text", &Spawn::text},
        Field{"name", &Spawn::name},
        Field{"pose", &Spawn::pose},
        Field{"rename", &Spawn::rename},
        Field{"ros_domain", &Spawn::ros_domain},
        Field{"ros_namespace", &Spawn::ros_namespace},
        Field{"controller", &Spawn::controller},
    };
  }
};

struct Delete {
  static constexpr std::string_view kName = "delete";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string name = {};
  bool operator==(const Delete&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"name", &Delete::name}}; }
};

struct SetPose {
  static constexpr std::string_view kName = "set_pose";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string name = {};  // of an entity
  Pose pose = {};         // in W
  bool operator==(const SetPose&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &SetPose::name},
        Field{"pose", &SetPose::pose},
    };
  }
};

struct Entities {
  static constexpr std::string_view kName = "entities";
  static constexpr RequestKind kKind = RequestKind::kQuestion;
  std::string name = {};    // of an entity or a place; empty: all entities
  bool with_boxes = false;  // report their boxes
  bool operator==(const Entities&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &Entities::name},
        Field{"with_boxes", &Entities::with_boxes},
    };
  }
};

// The models of the run's world file.
struct Spawnables {
  static constexpr std::string_view kName = "spawnables";
  static constexpr RequestKind kKind = RequestKind::kQuestion;
  bool operator==(const Spawnables&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

struct Speed {
  static constexpr std::string_view kName = "speed";
  static constexpr RequestKind kKind = RequestKind::kTime;
  std::optional<double> speed = {};  // multiple of real time, positive; none: as fast as possible
  bool operator==(const Speed&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"speed", &Speed::speed}.Above(0)}; }
};

// A command for a robot, in force for some ticks. Each of its parts (RobotCommand) replaces the previous one; a goal
// without waypoints cancels the goal. The number of the goal does not count.
struct CommandRobot {
  static constexpr std::string_view kName = "command_robot";
  static constexpr RequestKind kKind = RequestKind::kTime;
  std::string name = {};
  std::uint64_t ticks = 1;
  std::optional<Twist> twist = {};  // in R
  std::vector<GripperOrder> grippers = {};
  std::optional<Goal> goal = {};
  bool operator==(const CommandRobot&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &CommandRobot::name},   Field{"ticks", &CommandRobot::ticks},
        Field{"twist", &CommandRobot::twist}, Field{"grippers", &CommandRobot::grippers},
        Field{"goal", &CommandRobot::goal},
    };
  }
};

// Adds a deleted entity again. A robot has a new id, and its controller starts.
struct Restore {
  static constexpr std::string_view kName = "restore";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string source = {};  // its name when it was deleted
  std::string name = {};    // from now on; empty: the same
  Pose pose = {};           // in W
  bool operator==(const Restore&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"source", &Restore::source},
        Field{"name", &Restore::name},
        Field{"pose", &Restore::pose},
    };
  }
};

// Back to an earlier tick, from the recording of the run.
struct Rewind {
  static constexpr std::string_view kName = "rewind";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::uint64_t tick = 0;
  bool operator==(const Rewind&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"tick", &Rewind::tick}}; }
};

// In recordings only: another seed and other controllers (WorldChanges::ToText).
struct Change {
  static constexpr std::string_view kName = "change";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string changes = {};
  bool operator==(const Change&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"changes", &Change::changes}}; }
};

// The name of the loaded world, and its file as its type; nothing after it was unloaded.
struct World {
  static constexpr std::string_view kName = "world";
  static constexpr RequestKind kKind = RequestKind::kQuestion;
  bool operator==(const World&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

// The files of worlds in a folder; without one in that of the run's world.
struct Worlds {
  static constexpr std::string_view kName = "worlds";
  static constexpr RequestKind kKind = RequestKind::kQuestion;
  std::string folder = {};
  bool operator==(const Worlds&) const = default;
  static constexpr auto Fields() { return std::tuple{Field{"folder", &Worlds::folder}}; }
};

struct SetTwist {
  static constexpr std::string_view kName = "set_twist";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string name = {};  // of a robot
  Twist twist = {};       // in R
  bool operator==(const SetTwist&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &SetTwist::name},
        Field{"twist", &SetTwist::twist},
    };
  }
};

struct Door {
  static constexpr std::string_view kName = "door";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string name = {};
  double opening = 1.0;  // from 0, closed, to 1
  bool operator==(const Door&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &Door::name},
        Field{"opening", &Door::opening}.Within(0, 1),
    };
  }
};

struct Lift {
  static constexpr std::string_view kName = "lift";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string name = {};
  std::string floor = {};  // its name
  bool operator==(const Lift&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &Lift::name},
        Field{"floor", &Lift::floor},
    };
  }
};

struct Light {
  static constexpr std::string_view kName = "light";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string name = {};  // of its model: "r0.beacon"
  bool on = true;
  bool operator==(const Light&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &Light::name},
        Field{"on", &Light::on},
    };
  }
};

// The number of the alternative is that on the wire.
using Request =
    std::variant<GetStatus, Pause, Play, Step, Reset, LoadWorld, Spawn, Delete, SetPose, Entities, Spawnables, Speed,
                 CommandRobot, Restore, Rewind, Change, World, Worlds, SetTwist, Door, Lift, Light>;

inline RequestKind KindOf(const Request& request) {
  return std::visit([](const auto& each) { return each.kKind; }, request);
}

template <typename Kind>
bool Is(const Request& request) {
  return std::holds_alternative<Kind>(request);
}

// Checks what a request alone can tell: that its names are there, and its counts and numbers of ticks in range. Poses,
// twists, goals and what the world has are checked where they are applied (CheckPose, CheckInput, CheckRobotCommand).
// The error is for the user.
Status CheckRequest(const Request& request);

}  // namespace control
}  // namespace troupe
