// PathFollower: drives along a path of Open-RMF as the plugin `slotcar` of rmf_simulation does: it turns in place
// towards the next point, drives there, and at the last one turns to its heading. It knows nothing of ROS.
//
// Deterministic and without a clock: the state is the path, the next point and the pause. The controller `slotcar` uses
// it for goals of users, and the ROS port for paths of Open-RMF.
//
// Times: a point with a time is not left before it; a pause holds at once, or at a checkpoint, while the path stays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "troupe/controller.h"
#include "troupe/result.h"
#include "troupe/vec2.h"

namespace troupe {

struct PathPoint {
  Vec2 position{0.0, 0.0};   // m, W
  double heading = 0.0;      // rad: of the robot while it waits here, and at the end
  double speed_limit = 0.0;  // m/s, on the way here; 0: none
  double time = 0.0;         // s, simulated: it does not leave before
  std::uint64_t index = 0;   // by which a pause names it
};

// The parameters of the controller `slotcar`.
struct SlotcarParameters {
  double speed = 0.7;           // m/s
  double turn_rate = 0.6;       // rad/s
  double stop_distance = 0.75;  // m: it does not drive while a robot or a person is near the point so far ahead,
  double stop_radius = 0.75;    // m: nearer than that; 0: it looks for none
  std::string fleet;            // by which Open-RMF knows it; empty: as ros::FleetOf says
};
Result<SlotcarParameters> ReadSlotcarParameters(const std::string& text);

// The speed (m/s, rad/s) from which `way` (m, rad) is covered without overshoot, in ticks of `seconds`.
double SpeedFor(double way, double most, double braking, double seconds);

class PathFollower {
 public:
  enum class State : std::uint8_t { kStands, kDrives, kHolds, kWaits };
  enum class Pause : std::uint8_t { kNone, kNow, kAtCheckpoint };

  PathFollower(const DriveDescription& drive, const SlotcarParameters& parameters)
      : drive_(drive), parameters_(parameters) {}

  // Replaces the path, whose first point is where the robot is. False: that is farther than 1 m from `at`; then the
  // robot stops. REQUIRES: `path` is not empty.
  bool Follow(std::vector<PathPoint> path, const Vec2& at);
  void Clear();
  // `checkpoint`: of kAtCheckpoint: the first PathPoint::index that it does not pass.
  void SetPause(Pause pause, std::uint64_t checkpoint = 0);

  // The motion of the next tick, in R. `is_blocked`: something is in the way.
  Twist Update(const Pose& X_WR, double time, double interval, bool is_blocked);

  bool has_path() const { return !path_.empty(); }
  // The first point that is not reached, by number; the number of all at the end.
  std::size_t next() const { return next_; }
  State state() const { return state_; }  // of the last Update

 private:
  bool Holds(const PathPoint& point, double time) const;
  double TurnBy(double angle, double interval) const;
  Twist DriveTo(const PathPoint& point, const Pose& X_WR, double interval) const;

  DriveDescription drive_;
  SlotcarParameters parameters_;
  std::vector<PathPoint> path_;
  std::size_t next_ = 0;
  Pause pause_ = Pause::kNone;
  std::uint64_t checkpoint_ = 0;
  bool was_held_ = false;
  State state_ = State::kStands;
};

}  // namespace troupe
