// The doors and lifts of a site, as a robot on lanes operates them.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/navigation/lane_graph.h"
#include "robot-agent/navigation/lane_traffic.h"
#include "troupe/controller.h"

namespace troupe {

class SiteControls {
 public:
  SiteControls(const RobotInfo& info, std::shared_ptr<const LaneGraph> graph);

  // What follows is of this tick, and adds to its command. Both live until the next call.
  void Begin(const Observation& observation, Command& command);

  // Calls the lift of a vertex to its floor. True while the session is the robot's own, or there is no lift.
  bool CallLift(std::size_t vertex);
  // The lift of the vertex is there with open doors, or there is no lift.
  bool StandsOpenAt(std::size_t vertex) const;
  // Ends the sessions of lifts that the robot has and that no vertex of `needed` is in.
  void EndSessions(const std::vector<std::size_t>& needed);

  // Requests it. True if it is open, or there is none.
  bool OpenDoor(const LaneDoor& door);
  bool IsBlocked(const LaneDoor& door) const;  // a leaf by a body
  // The doors of a lane that the robot begins: CloseBehind closes them when it is through and no other robot is near.
  void Note(const Lane& lane);
  void CloseBehind(const Vec2& position, double radius, const std::vector<SeenRobot>& others);

 private:
  struct Passing {
    LaneDoor door;
    std::size_t number = 0;
    bool is_through = false;
    bool is_done = false;
  };

  std::optional<std::size_t> LiftOf(std::size_t vertex) const;

  RobotId id_;
  std::shared_ptr<const LaneGraph> graph_;
  std::vector<DoorInfo> door_infos_;
  std::vector<LiftInfo> lift_infos_;
  std::map<std::string, std::size_t> doors_;  // numbers by name
  std::map<std::string, std::size_t> lifts_;
  std::vector<Passing> passing_;
  const Observation* now_ = nullptr;
  Command* command_ = nullptr;
};

inline constexpr double kDoorMargin = 0.2;  // m, between a robot and the way of a leaf

}  // namespace troupe
