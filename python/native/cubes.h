// CubeJobs: who brings which cube where, in one world of the tasks Carrying and Stacking (troupe/rl/grippers.py).
//
// A robot with a cube goes to the first free place; one without to the nearest cube that is at no place and in no
// gripper, except for those that robots with lower numbers go to. Memory of an episode: the place of each cube, and
// which have been gripped before.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "troupe/vec2.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::python {

struct CubePlace {
  Vec2 at{0.0, 0.0};   // m, in W
  double level = 0.0;  // 0 on the ground, 1 on another cube, and so on
};

// What a robot knows, and what it has just done. Vectors are in W, from the robot's origin.
struct CubeJob {
  Vec2 goal{0.0, 0.0};
  double goal_level = 0.0;
  double way = 0.0;      // rad, in W: the direction in which to arrive
  Vec2 cube{0.0, 0.0};   // the nearest other cube
  Vec2 peer{0.0, 0.0};   // the nearest other robot
  bool gripped = false;  // a cube, the first time, at this step
  bool placed = false;   // a cube, at this step
  bool idle = false;     // no cube is left for it
};

class CubeJobs {
 public:
  explicit CubeJobs(std::size_t robots, std::size_t cubes);

  void Begin();
  // By the state after a step. `held`: the cube in the gripper of each robot.
  const std::vector<CubeJob>& Update(const WorldState& state, const std::vector<std::optional<std::size_t>>& held,
                                     const std::vector<CubePlace>& places);

 private:
  void Score(const WorldState& state, const std::vector<std::optional<std::size_t>>& held,
             const std::vector<CubePlace>& places);
  void Guide(const WorldState& state, const std::vector<CubePlace>& places);
  CubePlace PlaceFor(std::size_t robot, const std::vector<CubePlace>& places) const;

  std::vector<CubeJob> jobs_;                         // by robot
  std::vector<std::optional<std::size_t>> carried_;   // by robot: the cube in its gripper
  std::vector<std::optional<std::size_t>> place_of_;  // by cube
  std::vector<bool> was_gripped_;                     // by cube
};

}  // namespace troupe::python
