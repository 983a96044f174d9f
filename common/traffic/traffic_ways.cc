#include "common/traffic/traffic_ways.h"

#include <algorithm>
#include <utility>

#include "common/traffic/traffic_search.h"

namespace troupe {
namespace {

constexpr double kDelayWeight = 1.0;   // of a second that another robot loses, against one of its own
constexpr double kPushSeconds = 10.0;  // of the route past a robot that has to make room
constexpr std::size_t kWholeWay = static_cast<std::size_t>(-1);

}  // namespace

TrafficWays::TrafficWays(TrafficRoutes& routes, const std::vector<bool>& closed, std::vector<TrafficRobot>& robots,
                         const std::vector<bool>& is_fixed, std::span<const RowMove> granted,
                         std::vector<RowMove> moves)
    : routes_(routes),
      graph_(routes.graph()),
      closed_(closed),
      robots_(robots),
      is_fixed_(is_fixed),
      granted_(granted),
      moves_(std::move(moves)),
      has_no_way_(robots.size(), false) {
  for (const TrafficRobot& robot : robots_) places_.push_back(robot.at);
  for (const RowMove& move : granted_) places_[move.row] = move.to;
}

void TrafficWays::KeepPossible() {
  Formation formation(graph_, places_);
  std::vector<bool> is_cut = is_fixed_;
  std::erase_if(moves_, [&](const RowMove& move) {
    if (is_cut[move.row] || closed_[move.lane] || formation.place(move.row) != move.from ||
        !formation.CanMove(move.row, move.lane, move.to)) {
      is_cut[move.row] = true;
      return true;
    }
    formation.Move(move.row, move.lane, move.to);
    return false;
  });
}

std::vector<std::uint32_t> TrafficWays::EndPlaces() const {
  std::vector<std::uint32_t> places = places_;
  for (const RowMove& move : moves_) places[move.row] = move.to;
  return places;
}

void TrafficWays::MakeRoom(std::uint32_t vertex, std::uint32_t lane) {
  Formation formation(graph_, EndPlaces());
  const TrafficSearch search(graph_, closed_, routes_, is_fixed_);
  for (const std::uint32_t near : graph_.VerticesNearVertex(vertex)) {
    const std::uint32_t occupant = formation.occupant(near);
    if (occupant != Formation::kNone && !is_fixed_[occupant]) search.MakeRoom(formation, occupant, lane);
  }
  moves_.insert(moves_.end(), formation.moves().begin(), formation.moves().end());
}

// It has a goal, at which it will not be after the granted moves.
bool TrafficWays::IsOnWay(std::uint32_t row) const {
  const TrafficRobot& robot = robots_[row];
  return robot.goal && !IsAtGoal(robot) && places_[row] != *robot.goal;
}

// Those that the plan does not bring to their goals.
void TrafficWays::FindThoseWithoutWay() {
  for (std::uint32_t row = 0; row < robots_.size(); ++row) has_no_way_[row] = IsOnWay(row);
  for (const RowMove& move : moves_) {
    if (robots_[move.row].goal == move.to) has_no_way_[move.row] = false;
  }
}

std::vector<std::optional<std::uint32_t>> TrafficWays::FindBlockers() const {
  std::vector<std::optional<std::uint32_t>> blockers(robots_.size());
  const Formation formation(graph_, places_);
  for (std::uint32_t row = 0; row < robots_.size(); ++row) {
    if (!has_no_way_[row]) continue;
    const std::vector<float>& seconds = routes_.To(*robots_[row].goal);
    const TrafficExit* best = nullptr;
    for (const TrafficExit& exit : graph_.exits(places_[row])) {
      if (!closed_[exit.lane] && (best == nullptr || seconds[exit.to] < seconds[best->to])) best = &exit;
    }
    if (best == nullptr) continue;
    std::optional<std::uint32_t>& blocker = blockers[row];
    formation.ForEachBlocker(row, best->lane, best->to, [&](std::uint32_t other) {
      if (!blocker || other < *blocker) blocker = other;
    });
  }
  return blockers;
}

void TrafficWays::Plan(Tick tick) {
  FindThoseWithoutWay();
  std::vector<std::uint32_t> order;
  for (std::uint32_t row = 0; row < robots_.size(); ++row) {
    if (has_no_way_[row] && !is_fixed_[row]) order.push_back(row);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return robots_[a].since < robots_[b].since; });
  InsertWays(order, tick);
  if (tick % kSearchTicks == 0) SearchPastOthers(order, tick);
}

// Ways of robots among the moves of all others, in place of their own moves.
void TrafficWays::InsertWays(std::span<const std::uint32_t> order, Tick tick) {
  MoveSequence sequence(graph_, places_, granted_, moves_);
  PlanInsertion insertion(graph_, closed_);
  const auto insert = [&](std::uint32_t row) {
    const std::vector<MoveSequence::Step> present = sequence.TakeOut(row);
    const std::uint32_t goal = *robots_[row].goal;
    const auto steps = insertion.Find(sequence, row, goal, routes_.To(goal), kDelayWeight);
    sequence.PutBack(row, steps ? *steps : present);
    return steps.has_value();
  };
  for (const std::uint32_t row : order) {
    const TrafficRobot& robot = robots_[row];
    const bool has_turn = robot.since == tick || (tick + robot.robot.index()) % kTurnTicks == 0;
    if (has_turn && insertion.visits() < kMaxInsertionVisits) has_no_way_[row] = !insert(row);
  }
  if (!robots_.empty()) {
    const auto row = static_cast<std::uint32_t>(tick % robots_.size());
    if (IsOnWay(row) && !is_fixed_[row] && insert(row)) has_no_way_[row] = false;
  }
  moves_ = sequence.moves();
}

void TrafficWays::SearchPastOthers(std::span<const std::uint32_t> order, Tick tick) {
  std::size_t on_way = 0;
  for (std::uint32_t row = 0; row < robots_.size(); ++row) {
    on_way += robots_[row].goal && !IsAtGoal(robots_[row]) && !has_no_way_[row] ? 1 : 0;
  }
  const std::size_t free = graph_.vertices() - robots_.size();
  if (on_way >= kMinOnWay + free / kFreePerRobot) return;
  const std::vector<std::uint32_t> ends = EndPlaces();
  std::optional<std::vector<RowMove>> best;
  std::uint32_t best_row = 0;
  double least = 0.0;
  std::size_t candidates = 0;
  std::size_t visits = kMaxVisits;
  for (const std::uint32_t row : order) {
    if (!has_no_way_[row]) continue;
    if (candidates == kMaxCandidates) break;
    const bool is_thorough = candidates++ == 0 && tick % kThoroughTicks == 0;
    std::size_t left = is_thorough ? kMaxThoroughVisits : visits;
    std::optional<std::vector<RowMove>> moves = Push(row, left, ends);
    if (!is_thorough) visits = left;
    if (!moves) {
      // Without a way to its goal it would stand in the ways of all others.
      if (is_thorough) robots_[row].since = tick;
      continue;
    }
    const auto waited = static_cast<double>(tick - robots_[row].since);
    const double cost = static_cast<double>(moves->size()) - waited / kTicksPerMove;
    if (best && cost >= least) continue;
    best = std::move(moves);
    best_row = row;
    least = cost;
  }
  if (!best) return;
  moves_.insert(moves_.end(), best->begin(), best->end());
  has_no_way_[best_row] = false;
}

// A way to its goal after all other moves, past robots that make room; not those with older goals and no way. `visits`:
// of vertices, that it may make; it counts them down.
std::optional<std::vector<RowMove>> TrafficWays::Push(std::uint32_t row, std::size_t& visits,
                                                      std::span<const std::uint32_t> ends) const {
  std::vector<bool> is_fixed = is_fixed_;
  for (std::uint32_t other = 0; other < is_fixed.size(); ++other) {
    const bool is_older = std::pair(robots_[other].since, other) < std::pair(robots_[row].since, row);
    if (is_older && has_no_way_[other]) is_fixed[other] = true;
  }
  const std::uint32_t goal = *robots_[row].goal;
  const std::vector<float>& seconds = routes_.To(goal);
  Formation formation(graph_, {ends.begin(), ends.end()});
  const TrafficSearch search(graph_, closed_, routes_, is_fixed);
  while (formation.place(row) != goal) {
    const std::size_t begun = formation.moves().size();
    const float left = seconds[formation.place(row)];
    const bool has_moved = search.Find(formation, row, goal, kWholeWay, kPushSeconds);
    if (has_moved && seconds[formation.place(row)] < left) continue;
    formation.UndoTo(begun);
    const bool is_found = search.FindAnyWay(formation, row, goal, visits);
    visits -= std::min(visits, search.visits());
    if (!is_found) return std::nullopt;
  }
  return formation.moves();
}

}  // namespace troupe
