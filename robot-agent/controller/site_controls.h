// SiteControls: the doors and lifts of a site, as a robot on lanes operates them: it requests, waits outside of all
// that moves, passes, and closes or releases behind itself.
//
// Requests are orders of the tick (troupe/order.h), and their effect is read from the next frames: nothing is assumed.
// A lift is used in a session, which the robot keeps from its call until no vertex of its way needs the lift; a door
// that it has asked for is closed once neither it nor another robot is near the leaves.
//
// All distances are along the legs, in m; a robot waits so far before a doorway that no leaf can touch it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robot-agent/navigation/lane_route.h"
#include "robot-agent/navigation/lane_traffic.h"
#include "troupe/controller.h"

namespace troupe {

class SiteControls {
 public:
  // The graph outlives this, unless it is replaced.
  SiteControls(const RobotInfo& info, const LaneGraph& graph);

  // Other lanes from now on, which outlive all further calls.
  void SetGraph(const LaneGraph& graph) { graph_ = &graph; }

  // Begins a tick: all further calls read this observation and add to this command. Both live until the next call.
  void Begin(const Observation& observation, Command& command);

  // Calls the lift of a vertex to its floor. True while the session is the robot's own, or there is no lift.
  bool CallLift(std::size_t vertex);
  // Another robot has the session of the lift of a vertex.
  bool IsOfAnother(std::size_t vertex) const;
  // As CallLift, for a robot that waits outside. The lift is left to others, and the session is not the
  // robot's own, while another robot is in its cabin, or after a body has blocked the landing door for a while.
  bool AwaitLift(std::size_t vertex, const std::vector<SeenRobot>& others);
  // The lift of the vertex is there with open doors, or there is no lift.
  bool StandsOpenAt(std::size_t vertex) const;
  // Where a robot of that radius is, of the doors of a lift at the vertex in its cabin.
  enum class AtCabin : std::uint8_t { kOutside, kInDoorway, kInside };
  AtCabin PlaceAt(std::size_t vertex, const Vec2& position, double radius) const;
  // Ends the sessions of lifts that the robot has and that no vertex of `needed` is in.
  void EndSessions(const std::vector<std::size_t>& needed);

  // A door on the way of the robot, so near that it calls it.
  struct DoorAhead {
    const LaneDoor* door = nullptr;
    double way_before = 0.0;  // m, to where it waits: before all that the leaves sweep; 0: it is already within
  };
  // Along `legs`, of which the robot is `at` m on the first; `radius`: m, its own.
  std::vector<DoorAhead> DoorsAhead(const std::vector<Leg>& legs, const Vec2& position, double at, double radius) const;
  // Whether a straight way keeps out of all that the leaves of doors sweep, also open ones, for a robot of that radius.
  bool IsClear(const Vec2& from, const Vec2& to, double z, double radius) const;
  // Requests it. True if it is open.
  bool OpenDoor(const LaneDoor& door);
  bool IsStuck(const LaneDoor& door) const;  // it has not moved since the tick before
  const std::string& NameOf(const LaneDoor& door) const { return doors_[door.door].name; }
  // A lane that the robot begins: its doors count as requested, also if they are open.
  void Note(const Lane& lane);
  // Closes the requested doors through which the robot is, or that are on no lane of its `legs` any more, once no robot
  // is near them.
  void CloseBehind(const std::vector<Leg>& legs, const Vec2& position, double radius,
                   const std::vector<SeenRobot>& others);

 private:
  struct Passing {
    std::uint32_t door = 0;
    bool is_through = false;
    bool is_done = false;
  };

  void Note(std::uint32_t door);
  bool IsOnWay(std::uint32_t door, const std::vector<Leg>& legs) const;
  double WayBefore(const LaneDoor& door, double way, std::span<const Vec2> path, double radius) const;
  // Whether a body of that radius may touch the leaves on their way.
  static bool IsNearLeaves(const DoorInfo& door, const Vec2& position, double radius);
  bool StandsAt(std::uint32_t lift, std::size_t vertex) const;
  bool HasInCabin(std::size_t vertex, const SeenRobot& robot) const;
  std::optional<std::uint32_t> LiftOf(std::size_t vertex) const { return graph_->vertices[vertex].lift; }

  RobotId id_;
  const LaneGraph* graph_;
  std::vector<DoorInfo> doors_;
  std::vector<LiftInfo> lifts_;
  std::vector<std::optional<double>> blocked_since_;  // s, by lift: the landing door at which the robot waits
  std::vector<Passing> passing_;
  std::vector<double> openings_;         // by door, of this tick
  std::vector<double> openings_before_;  // and of the last one
  const Observation* now_ = nullptr;
  Command* command_ = nullptr;
};

// The m along a polyline to where it comes nearer to a point than `radius`; 0: it begins there. Nothing: it does not.
std::optional<double> WayIntoDisc(std::span<const Vec2> path, const Vec2& center, double radius);

}  // namespace troupe
