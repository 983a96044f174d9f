#include "common/traffic/plan_insertion.h"

#include <algorithm>
#include <limits>
#include <map>
#include <queue>
#include <tuple>

namespace troupe {
PlanInsertion::PlanInsertion(const TrafficGraph& graph, const std::vector<bool>& closed,
                             std::span<const std::uint32_t> places, std::span<const TimedMove> moves, std::uint32_t row,
                             double ready, std::span<const double> busy)
    : graph_(graph),
      closed_(closed),
      places_(places),
      moves_(moves),
      row_(row),
      ready_(ready),
      busy_(busy),
      stays_(graph.vertices()),
      members_(graph.groups()),
      hits_(graph.vertices()),
      free_(2 * graph.lanes()),
      conflicts_(graph.lanes()),
      moves_on_(graph.lanes()),
      moves_in_(graph.groups()) {
  FindStays();
  FindHits();
}

void PlanInsertion::FindStays() {
  std::vector<std::uint32_t> at(places_.begin(), places_.end());
  std::vector<std::size_t> since(at.size(), 0);
  const auto add = [&](std::uint32_t row, std::size_t end) {
    const Range stay{since[row], end};
    stays_[at[row]].push_back(stay);
    for (const std::uint32_t group : graph_.GroupsOfVertex(at[row])) members_[group].push_back(stay);
  };
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    const RowMove& move = moves_[i].move;
    add(move.row, i);
    at[move.row] = move.to;
    since[move.row] = i + 1;
    moves_on_[move.lane].push_back(i);
    for (const std::uint32_t group : graph_.GroupsOfLane(move.lane)) moves_in_[group].push_back(i);
  }
  for (std::uint32_t row = 0; row < at.size(); ++row) {
    if (row != row_) add(row, moves_.size());
  }
}

// Where the robot would keep another one from a move.
void PlanInsertion::FindHits() {
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    const RowMove& move = moves_[i].move;
    const auto add = [&](std::uint32_t vertex) {
      if (hits_[vertex].empty() || hits_[vertex].back() != i) hits_[vertex].push_back(i);
    };
    ForEachNeed(graph_, move.from, move.lane, move.to, add, [&](std::uint32_t group) {
      for (const std::uint32_t vertex : graph_.VerticesOfGroup(group)) add(vertex);
    });
  }
}

PlanInsertion::Range PlanInsertion::RestAt(std::uint32_t vertex, std::size_t position) const {
  const std::vector<std::size_t>& hits = hits_[vertex];
  const auto next = std::lower_bound(hits.begin(), hits.end(), position);
  return {next == hits.begin() ? 0 : *(next - 1) + 1, next == hits.end() ? moves_.size() : *next};
}

// Positions at which no robot at rest keeps it from a move; ascending, apart.
const std::vector<PlanInsertion::Range>& PlanInsertion::FreeRanges(std::uint32_t from, const TrafficExit& exit) {
  std::optional<std::vector<Range>>& known = free_[2 * exit.lane + (exit.to == graph_.end(exit.lane) ? 0 : 1)];
  if (known) return *known;
  std::vector<Range> blocked;
  const auto add = [&](const std::vector<Range>& stays) { blocked.insert(blocked.end(), stays.begin(), stays.end()); };
  ForEachNeed(
      graph_, from, exit.lane, exit.to, [&](std::uint32_t vertex) { add(stays_[vertex]); },
      [&](std::uint32_t group) { add(members_[group]); });
  std::sort(blocked.begin(), blocked.end(), [](const Range& a, const Range& b) { return a.begin < b.begin; });
  std::vector<Range> free;
  std::size_t next = 0;  // the first position after those that are known to be blocked
  for (const Range& range : blocked) {
    if (range.begin > next) free.push_back({next, range.begin - 1});
    next = std::max(next, range.end + 1);
  }
  if (next <= moves_.size()) free.push_back({next, moves_.size()});
  return known.emplace(std::move(free));
}

const PlanInsertion::Conflicts& PlanInsertion::ConflictsOf(std::uint32_t lane) {
  Conflicts& known = conflicts_[lane];
  if (known.is_known) return known;
  known.is_known = true;
  std::vector<std::size_t>& positions = known.positions;
  for (const std::uint32_t near : graph_.LanesNearLane(lane)) {
    positions.insert(positions.end(), moves_on_[near].begin(), moves_on_[near].end());
  }
  for (const std::uint32_t group : graph_.GroupsOfLane(lane)) {
    positions.insert(positions.end(), moves_in_[group].begin(), moves_in_[group].end());
  }
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  known.latest_finish.resize(positions.size());
  known.earliest_start.resize(positions.size());
  double latest = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    known.latest_finish[i] = latest = std::max(latest, moves_[positions[i]].finish);
  }
  double earliest = kNever;
  for (std::size_t i = positions.size(); i-- > 0;) {
    known.earliest_start[i] = earliest = std::min(earliest, moves_[positions[i]].start);
  }
  return known;
}

// Whether it may rest there after all moves of the others.
bool PlanInsertion::IsFreeAtEnd(std::uint32_t vertex) const {
  const auto is_last = [&](const Range& stay) { return stay.end == moves_.size(); };
  for (const std::uint32_t near : graph_.VerticesNearVertex(vertex)) {
    if (std::any_of(stays_[near].begin(), stays_[near].end(), is_last)) return false;
  }
  for (const std::uint32_t group : graph_.GroupsOfVertex(vertex)) {
    if (std::any_of(members_[group].begin(), members_[group].end(), is_last)) return false;
  }
  return true;
}

// Calls visit(position, rest, finish, delay) for the moves along an exit: for each range of positions at the end of the
// lane the first one possible, and the best one after moves that would lose time by it. `delay` with its weight.
template <typename Visit>
void PlanInsertion::ForEachNext(const State& state, const TrafficExit& exit, double delay_weight, const Visit& visit) {
  const Conflicts& conflicts = ConflictsOf(exit.lane);
  const auto move_at = [&](std::size_t position) {
    const auto next = std::lower_bound(conflicts.positions.begin(), conflicts.positions.end(), position);
    const auto index = static_cast<std::size_t>(next - conflicts.positions.begin());
    const double free = index == 0 ? 0.0 : conflicts.latest_finish[index - 1];
    const double finish = std::max({state.seconds, free, busy_[exit.lane]}) + exit.seconds;
    const bool is_last = index == conflicts.positions.size();
    const double delay = is_last ? 0.0 : std::max(0.0, finish - conflicts.earliest_start[index]);
    return std::pair(finish, delay_weight * delay);
  };
  for (const Range& free : FreeRanges(state.vertex, exit)) {
    const std::size_t until = std::min(free.end, state.rest.end);
    for (std::size_t from = std::max(free.begin, state.position); from <= until;) {
      const Range rest = RestAt(exit.to, from);
      const std::size_t to = std::min(until, rest.end);
      auto [finish, delay] = move_at(from);
      visit(from, rest, finish, delay);
      std::size_t best = from;
      auto next = std::lower_bound(conflicts.positions.begin(), conflicts.positions.end(), from);
      for (; delay > 0.0 && next != conflicts.positions.end() && *next < to; ++next) {
        const auto [later, less] = move_at(*next + 1);
        if (later + less >= finish + delay) continue;
        finish = later;
        delay = less;
        best = *next + 1;
      }
      if (best != from) visit(best, rest, finish, delay);
      from = rest.end + 1;
    }
  }
}

std::optional<std::vector<PlanInsertion::Step>> PlanInsertion::Find(std::uint32_t goal,
                                                                    const std::vector<float>& seconds_to_goal,
                                                                    double delay_weight) {
  if (!IsFreeAtEnd(goal)) return std::nullopt;
  std::vector<State> states;
  using Entry = std::tuple<double, std::size_t, std::uint32_t>;  // cost, position, state
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  // The least position with which each vertex and range has been left.
  std::map<std::pair<std::uint32_t, std::size_t>, std::size_t> done;
  const auto add = [&](const State& state) {
    const auto left = static_cast<double>(seconds_to_goal[state.vertex]);
    if (left == kNever) return;
    const auto found = done.find({state.vertex, state.rest.begin});
    if (found != done.end() && found->second <= state.position) return;
    open.push({state.seconds + state.delays + left, state.position, static_cast<std::uint32_t>(states.size())});
    states.push_back(state);
  };
  add({.vertex = places_[row_], .rest = RestAt(places_[row_], 0), .seconds = ready_});
  while (!open.empty()) {
    const std::uint32_t number = std::get<2>(open.top());
    open.pop();
    const State state = states[number];
    const auto [found, is_new] = done.try_emplace({state.vertex, state.rest.begin}, state.position);
    if (!is_new && found->second <= state.position) continue;
    found->second = state.position;
    if (state.rest.end == moves_.size() && state.vertex == goal) {
      std::vector<Step> steps;
      for (std::uint32_t at = number; states[at].parent != Formation::kNone; at = states[at].parent) {
        steps.push_back({states[at].position, states[at].by});
      }
      std::reverse(steps.begin(), steps.end());
      return steps;
    }
    for (const TrafficExit& exit : graph_.exits(state.vertex)) {
      if (closed_[exit.lane]) continue;
      ForEachNext(state, exit, delay_weight, [&](std::size_t position, const Range& rest, double finish, double delay) {
        add({exit.to, position, rest, finish, state.delays + delay, number, exit});
      });
    }
  }
  return std::nullopt;
}

}  // namespace troupe
