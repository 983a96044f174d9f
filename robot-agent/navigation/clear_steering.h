// ClearSteering: the motion towards a point, or nowhere in particular, around the obstacles that a ranger sees. It
// knows only what the ranger sees at present, so that a dead end can catch it: without progress it roams for a while.
#pragma once

#include <optional>
#include <vector>

#include "robot-agent/navigation/rays.h"
#include "robot-agent/navigation/recovery.h"
#include "robot-agent/navigation/steer_to_point.h"
#include "troupe/controller.h"

namespace troupe {

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
  std::vector<PlacedRay> rays_;
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

}  // namespace troupe
