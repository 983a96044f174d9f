// What is on lanes beside robots: boxes, people, walls, open leaves of doors; and the lanes that a robot keeps off
// because of them.
//
// A robot looks along its lane with its own body: the exact sweep of the step (common/spatial/sweep.h) from its place
// on the line. So a lane on which it fits is free however near the walls are, and one on which anything would stop it
// is not. Robots are found by lane_traffic.h, since they move on.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/navigation/surroundings.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

struct LaneObstacle {
  ModelId model;      // the static model, or the root of the object or person
  std::string name;   // of the static model, or of the root of the object or person
  double room = 0.0;  // m, that the robot can move until it touches it
  bool is_person = false;
  bool walks = false;  // it is a person who walks, and perhaps moves on
  bool comes = false;  // likewise, and against the direction of the robot
};

// The obstacle of FindContactAhead. Nothing also where it is a robot, or a leaf of a door that is not open: these move.
std::optional<LaneObstacle> FindObstacleAhead(const Surroundings& around, RobotId own, const Pose& X_WR,
                                              const Vec2& direction, double way);

// The lanes that a robot keeps off for a time, which doubles with each block of a lane until it has passed it.
class ClosedLanes {
 public:
  static constexpr double kFirstSeconds = 60.0;
  static constexpr double kMaxSeconds = 1920.0;

  struct Block {
    double seconds = 0.0;    // for which the lane is closed, if it is
    bool is_longer = false;  // than after the last block
  };
  // Counts a block of the lane.
  Block Count(std::size_t lane);
  // From `time` (s) on, for the seconds of the last block. REQUIRES: Count
  void Close(std::size_t lane, double time);
  void Forget(std::size_t lane);

  std::vector<std::size_t> At(double time) const;  // ascending

 private:
  struct Entry {
    std::size_t lane = 0;
    double seconds = 0.0;
    double until = 0.0;  // s, simulated
  };
  std::vector<Entry>::iterator Find(std::size_t lane);

  std::vector<Entry> entries_;  // ascending
};

}  // namespace troupe
