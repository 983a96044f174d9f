// LaneCharging: how a robot on lanes comes to a charger that others want, too.
//
// A robot whose energy is low asks for the charger that it reaches soonest of those that are free, and, while there is
// none, for the nearest place where it can wait: by a ChargeOrder in each tick. The world decides who gets what
// (world-service/core/charging.cc), and the robot reads that from the next frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "robot-agent/controller/lane_settings.h"
#include "robot-agent/navigation/lane_traffic.h"
#include "troupe/controller.h"
#include "troupe/world_state.h"

namespace troupe {

class LaneCharging {
 public:
  // `speed`: m/s. The graph outlives this.
  LaneCharging(const LaneSettings& settings, const LaneGraph& graph, double speed)
      : graph_(&graph), speed_(speed), below_(settings.charge_below), to_(settings.charge_to) {}

  // What the frame says of robots at chargers. `first_vertex`: the number of the first vertex of the graph through all
  // graphs.
  void Watch(const WorldState& state, RobotId own, std::size_t first_vertex, const std::vector<SeenRobot>& others,
             double radius);
  // `at`: the vertex that the robot was at last; `barred`: lanes that it does not begin.
  void Update(const Observation& observation, std::size_t at, const std::vector<std::size_t>& barred);

  bool wants() const { return wants_; }
  // The charger that it has.
  std::optional<std::size_t> charger() const { return at_charger_ ? vertex_ : std::nullopt; }
  // The place where it waits for one; nothing: it waits where it is.
  std::optional<std::size_t> waiting_place() const { return at_charger_ ? std::nullopt : vertex_; }
  // Where it goes from a charger that it does not need and others wait for.
  std::optional<std::size_t> way_off() const { return off_; }
  // While it wants to charge.
  ChargeOrder order() const { return order_; }
  // The charger gives no power, or cannot be reached: it goes on without, for a while.
  void GiveUp(double time);
  // It cannot go from its charger.
  void GiveUpWayOff() { off_.reset(); }

 private:
  bool IsFree(std::size_t vertex) const;
  std::optional<std::size_t> Soonest(std::size_t at, bool charger, bool only_free,
                                     const std::vector<std::size_t>& barred) const;
  void LeaveCharger(std::size_t at, const std::vector<std::size_t>& barred);
  std::optional<std::size_t> AnyOther(std::size_t at, const std::vector<std::size_t>& barred) const;
  void Choose(double time, std::size_t at, const std::vector<std::size_t>& barred);

  const LaneGraph* graph_;
  double speed_;
  double below_;
  double to_;
  // Of the frame.
  std::size_t first_vertex_ = 0;
  std::vector<std::uint32_t> taken_;   // by other robots, through all graphs
  std::vector<std::size_t> occupied_;  // chargers and waiting places with another robot on them

  bool others_wait_ = false;

  bool wants_ = false;
  std::optional<std::size_t> off_;
  std::optional<std::size_t> vertex_;  // that the robot has
  bool at_charger_ = false;
  ChargeOrder order_;
  double after_ = 0.0;  // s: it does not want to charge before
  // For which the last choice was made.
  struct Choice {
    std::size_t at = 0;
    std::vector<std::uint32_t> taken = {};
    std::vector<std::size_t> occupied = {};
    std::vector<std::size_t> barred = {};
    std::optional<std::size_t> vertex = {};
    bool operator==(const Choice&) const = default;
  };
  std::optional<Choice> choice_;
};

}  // namespace troupe
