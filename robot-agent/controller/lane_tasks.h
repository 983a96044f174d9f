// LaneTasks: where a robot on lanes goes next: aside, to a charger, to a user's goal, for its goods, to its own places,
// or back to where it waited, in this order.
//
// Each kind of destination keeps its own progress: a robot that has been charged, or has made room, continues the goal
// or the round that it had. Places are vertices of its graph; a goal of a user is moved to the nearest vertex. It knows
// nothing of motion, doors or other robots: LanesController (lanes.cc) asks it for a target, and tells when the target
// is reached or cannot be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/controller/lane_charging.h"
#include "robot-agent/controller/lane_goods.h"
#include "robot-agent/controller/lane_settings.h"
#include "troupe/controller.h"

namespace troupe {

class LaneTasks {
 public:
  // `speed`: m/s, of the robot; `can_turn`: on the spot. REQUIRES: the graph, which outlives this, has all places of
  // the settings.
  LaneTasks(const LaneSettings& settings, const LaneGraph& graph, double speed, bool can_turn);

  // What the frame says of chargers and goods; before Update.
  void Watch(const WorldDescription& world, const WorldState& state, RobotId own, const std::vector<SeenRobot>& others,
             double radius);
  // Reads the goal and the energy of a tick. `at`: the vertex that the robot was at last; `barred`: lanes that it does
  // not begin.
  void Update(const Observation& observation, std::size_t at, const std::vector<std::size_t>& barred);
  // Adds what the robot asks of chargers and says of goods to the orders of a tick.
  void AddOrders(const Observation& observation, Command& command);

  // The vertex to go to; nothing: it waits for a goal.
  std::optional<std::size_t> target() const;

  // The robot has been at the target for `rested` s; its turns and texts there are added to `command`. True: the next
  // target begins.
  bool Rest(const Observation& observation, double rested, Command& command);
  // No lanes lead to the target, so that the next one comes.
  void LeaveOut(const Observation& observation);

  // To a vertex beside the way of another robot, for `seconds` there. A robot that has no destination comes back to
  // `from`.
  void GoAside(std::size_t vertex, double seconds, std::size_t from);
  bool is_aside() const { return aside_.has_value(); }

 private:
  void ReadGoal(const Observation& observation);
  bool Charge(const Observation& observation, double rested, Command& command);
  bool ArriveAtGoal(const Observation& observation, Command& command);
  void NextStop();

  const LaneGraph* graph_;
  bool can_turn_;
  double turn_rate_;
  double wait_;  // s, at each stop
  bool repeat_;
  bool keep_place_;
  std::vector<std::size_t> stops_;
  std::size_t next_stop_ = 0;
  std::optional<std::uint32_t> goal_;  // the user's
  std::vector<std::size_t> goal_stops_;
  std::optional<double> goal_heading_;
  std::size_t next_goal_ = 0;
  LaneCharging charging_;
  double powered_at_ = 0.0;  // s, simulated: when it last got power
  std::optional<LaneGoods> goods_;
  std::optional<std::size_t> aside_;
  double aside_seconds_ = 0.0;
  std::optional<std::size_t> home_;  // where it waited for a goal before it went aside
};

// The vertices nearest to the points of a goal: of the levels of their heights; without heights, of the level at `z` or
// at exactly the point. REQUIRES: the graph has a vertex.
std::vector<std::size_t> VerticesOf(const Goal& goal, const LaneGraph& graph, double z);

// The name of a vertex in messages.
std::string NameOf(const LaneGraph& graph, std::size_t vertex);

}  // namespace troupe
