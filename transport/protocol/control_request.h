// What tools ask of a run (troupe ctl, the page, services of ROS 2): one struct for each request, with its parameters.
// Their fields are listed once: from the lists come the sample of idl/control.idl, the decoder of the page's JSON, the
// check of numbers, and the options of `troupe ctl` with their help.
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
#include "troupe/world_description.h"

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

// How `troupe ctl` has a field.
enum class CtlPlace : std::uint8_t {
  kOption,    // --name VALUE; every plain Field
  kRequired,  // an argument, or for a pose an option, that must be there
  kArgument,  // an argument that may be left out
  kNone,
};

template <typename Row, typename Part>
struct RequestField : Field<Row, Part> {
  CtlPlace place;
  std::string_view word;  // that stands for its value in help texts; empty: the last word of its name, in capitals
};

// Requests with a text kHelp are actions of `troupe ctl` by their names, with '-' for '_'.
namespace control {

template <typename Row, typename Part>
constexpr RequestField<Row, Part> Required(const Field<Row, Part>& field, std::string_view word = {}) {
  return {field, CtlPlace::kRequired, word};
}
template <typename Row, typename Part>
constexpr RequestField<Row, Part> Argument(const Field<Row, Part>& field) {
  return {field, CtlPlace::kArgument, {}};
}
template <typename Row, typename Part>
constexpr RequestField<Row, Part> NotOfCtl(const Field<Row, Part>& field) {
  return {field, CtlPlace::kNone, {}};
}

// Each reply has the state.
struct GetStatus {
  static constexpr std::string_view kName = "status";
  static constexpr std::string_view kHelp = "Print the state of the run: playing or paused, tick, state hash";
  static constexpr RequestKind kKind = RequestKind::kQuestion;
  bool operator==(const GetStatus&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

// Answered when the pause is quiescent.
struct Pause {
  static constexpr std::string_view kName = "pause";
  static constexpr std::string_view kHelp = "Pause the run at the end of the current tick";
  static constexpr RequestKind kKind = RequestKind::kTime;
  bool operator==(const Pause&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

struct Play {
  static constexpr std::string_view kName = "play";
  static constexpr std::string_view kHelp = "Resume the run";
  static constexpr RequestKind kKind = RequestKind::kTime;
  bool operator==(const Play&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

// Answered when the pause after the ticks is quiescent.
struct Step {
  static constexpr std::string_view kName = "step";
  static constexpr std::string_view kHelp = "Run a paused run for some ticks, and pause it again";
  static constexpr RequestKind kKind = RequestKind::kTime;
  std::uint64_t ticks = 1;
  bool operator==(const Step&) const = default;
  static constexpr auto Fields() {
    return std::tuple{Argument(Field{"ticks", &Step::ticks, "the number of ticks (default: 1)"}.AtLeast(1))};
  }
};

struct Reset {
  static constexpr std::string_view kName = "reset";
  static constexpr std::string_view kHelp =
      "Reset the run to the world as loaded, at tick 0; with options: the named parts only";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::uint8_t scopes = kResetAll;
  bool operator==(const Reset&) const = default;
  static constexpr auto Fields() {
    return std::tuple{Field{"scopes", &Reset::scopes, "a sum of kResetTime, kResetState and kResetSpawned, or all"}};
  }
};

// Without a file and a text: an empty world.
struct LoadWorld {
  static constexpr std::string_view kName = "load";
  static constexpr std::string_view kHelp = "Replace the world by that of a file";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string source = {};
  std::string text = {};
  bool operator==(const LoadWorld&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"source", &LoadWorld::source, "a world, scenario, building or map, as of 'troupe run'"}, "FILE"),
        NotOfCtl(Field{"text", &LoadWorld::text, "of a file, in its place"}),
    };
  }
};

struct Spawn {
  static constexpr std::string_view kName = "spawn";
  static constexpr std::string_view kHelp = "Add a robot, an object or a model to the world";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string source = {};
  std::string text = {};
  std::string name = {};
  Pose pose = {};
  bool rename = false;
  std::optional<std::uint32_t> ros_domain = {};
  std::string ros_namespace = {};
  std::string controller = {};
  bool operator==(const Spawn&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(
            Field{"source", &Spawn::source, "a model of the run's world file, a file with one model, or FILE#MODEL"}),
        NotOfCtl(Field{"text", &Spawn::text, "of a file, in its place"}),
        Field{"name", &Spawn::name, "its name (default: derived from the model)"},
        Field{"pose", &Spawn::pose,
              "pose in the world frame, in metres and degrees; without Z on the ground (default: 0,0,0)"},
        Field{"rename", &Spawn::rename, "choose another name if this one is in use"},
        Field{"ros_domain", &Spawn::ros_domain,
              "its own ROS domain, with plain names (default: as its spawn rule or file says, else that of the run)"}
            .Within(0, kMaxRosDomain),
        Field{"ros_namespace", &Spawn::ros_namespace, "of its topics in ROS, \"/fleet/anna\" (default: its name)"},
        Field{"controller", &Spawn::controller,
              "controller of the robot, with its default parameters (default: as the model says)"},
    };
  }
};

struct Delete {
  static constexpr std::string_view kName = "delete";
  static constexpr std::string_view kHelp = "Delete a robot, an object or a model";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string name = {};
  bool operator==(const Delete&) const = default;
  static constexpr auto Fields() {
    return std::tuple{Required(Field{"name", &Delete::name, "name of a robot, an object or a model"})};
  }
};

struct SetPose {
  static constexpr std::string_view kName = "set_pose";
  static constexpr std::string_view kHelp = "Move a robot, an object or a model to a pose";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string name = {};
  Pose pose = {};
  bool operator==(const SetPose&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"name", &SetPose::name, "name of a robot, an object or a model"}),
        Required(Field{"pose", &SetPose::pose,
                       "pose in the world frame, in metres and degrees; without Z at its present height"}),
    };
  }
};

struct Entities {
  static constexpr std::string_view kName = "entities";
  static constexpr RequestKind kKind = RequestKind::kQuestion;
  std::string name = {};
  bool with_boxes = false;
  bool operator==(const Entities&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &Entities::name, "name of a robot, an object, a person, a model or a place; empty: all entities"},
        Field{"with_boxes", &Entities::with_boxes, "report their boxes"},
    };
  }
};

struct Spawnables {
  static constexpr std::string_view kName = "spawnables";
  static constexpr std::string_view kHelp = "List the models of the run's world file";
  static constexpr RequestKind kKind = RequestKind::kQuestion;
  bool operator==(const Spawnables&) const = default;
  static constexpr auto Fields() { return std::tuple{}; }
};

struct Speed {
  static constexpr std::string_view kName = "speed";
  static constexpr std::string_view kHelp = "Set the speed of the run";
  static constexpr RequestKind kKind = RequestKind::kTime;
  std::optional<double> speed = {};
  bool operator==(const Speed&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"speed", &Speed::speed, "multiple of real time; max, or none: as fast as possible"}.Above(0)),
    };
  }
};

// A command for a robot, in force for some ticks. Each of its parts (RobotCommand) replaces the previous one; a goal
// without waypoints cancels the goal. The number of the goal does not count.
struct CommandRobot {
  static constexpr std::string_view kName = "command_robot";
  static constexpr RequestKind kKind = RequestKind::kTime;
  std::string name = {};
  std::uint64_t ticks = 1;
  std::optional<Twist> twist = {};
  std::vector<GripperOrder> grippers = {};
  std::optional<Goal> goal = {};
  std::vector<FleetMessage> messages = {};  // each for one tick, whatever `ticks` says
  bool operator==(const CommandRobot&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &CommandRobot::name, "of a robot"},
        Field{"ticks", &CommandRobot::ticks, "for which it is in force"}.In("tick").Within(1, kMaxCommandTicks),
        Field{"twist", &CommandRobot::twist, "in R"},
        Field{"grippers", &CommandRobot::grippers},
        Field{"goal", &CommandRobot::goal},
        Field{"messages", &CommandRobot::messages},
    };
  }
};

// A robot has a new id, and its controller starts.
struct Restore {
  static constexpr std::string_view kName = "restore";
  static constexpr std::string_view kHelp = "Add a deleted robot, object or model again";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::string source = {};
  std::string name = {};
  Pose pose = {};
  bool operator==(const Restore&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"source", &Restore::source, "its name when it was deleted"}, "NAME"),
        Field{"name", &Restore::name, "its name from now on (default: the same)"},
        Required(
            Field{"pose", &Restore::pose, "pose in the world frame, in metres and degrees; without Z on the ground"}),
    };
  }
};

struct Rewind {
  static constexpr std::string_view kName = "rewind";
  static constexpr std::string_view kHelp =
      "Set the run back to an earlier tick, by its recording; controllers remember the ticks before";
  static constexpr RequestKind kKind = RequestKind::kEdit;
  std::uint64_t tick = 0;
  bool operator==(const Rewind&) const = default;
  static constexpr auto Fields() { return std::tuple{Required(Field{"tick", &Rewind::tick, "the tick"})}; }
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
  static constexpr std::string_view kHelp = "Open or close a door";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string name = {};
  double opening = 1.0;
  bool operator==(const Door&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"name", &Door::name, "its name"}),
        Required(Field{"opening", &Door::opening, "close, open, or a number from 0, closed, to 1"}.Within(0, 1)),
    };
  }
};

struct Lift {
  static constexpr std::string_view kName = "lift";
  static constexpr std::string_view kHelp = "Call a lift to a floor";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string name = {};
  std::string floor = {};
  bool operator==(const Lift&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"name", &Lift::name, "its name"}),
        Required(Field{"floor", &Lift::floor, "the name of the floor"}),
    };
  }
};

struct Light {
  static constexpr std::string_view kName = "light";
  static constexpr std::string_view kHelp = "Switch a light of a robot on or off";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string name = {};
  bool on = true;
  bool operator==(const Light&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"name", &Light::name, "its name, with that of the robot: r0.beacon"}),
        Required(Field{"on", &Light::on, "on or off"}),
    };
  }
};

struct Lane {
  static constexpr std::string_view kName = "lane";
  static constexpr std::string_view kHelp = "Close a lane for robots, limit their speed there, or open it again";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string from = {};
  std::string to = {};
  double speed_limit = 0.0;
  bool operator==(const Lane&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"from", &Lane::from, "the name of a vertex, or 'vertex N' of one without a name"}),
        Required(Field{"to", &Lane::to, "the name of a vertex at the other end; the lane counts in both directions"}),
        Required(Field{"speed_limit", &Lane::speed_limit, "close, open, or a speed in m/s"}.Within(-1, 1000), "LIMIT"),
    };
  }
};

struct Zone {
  static constexpr std::string_view kName = "zone";
  static constexpr std::string_view kHelp = "Switch a zone on or off";
  static constexpr RequestKind kKind = RequestKind::kInput;
  std::string name = {};
  bool on = true;
  bool operator==(const Zone&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Required(Field{"name", &Zone::name, "its name"}),
        Required(Field{"on", &Zone::on, "on or off"}),
    };
  }
};

// The number of the alternative is that on the wire.
using Request =
    std::variant<GetStatus, Pause, Play, Step, Reset, LoadWorld, Spawn, Delete, SetPose, Entities, Spawnables, Speed,
                 CommandRobot, Restore, Rewind, Change, World, Worlds, SetTwist, Door, Lift, Light, Lane, Zone>;

inline RequestKind KindOf(const Request& request) {
  return std::visit([](const auto& each) { return each.kKind; }, request);
}

template <typename Kind>
bool Is(const Request& request) {
  return std::holds_alternative<Kind>(request);
}

// Checks what a request alone can tell: that its names are there, and its numbers within the limits of their fields.
// Poses, twists, goals and what the world has are checked where they are applied (CheckPose, CheckInput,
// CheckRobotCommand).
// The error is for the user.
Status CheckRequest(const Request& request);

}  // namespace control
}  // namespace troupe
