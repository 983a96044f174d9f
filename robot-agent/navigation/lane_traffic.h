// The traffic of robots on lanes, as each of them sees it in the frame of a tick: where the others are decides which of
// them goes first. All robots see the same frame, so all come to the same result, wherever their agents run.
//
// There are no messages and no manager: the group of a mutex belongs to the robot that is in it, and a turn follows
// from the order of waiting and of ids. A robot that is parked at an entry cannot hold the others up for ever, because
// its turn passes after some seconds.
//
// Heights: bodies 1.3 m apart do not meet; levels of a building are farther apart.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/navigation/lane_route.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/world_state.h"

namespace troupe {

// Another robot.
struct SeenRobot {
  RobotId id;
  Vec2 position{0.0, 0.0};  // m, frame W
  double z = 0.0;
  double radius = 0.0;  // m, around its origin; no part of its declared size is farther away
  bool moves = false;
};

// The radius (m) around a robot's origin that contains its declared size and its blocks.
double RadiusOf(const WorldDescription& world, RobotId robot);

// The robots but for `own`. `radii`: by robot, m.
std::vector<SeenRobot> SeeOthers(const WorldDescription& world, const WorldState& state, RobotId own,
                                 const std::vector<double>& radii);

// A group of vertices and lanes for one robot at a time.
class MutexGroup {
 public:
  MutexGroup(const LaneGraph& graph, std::string name);

  const std::string& name() const { return name_; }

  // What a robot that wants to enter sees of the others.
  struct View {
    std::optional<RobotId> holder = {};  // in the group, or on its way into or out of it
    std::vector<RobotId> standing = {};  // where one enters; ascending
  };
  View Look(const LaneGraph& graph, const std::vector<SeenRobot>& others) const;

 private:
  bool Contains(const LaneGraph& graph, const SeenRobot& robot) const;

  std::string name_;
  std::vector<std::size_t> lanes_;     // of the group, and lanes to its vertices
  std::vector<std::size_t> vertices_;  // inside
  std::vector<std::size_t> entries_;   // ends of lanes into the group
};

// The turn of a robot that waits for a group at one of its entries. Robots that stand at an entry when it begins to
// wait come first: it enters once it has seen the group free for kTurnSeconds for each of them. They may be parked
// there, and take no more than that time. Of robots that begin in one tick each sees the others: kTieSeconds more for
// each smaller id decide.
class MutexTurn {
 public:
  static constexpr double kTurnSeconds = 3.0;
  static constexpr double kTieSeconds = 1.0;

  // True if the robot may enter now. Call it in each tick in which the robot waits.
  bool MayEnter(const MutexGroup::View& view, RobotId own, double time);
  void Forget() { *this = {}; }

 private:
  bool has_begun_ = false;
  std::vector<RobotId> first_;        // ascending
  std::optional<double> free_since_;  // s
};

// The nearest robot in the way of one that moves by `way` m from `position` along `direction`, a unit vector: nearer to
// that line than both half widths.
struct RobotAhead {
  SeenRobot robot;
  double room = 0.0;  // m, between both bodies along the way; at least 0
};
std::optional<RobotAhead> FindRobotAhead(const std::vector<SeenRobot>& others, const Vec2& position, double z,
                                         const Vec2& direction, double way, double radius, double half_width);

// True if one of the robots is where a robot of that radius wants to stand.
bool IsTaken(const LaneVertex& vertex, const std::vector<SeenRobot>& others, double radius);

// The lanes from a vertex to free ones outside lifts, without another robot on the way.
std::vector<Leg> FreeLegs(const LaneGraph& graph, std::size_t from, const std::vector<SeenRobot>& others, double radius,
                          double half_width);

}  // namespace troupe
