// Motion of robots: to a point, around obstacles, out of a contact, and in a flock.
//
// The parts build on each other: SteerToPoint is the motion without obstacles; ClearSteering chooses a clear bearing
// first; Recovery takes over where both are stuck. All random choices come from Observation::Random, with a number for
// each use, so that adding one does not change the others.
//
// Points in R are in m, x ahead; times are simulated seconds. Nothing here knows a map.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "robot-agent/navigation/rays.h"
#include "troupe/controller.h"
#include "troupe/vec2.h"

namespace troupe {

// The motion towards a point, for controllers that drive to places.

struct SteerSettings {
  double speed = 0.4;      // m/s
  double turn_rate = 0.8;  // rad/s
};

// The command that brings the robot nearer to `p_R` (m, frame R): it turns towards the point and drives faster the
// better it faces it, a car on the arc through the point. No faster than `most` m/s.
Command SteerToPoint(const DriveDescription& drive, const SteerSettings& settings, const Vec2& p_R, double most);

// The speed (m/s) from which the drive can brake within `distance` m.
double BrakingSpeed(const DriveDescription& drive, double distance);

// Recovery: the way out of a contact at which the manoeuvres of a controller are blocked: random motions, until one of
// them is free.
class Recovery {
 public:
  Recovery(const DriveDescription& drive, const SteerSettings& settings) : drive_(drive), settings_(settings) {}

  static constexpr double kPatience = 1.0;  // s: for robots whose own manoeuvres are blocked
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  static constexpr double kPlacePatience = 10.0;

  // The command of a recovery, while there is one. It begins once the robot has not moved for `patience` s, or has only
  // turned to and fro between contacts for `place_patience` s; never if `patience` is kNever. Call it in each tick: the
  // time of ticks without a call does not count.
  std::optional<Command> Update(const Observation& observation, double patience,
                                double place_patience = kPlacePatience);

 private:
  void ObserveMotion(const Observation& observation);
  Command RandomMotion(const Observation& observation) const;

  DriveDescription drive_;
  SteerSettings settings_;
  std::optional<Pose> rest_;   // the last pose from which the robot has not moved noticeably
  double rest_since_ = 0.0;    // s, simulated, as all times
  std::optional<Vec2> place_;  // m: of the first of several stalls at nearly one place
  double place_since_ = 0.0;
  double stalled_at_ = 0.0;  // the last time
  double called_at_ = 0.0;
  std::optional<Command> motion_;  // of a recovery
  double motion_until_ = 0.0;
};

// ClearSteering: the motion towards a point, or nowhere in particular, around the obstacles that a ranger sees. It
// knows only what the ranger sees at present, so that a dead end can catch it: without progress it roams for a while.
class ClearSteering {
 public:
  struct Settings {
    SteerSettings steer;
    double clearance = 0.4;  // m, from the robot's origin to an obstacle that it passes
  };

  // Without a ranger it drives straight, and turns after a stall. REQUIRES: sensor `ranger` is one.
  ClearSteering(const RobotInfo& info, std::optional<std::size_t> ranger, const Settings& settings);

  // The command that brings the robot nearer to `p_R` (m, frame R), no faster than `most` m/s. Call it once each tick.
  Command Towards(const Observation& observation, const Vec2& p_R, double most);
  // The command that drives on where there is room, with random turns. Call it once each tick.
  Command Roam(const Observation& observation);
  // The command that turns the robot's sensors to all its surroundings: a turn on the spot, of a car a round trip. Call
  // it once each tick.
  Command LookAround(const Observation& observation);

 private:
  void SeeObstacles(const Observation& observation);
  // The command of an escape after a stall, while there is one.
  std::optional<Command> Escape(const Observation& observation);
  // The bearing (rad, R) nearest to `wanted` in which the way is clear for `distance` m.
  std::optional<double> ClearBearing(double wanted, double distance, double clearance, double heading) const;
  bool IsClear(double bearing, double distance, double clearance) const;
  double RoomAhead() const;  // m
  Command Steer(const Observation& observation, const Vec2& p_R, double most);
  Command TurnAround();
  Command Drive(double speed, double turn) const;

  Settings settings_;
  DriveDescription drive_;
  Recovery recovery_;
  std::optional<std::size_t> ranger_;
  Shared<std::vector<PlacedRay>> rays_;
  std::vector<Vec2> obstacles_;        // hits, in R
  std::optional<double> last_course_;  // rad, in the frame of the estimate
  double side_ = 1.0;                  // 1: it turns to the left
  double stalled_at_ = 0.0;            // s, simulated, as all times: when it last began to back off
  double back_off_until_ = 0.0;
  double turn_until_ = 0.0;
  double best_distance_ = 0.0;  // m: the nearest to the point so far
  Vec2 best_target_{0.0, 0.0};  // in the frame of the estimate
  double progress_at_ = 0.0;    // when it was reached
  double roam_until_ = 0.0;
  double roam_course_ = 0.0;  // rad, in the frame of the estimate
  double new_course_at_ = 0.0;
};

// The rule of a flock: each robot moves with its neighbours.

// A robot nearby, in the frame R of this one.
struct Neighbour {
  Vec2 p_R{0.0, 0.0};    // m
  double heading = 0.0;  // rad
};

// Where to move, in R: ahead, in the mean direction of the neighbours, towards their middle if that is farther than
// `distance` m, and away from nearer neighbours. The longer, the more urgent: 1 for ahead alone. Zero where nothing
// decides.
Vec2 FlockDirection(const std::vector<Neighbour>& neighbours, double distance);

// The share of the full speed at which to move there: one that has to catch up is faster than one that is pushed back.
double FlockSpeed(const Vec2& direction);

}  // namespace troupe
