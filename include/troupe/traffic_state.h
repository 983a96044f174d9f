// The traffic of robots on lanes, as a part of a WorldState: who takes part, the plan for all of them, the lanes that
// it does not use for a time, and what robots wait for. common/traffic/traffic_plan.h says how plans are made and
// executed.
//
// Vertices and lanes are counted through all graphs of the world, in their order; the rides of lifts come after all
// lanes.
#pragma once

#include <cstdint>
#include <optional>

#include "troupe/fields.h"
#include "troupe/ids.h"

namespace troupe {

// A robot that takes part.
struct TrafficRobot {
  RobotId robot;
  std::uint32_t at = 0;
  std::optional<std::uint32_t> goal = {};
  Tick since = 0;
  std::uint32_t held = 0;
  std::uint32_t finished = 0;
  bool has_left = false;
  std::uint32_t absent = 0;
  std::uint32_t waiting = 0;
  std::optional<RobotId> waits_for = {};
  bool has_arrived = false;
  std::uint32_t arrivals = 0;
  bool operator==(const TrafficRobot&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &TrafficRobot::robot},
        Field{"at", &TrafficRobot::at, "the vertex that it was at last"},
        Field{"goal", &TrafficRobot::goal, "vertex; none: it makes room for others"},
        Field{"since", &TrafficRobot::since, "of the goal"}.In("tick"),
        Field{"held", &TrafficRobot::held, "that it has stayed where it is so far; 0: it moves"}.In("tick"),
        Field{"finished", &TrafficRobot::finished, "moves since it takes part, modulo 2^32"},
        Field{"left", &TrafficRobot::has_left, "it is clear of the start of its present move"},
        Field{"absent", &TrafficRobot::absent, "since its last order"}.In("tick"),
        Field{"waiting", &TrafficRobot::waiting, "since it stands on its way to its goal"}.In("tick"),
        Field{"waits_for", &TrafficRobot::waits_for, "the robot after which it goes on; none: another thing"},
        Field{"arrived", &TrafficRobot::has_arrived, "it is at its goal, or was"},
        Field{"arrivals", &TrafficRobot::arrivals, "goals that it has reached since it takes part"},
    };
  }
};

// A robot's way along one lane, in the plan.
struct TrafficMove {
  RobotId robot;
  std::uint32_t lane = 0;
  std::uint32_t to = 0;
  bool granted = false;
  bool operator==(const TrafficMove&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &TrafficMove::robot},
        Field{"lane", &TrafficMove::lane},
        Field{"to", &TrafficMove::to, "an end of the lane; the start of the move, if the robot turns back"},
        Field{"granted", &TrafficMove::granted, "it may begin"},
    };
  }
};

// A lane on which a body that takes no part was in the way. No plan uses it for a time, which doubles until a robot has
// passed it.
struct LaneClosure {
  std::uint32_t lane = 0;
  Tick until = 0;
  std::uint32_t ticks = 0;
  bool operator==(const LaneClosure&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"lane", &LaneClosure::lane},
        Field{"until", &LaneClosure::until, "it opens then"}.In("tick"),
        Field{"ticks", &LaneClosure::ticks, "that it was closed for the last time"}.In("tick"),
    };
  }
};

// A robot that stands on its way to a goal, of the planned traffic or of another controller that says so (WaitOrder).
struct RobotWait {
  RobotId robot;
  Tick since = 0;
  std::optional<ModelId> thing = {};
  std::optional<std::uint32_t> lane = {};
  bool operator==(const RobotWait&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &RobotWait::robot},
        Field{"since", &RobotWait::since, "it waits"}.In("tick"),
        Field{"thing", &RobotWait::thing, "for which it waits: a robot, person, object, door or lift; none: not known"},
        Field{"lane", &RobotWait::lane, "on which it cannot go on; without a thing perhaps a closed one"},
    };
  }
};

}  // namespace troupe
