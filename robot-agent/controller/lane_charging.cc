#include "robot-agent/controller/lane_charging.h"

#include <algorithm>
#include <utility>

#include "robot-agent/navigation/lane_route.h"

namespace troupe {
namespace {

constexpr double kNextCharge = 300.0;  // s, until it tries again

}  // namespace

void LaneCharging::Watch(const WorldState& state, RobotId own, std::size_t first_vertex,
                         const std::vector<SeenRobot>& others, double radius) {
  first_vertex_ = first_vertex;
  taken_.clear();
  vertex_.reset();
  at_charger_ = false;
  others_wait_ = false;
  for (const ChargingRobot& row : state.charging_robots) {
    if (row.robot != own) {
      if (row.vertex) taken_.push_back(*row.vertex);
      others_wait_ = others_wait_ || !row.at_charger;
    } else if (row.vertex && *row.vertex >= first_vertex && *row.vertex - first_vertex < graph_->vertices.size()) {
      vertex_ = *row.vertex - first_vertex;
      at_charger_ = row.at_charger;
    }
  }
  occupied_.clear();
  if (!wants_ && !others_wait_) return;
  for (std::size_t i = 0; i < graph_->vertices.size(); ++i) {
    const LaneVertex& vertex = graph_->vertices[i];
    if ((vertex.is_charger || vertex.is_waiting_place) && IsTaken(vertex, others, radius)) occupied_.push_back(i);
  }
}

void LaneCharging::Update(const Observation& observation, std::size_t at, const std::vector<std::size_t>& barred) {
  LeaveCharger(at, barred);
  if (!observation.energy || observation.energy->capacity <= 0.0) return;
  const double level = observation.energy->joules / observation.energy->capacity;
  if (!wants_) {
    if (level >= below_ || observation.time < after_) return;
    wants_ = true;
    choice_.reset();
  } else if (level >= to_) {
    wants_ = false;
    return;
  }
  if (at_charger_) {
    order_ = {.vertex = static_cast<std::uint32_t>(first_vertex_ + *vertex_), .at_charger = true};
  } else {
    Choose(observation.time, at, barred);
  }
}

// A parked robot would keep its charger for ever.
void LaneCharging::LeaveCharger(std::size_t at, const std::vector<std::size_t>& barred) {
  if (wants_ || off_ == at) off_.reset();
  if (wants_ || off_ || !others_wait_ || !graph_->vertices[at].is_charger) return;
  off_ = Soonest(at, false, true, barred);
  if (!off_) off_ = AnyOther(at, barred);
}

// The nearest vertex that is no charger, in no lift and no group.
std::optional<std::size_t> LaneCharging::AnyOther(std::size_t at, const std::vector<std::size_t>& barred) const {
  std::optional<std::size_t> nearest;
  double least = 0.0;
  for (std::size_t i = 0; i < graph_->vertices.size(); ++i) {
    const LaneVertex& vertex = graph_->vertices[i];
    if (vertex.is_charger || vertex.lift || !vertex.mutex.empty()) continue;
    const double distance = graph_->Way(at, i).norm();
    if ((nearest && distance >= least) || !FastestRoute(*graph_, at, i, speed_, barred)) continue;
    nearest = i;
    least = distance;
  }
  return nearest;
}

// By its own wish for as long as nothing has changed: a search in each tick would cost more than all else.
void LaneCharging::Choose(double time, std::size_t at, const std::vector<std::size_t>& barred) {
  Choice choice{at, taken_, occupied_, barred, vertex_};
  if (choice_ == choice) return;
  choice_ = std::move(choice);
  order_ = {};
  std::optional<std::size_t> wish = Soonest(at, true, true, barred);
  order_.at_charger = wish.has_value();
  if (!wish) {
    if (!Soonest(at, true, false, {})) return GiveUp(time);  // no lanes lead to any
    wish = vertex_ ? vertex_ : Soonest(at, false, true, barred);
  }
  if (wish) order_.vertex = static_cast<std::uint32_t>(first_vertex_ + *wish);
}

void LaneCharging::GiveUp(double time) {
  wants_ = false;
  after_ = time + kNextCharge;
}

bool LaneCharging::IsFree(std::size_t vertex) const {
  const auto number = static_cast<std::uint32_t>(first_vertex_ + vertex);
  return std::find(taken_.begin(), taken_.end(), number) == taken_.end() &&
         std::find(occupied_.begin(), occupied_.end(), vertex) == occupied_.end();
}

// Not the nearest one in the plane; of equal ones the first.
std::optional<std::size_t> LaneCharging::Soonest(std::size_t at, bool charger, bool only_free,
                                                 const std::vector<std::size_t>& barred) const {
  std::optional<std::size_t> soonest;
  double least = 0.0;
  for (std::size_t i = 0; i < graph_->vertices.size(); ++i) {
    const LaneVertex& vertex = graph_->vertices[i];
    if (!(charger ? vertex.is_charger : vertex.is_waiting_place && !vertex.is_charger)) continue;
    if (only_free && !IsFree(i)) continue;
    const std::optional<LaneRoute> route = FastestRoute(*graph_, at, i, speed_, barred);
    if (!route || (soonest && route->seconds >= least)) continue;
    least = route->seconds;
    soonest = i;
  }
  return soonest;
}

}  // namespace troupe
