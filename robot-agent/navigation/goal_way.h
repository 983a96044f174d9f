// GoalWay: the way of a robot to a point, around the static bodies of the world as a map that it knows, and around
// robots, people and objects that stand in it.
//
// A way is searched when a goal arrives (common/spatial/robot_ways.h). The robot looks along its way with its own body,
// by the exact sweep of the step. Before a body it stands: for half a second before an object, for one to four seconds
// before a robot or a person, which may move on. Then it searches again, around all that stands there. Two robots face
// to face wait for different times (Observation::Random), so that one of them moves first. Where they cannot pass each
// other, the one with the larger id goes to the nearest place with room for both, the other one if that does not help.
//
// Doors on the way are asked for, and waited for outside of all that their leaves sweep. The zones that are on count:
// its way leads around keepout zones and through one_way zones along their heading, it drives no faster than speed
// zones allow, and stands before release zones. Once a zone is switched it searches again.
//
// It gives up for a reason: no way leads to the goal, or a body has been in the way for half a minute.
//
// A value: a copy continues as the original would. Whether a way is searched again depends on the state and the
// observation alone, never on when a scene was made.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/navigation/surroundings.h"
#include "troupe/controller.h"
#include "troupe/order.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"
#include "troupe/vec2.h"

namespace troupe {

class WalkGrid;
class ZoneWays;
struct ConvexPiece;

// Checks that a robot at X_WR finds a way to the goal (common/spatial/robot_ways.h). The error is the reason.
Status CheckWayToGoal(const Scene& scene, RobotId robot, const Pose& X_WR, const Goal& goal);

class GoalWay {
 public:
  GoalWay(RobotId own, const DriveDescription& drive) : own_(own), drive_(drive) {}

  // The motion of one tick.
  struct Leg {
    Vec2 point{0.0, 0.0};                                   // m, W: straight ahead of it nothing static stands
    double most = std::numeric_limits<double>::infinity();  // m/s: it can stand before what is in the way
    std::optional<std::size_t> door = {};                   // on its next metres, which is to be opened
    std::optional<WaitOrder> wait = {};                     // it stands, and for what
  };
  // Call it in each tick. `goal`: m, W. The error is why the goal is given up: the same until there is another one.
  Result<Leg> Update(const Observation& now, const Surroundings& around, const Vec2& goal);

  // The next Update searches again: the robot has left its way.
  void Restart() { is_due_ = true; }
  // Forgets the goal.
  void Reset();

 private:
  void Begin(const Vec2& goal);
  void Search(const Observation& now, const Surroundings& around);
  Status SearchOn(const Surroundings& around, double radius, bool around_bodies);
  // The pieces to go around: of bodies that stand near, and of those that were in the way.
  std::vector<const ConvexPiece*> StandingPieces(const Surroundings& around) const;
  // Makes room for the robot that was in the way last. False: it has no way to such a place, or that is not its turn.
  bool StepAside(const Surroundings& around);
  // m/s, in W; of an object zero.
  static Vec2 VelocityOf(const Surroundings& around, BodyId body);
  static bool Moves(const Surroundings& around, BodyId body);
  bool MovesAway(const Surroundings& around, BodyId body) const;
  // The way is not clear any more where an edit has changed the world.
  void FollowGrid(const Surroundings& around);
  void NoteMotion(const Observation& now, const Pose& X_WR);
  void Advance(const Vec2& here);
  Leg Drive(const Observation& now, const Surroundings& around);
  void OnBlocked(const Observation& now, const Surroundings& around, ModelId model);
  void CountBlock(const Observation& now, const Vec2& here);
  // The first robot, person or object on the points.
  std::optional<ModelId> FindOnWay(const Surroundings& around) const;
  // What was in the way last; nothing: it does not know.
  std::optional<ModelId> LastBlocker() const { return blockers_.empty() ? on_way_ : std::optional(blockers_.back()); }
  double CornerSpeed(const Vec2& here) const;
  // The first door on the next metres of the way that is not open.
  std::optional<std::size_t> ClosedDoorAhead(const Surroundings& around, const Vec2& here) const;
  void FollowZones(const Surroundings& around);
  // The leg, as fast as speed zones allow, and no farther than a release zone that is on.
  Leg HeedZones(const Observation& now, const Surroundings& around, const Vec2& along, Leg leg) const;
  // The leg with that door: no farther than to where no leaf sweeps.
  Leg AwaitDoor(const Observation& now, const Surroundings& around, Leg leg);
  double PassedDistance() const;
  // It stands and waits: for the body of a model, or of nothing for something that it does not know.
  Leg WaitFor(const Surroundings& around, std::optional<ModelId> model) const;

  RobotId own_;
  DriveDescription drive_;
  std::optional<Vec2> goal_;            // m, W
  std::optional<std::string> failure_;  // why it was given up
  std::shared_ptr<const WalkGrid> grid_;
  std::shared_ptr<const ZoneWays> zone_ways_;  // of the grid; null: no zone limits ways
  std::vector<bool> zones_on_;                 // by zone: those that do
  double grid_z_ = 0.0;                        // m, of the robot when its way was searched
  double grid_radius_ = 0.0;                   // m
  std::optional<Vec2> last_;                   // m, W, of the robot in the tick before
  std::vector<Vec2> points_;                   // m, W; empty: no way around the bodies that stand there
  std::size_t next_ = 0;                       // in points_
  bool reaches_ = false;                       // the way does, unless a body stands at the goal
  bool is_due_ = false;                        // a search
  double searched_at_ = 0.0;                   // s, simulated
  int searches_ = 0;                           // for this goal
  int failed_searches_ = 0;                    // since the last one that found a way
  bool is_aside_ = false;                      // the points lead to a place beside the way
  std::optional<double> aside_until_;          // s, simulated: it is there
  std::vector<ModelId> blockers_;              // that were in the way to this goal, the last one at the end
  std::optional<ModelId> on_way_;        // of the last search that found no way: the first body on that without it
  std::optional<double> wait_until_;     // s, simulated: what is in the way may have moved on by then
  std::optional<double> blocked_since_;  // s, simulated: not moved on since
  Vec2 blocked_at_{0.0, 0.0};            // m, W
};

}  // namespace troupe
