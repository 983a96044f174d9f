#include "robot-agent/controller/lane_tasks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/model/lane_rules.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kFacingGoal = 0.02;  // rad
constexpr double kNoPower = 30.0;     // s at a charger that gives nothing

}  // namespace

std::string NameOf(const LaneGraph& graph, std::size_t vertex) {
  const std::string& name = graph.vertices[vertex].name;
  return name.empty() ? "vertex " + std::to_string(vertex) : name;
}

// A goal's points are moved to the nearest vertices, on their level if the goal has heights.
std::vector<std::size_t> VerticesOf(const Goal& goal, const LaneGraph& graph, double z) {
  std::vector<std::size_t> vertices;
  for (std::size_t i = 0; i < goal.waypoints.size(); ++i) {
    const bool has_level = !goal.heights.empty();
    vertices.push_back(FindNearestVertex(graph, goal.waypoints[i], has_level ? goal.heights[i] : z,
                                         has_level ? kOnOneLevel : kOnAnyLevel)
                           ->vertex);
  }
  return vertices;
}

LaneTasks::LaneTasks(const LaneSettings& settings, const LaneGraph& graph, double speed, bool can_turn)
    : graph_(&graph),
      can_turn_(can_turn),
      turn_rate_(settings.turn_rate),
      wait_(settings.wait),
      repeat_(settings.repeat),
      keep_place_(settings.keep_place),
      charging_(settings, graph, speed) {
  if (settings.goods) goods_.emplace(graph);
  for (const std::string& place : settings.places) stops_.push_back(*graph_->Find(place));
}

void LaneTasks::Watch(const WorldDescription& world, const WorldState& state, RobotId own,
                      const std::vector<SeenRobot>& others, double radius) {
  charging_.Watch(state, own, FirstVertexOf(world.lane_graphs, *graph_), others, radius);
  if (goods_) goods_->Watch(world, state, own);
}

void LaneTasks::Update(const Observation& observation, std::size_t at, const std::vector<std::size_t>& barred) {
  ReadGoal(observation);
  const bool has_visited = !stops_.empty() && next_stop_ == stops_.size();
  if (keep_place_ && has_visited && at != stops_.back()) home_ = stops_.back();
  charging_.Update(observation, at, barred);
}

void LaneTasks::AddOrders(const Observation& observation, Command& command) {
  if (charging_.wants()) command.orders.emplace_back(charging_.order());
  if (!goods_) return;
  if (std::optional<std::string> report = goods_->TakeReport()) command.report = *std::move(report);
  const bool may_take = !charging_.wants() && next_goal_ >= goal_stops_.size();
  if (const std::optional<JobOrder> order = goods_->OrderFor(observation.time, may_take)) {
    command.orders.emplace_back(*order);
  }
}

// A goal of a user interrupts the round; its number tells a new goal from the same one.
void LaneTasks::ReadGoal(const Observation& observation) {
  const Goal* const goal = observation.goal;
  const std::optional<std::uint32_t> number = goal != nullptr ? std::optional(goal->number) : std::nullopt;
  if (number == goal_) return;
  goal_ = number;
  goal_stops_.clear();
  goal_heading_.reset();
  next_goal_ = 0;
  if (goal == nullptr) return;
  goal_stops_ = VerticesOf(*goal, *graph_, observation.pose_estimate.z);
  goal_heading_ = goal->heading;
}

// By falling precedence: giving way, charging, a user's goal, goods, the round, the way home. A robot that waits for a
// charger does nothing else, since its energy is low.
std::optional<std::size_t> LaneTasks::target() const {
  if (aside_) return aside_;
  if (charging_.wants()) return charging_.charger() ? charging_.charger() : charging_.waiting_place();
  if (next_goal_ < goal_stops_.size()) return goal_stops_[next_goal_];
  if (goods_ && goods_->has_job()) return goods_->target();
  if (!goal_ && next_stop_ < stops_.size()) return stops_[next_stop_];
  return home_ ? home_ : charging_.way_off();
}

// True: the stop is over and the next target counts.
bool LaneTasks::Rest(const Observation& observation, double rested, Command& command) {
  if (aside_) {
    if (rested < aside_seconds_) return false;
    aside_.reset();
    return true;
  }
  if (charging_.charger()) return Charge(observation, rested, command);
  if (charging_.wants()) return false;
  if (next_goal_ < goal_stops_.size()) return ArriveAtGoal(observation, command);
  if (goods_ && goods_->has_job()) {
    goods_->Rest(rested);
    return false;  // until the frame says so
  }
  if (!goal_ && next_stop_ < stops_.size()) {
    if (rested < wait_) return false;
    NextStop();
    return true;
  }
  home_.reset();
  return true;
}

void LaneTasks::NextStop() {
  ++next_stop_;
  if (repeat_ && next_stop_ == stops_.size()) next_stop_ = 0;
}

// A target that cannot be reached is dropped, of whatever kind it is.
void LaneTasks::LeaveOut(const Observation& observation) {
  if (aside_) {
    aside_.reset();
  } else if (charging_.wants()) {
    charging_.GiveUp(observation.time);
  } else if (next_goal_ < goal_stops_.size()) {
    ++next_goal_;
  } else if (goods_ && goods_->has_job()) {
    goods_->GiveUp(observation.time);
  } else if (!goal_ && next_stop_ < stops_.size()) {
    NextStop();
  } else if (home_) {
    home_.reset();
  } else {
    charging_.GiveUpWayOff();
  }
}

bool LaneTasks::Charge(const Observation& observation, double rested, Command& command) {
  if (observation.energy && observation.energy->charge_watts > 0.0) powered_at_ = observation.time;
  if (std::min(rested, observation.time - powered_at_) < kNoPower) return false;
  command.report = fmt::format("the charger {} gives no power", NameOf(*graph_, *charging_.charger()));
  LeaveOut(observation);
  return true;
}

// The heading counts at the last point only; a car cannot turn in place.
bool LaneTasks::ArriveAtGoal(const Observation& observation, Command& command) {
  const bool is_last = next_goal_ + 1 == goal_stops_.size();
  const double error = is_last && goal_heading_ ? WrapAngle(*goal_heading_ - observation.pose_estimate.heading) : 0.0;
  if (can_turn_ && std::fabs(error) > kFacingGoal) {
    command.twist.wz = std::clamp(error, -turn_rate_, turn_rate_);
    return false;
  }
  if (is_last) command.say = "reached " + NameOf(*graph_, goal_stops_[next_goal_]);
  ++next_goal_;
  return true;
}

void LaneTasks::GoAside(std::size_t vertex, double seconds, std::size_t from) {
  if (!target()) home_ = from;
  aside_ = vertex;
  aside_seconds_ = seconds;
}

}  // namespace troupe
