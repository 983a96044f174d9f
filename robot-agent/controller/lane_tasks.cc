#include "robot-agent/controller/lane_tasks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot-agent/navigation/lane_route.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kFacingGoal = 0.02;   // rad
constexpr double kNoPower = 30.0;      // s at a charger that gives nothing
constexpr double kNextCharge = 300.0;  // s, until it tries again

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
      speed_(speed),
      can_turn_(can_turn),
      turn_rate_(settings.turn_rate),
      wait_(settings.wait),
      repeat_(settings.repeat),
      keep_place_(settings.keep_place),
      charge_below_(settings.charge_below),
      charge_to_(settings.charge_to) {
  for (const std::string& place : settings.places) stops_.push_back(*graph_->Find(place));
}

void LaneTasks::Update(const Observation& observation, std::size_t at) {
  ReadGoal(observation);
  ReadEnergy(observation, at);
  const bool has_visited = !stops_.empty() && next_stop_ == stops_.size();
  if (keep_place_ && has_visited && at != stops_.back()) home_ = stops_.back();
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

void LaneTasks::ReadEnergy(const Observation& observation, std::size_t at) {
  if (!observation.energy || observation.energy->capacity <= 0.0) return;
  const double level = observation.energy->joules / observation.energy->capacity;
  if (charger_) {
    if (level >= charge_to_) charger_.reset();
    return;
  }
  if (level >= charge_below_ || observation.time < charge_after_) return;
  std::optional<double> least;
  for (std::size_t i = 0; i < graph_->vertices.size(); ++i) {
    if (!graph_->vertices[i].is_charger) continue;
    // The charger that is reached soonest, not the nearest one in the plane.
    const std::optional<LaneRoute> route = FastestRoute(*graph_, at, i, speed_);
    if (!route || (least && route->seconds >= *least)) continue;
    least = route->seconds;
    charger_ = i;
  }
  // Without a charger in reach: a search in each tick would cost more than all else.
  if (!charger_) charge_after_ = observation.time + kNextCharge;
}

// By falling precedence: giving way, charging, a user's goal, the round, the way home.
std::optional<std::size_t> LaneTasks::target() const {
  if (aside_) return aside_;
  if (charger_) return charger_;
  if (next_goal_ < goal_stops_.size()) return goal_stops_[next_goal_];
  if (!goal_ && next_stop_ < stops_.size()) return stops_[next_stop_];
  return home_;
}

// True: the stop is over and the next target counts.
bool LaneTasks::Rest(const Observation& observation, double rested, Command& command) {
  if (aside_) {
    if (rested < aside_seconds_) return false;
    aside_.reset();
    return true;
  }
  if (charger_) return Charge(observation, rested, command);
  if (next_goal_ < goal_stops_.size()) return ArriveAtGoal(observation, command);
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
  } else if (charger_) {
    charger_.reset();
    charge_after_ = observation.time + kNextCharge;
  } else if (next_goal_ < goal_stops_.size()) {
    ++next_goal_;
  } else if (!goal_ && next_stop_ < stops_.size()) {
    NextStop();
  } else {
    home_.reset();
  }
}

bool LaneTasks::Charge(const Observation& observation, double rested, Command& command) {
  if (observation.energy && observation.energy->charge_watts > 0.0) powered_at_ = observation.time;
  if (std::min(rested, observation.time - powered_at_) < kNoPower) return false;
  command.report = fmt::format("the charger {} gives no power", NameOf(*graph_, *charger_));
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
