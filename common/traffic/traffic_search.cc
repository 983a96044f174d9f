#include "common/traffic/traffic_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <set>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kMaxTargets = 12;   // that a robot may be pushed to, tried from the nearest
constexpr std::size_t kMaxPushes = 32;    // for one lane
constexpr std::size_t kMaxTransfers = 8;  // of free vertices across a vertex
constexpr double kUnreached = std::numeric_limits<double>::infinity();

using Entry = std::pair<double, std::uint32_t>;  // s, vertex or state
using Queue = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

}  // namespace

std::vector<TrafficExit> TrafficSearch::FindRoute(const Formation& formation, std::uint32_t row, std::uint32_t goal,
                                                  double push_seconds) const {
  struct Reached {
    double seconds = kUnreached;
    std::uint32_t from = Formation::kNone;
    TrafficExit by = {};
    bool is_final = false;
  };
  std::vector<Reached> reached(graph_.vertices());
  Queue open;
  const std::uint32_t start = formation.place(row);
  reached[start].seconds = 0.0;
  open.push({0.0, start});
  while (!open.empty() && !reached[goal].is_final) {
    const std::uint32_t vertex = open.top().second;
    open.pop();
    if (std::exchange(reached[vertex].is_final, true)) continue;
    for (const TrafficExit& exit : graph_.exits(vertex)) {
      if (closed_[exit.lane] || reached[exit.to].is_final) continue;
      double seconds = reached[vertex].seconds + exit.seconds;
      bool is_free = true;
      const auto meet = [&](std::uint32_t other) {
        if (other == row) return;
        is_free = is_free && !is_fixed_[other];
        seconds += push_seconds;
      };
      if (vertex == start) {
        formation.ForEachBlocker(row, exit.lane, exit.to, meet);
      } else {
        formation.ForEachNear(exit.lane, meet);
      }
      if (!is_free || seconds >= reached[exit.to].seconds) continue;
      reached[exit.to] = {seconds, vertex, exit, false};
      open.push({seconds, exit.to});
    }
  }
  std::vector<TrafficExit> route;
  if (!reached[goal].is_final) return route;
  for (std::uint32_t vertex = goal; vertex != start; vertex = reached[vertex].from) route.push_back(reached[vertex].by);
  std::reverse(route.begin(), route.end());
  return route;
}

TrafficSearch::Marks TrafficSearch::Near(std::span<const TrafficExit> lanes) const {
  Marks marks(graph_.vertices(), false);
  for (const TrafficExit& exit : lanes) {
    for (const std::uint32_t vertex : graph_.VerticesNearLane(exit.lane)) marks[vertex] = true;
  }
  return marks;
}

bool TrafficSearch::Find(Formation& formation, std::uint32_t row, std::uint32_t goal, std::size_t own_moves,
                         double push_seconds) const {
  const std::vector<TrafficExit> route = FindRoute(formation, row, goal, push_seconds);
  const std::size_t begun = formation.moves().size();
  std::size_t open = begun;  // moves, with which the robot is at a vertex at which it may wait
  for (std::size_t i = 0; i < route.size() && (i < own_moves || open != formation.moves().size()); ++i) {
    const TrafficExit& exit = route[i];
    if (!formation.CanMove(row, exit.lane, exit.to)) {
      const std::span<const TrafficExit> rest = std::span(route).subspan(i);
      if (!Clear(formation, row, exit.lane, exit.to, Near(rest), Near(rest.first(1)))) break;
    }
    formation.Move(row, exit.lane, exit.to);
    if (graph_.IsOpen(exit.to) || exit.to == goal) open = formation.moves().size();
  }
  formation.UndoTo(open);
  return open != begun;
}

// Pushes all robots out of the way of one along a lane: out of `best` where that is possible, else out of `good`.
bool TrafficSearch::Clear(Formation& formation, std::uint32_t row, std::uint32_t lane, std::uint32_t to,
                          const Marks& best, const Marks& good) const {
  for (std::size_t i = 0; i < kMaxPushes; ++i) {
    std::optional<std::uint32_t> blocker;
    formation.ForEachBlocker(row, lane, to, [&](std::uint32_t other) {
      if (!blocker || other < *blocker) blocker = other;
    });
    if (!blocker) return true;
    if (is_fixed_[*blocker]) return false;
    if (!Push(formation, *blocker, row, best) && !Push(formation, *blocker, row, good)) return false;
  }
  return false;
}

bool TrafficSearch::MakeRoom(Formation& formation, std::uint32_t row, std::uint32_t lane) const {
  Marks near(graph_.vertices(), false);
  for (const std::uint32_t vertex : graph_.VerticesNearLane(lane)) near[vertex] = true;
  return Push(formation, row, Formation::kNone, near);
}

// Whether a robot may be pushed along a lane, beside the robot that is pinned and those that stay; all others can be
// pushed, too.
bool TrafficSearch::MayPass(const Formation& formation, std::uint32_t pinned, std::uint32_t moving,
                            const TrafficExit& exit) const {
  if (closed_[exit.lane]) return false;
  bool may = true;
  formation.ForEachBlocker(moving, exit.lane, exit.to, [&](std::uint32_t other) {
    if (other == pinned || is_fixed_[other]) may = false;
  });
  return may;
}

// To the nearest vertex that is not avoided; robots on the way there move on, each to the place of the next one.
bool TrafficSearch::Push(Formation& formation, std::uint32_t pushed, std::uint32_t pinned, const Marks& avoided) const {
  struct Reached {
    bool is = false;
    std::uint32_t from = Formation::kNone;
    TrafficExit by = {};
  };
  const std::uint32_t start = formation.place(pushed);
  std::vector<Reached> reached(graph_.vertices());
  std::vector<std::uint32_t> order = {start};
  std::vector<std::uint32_t> shut;  // vertices with a lift or a group, which are the last choice
  reached[start].is = true;
  std::size_t tries = 0;
  const auto try_target = [&](std::uint32_t vertex) {
    std::vector<TrafficExit> way;
    for (std::uint32_t at = vertex; at != start; at = reached[at].from) way.push_back(reached[at].by);
    std::reverse(way.begin(), way.end());
    ++tries;
    return MoveChain(formation, way, start);
  };
  for (std::size_t i = 0; i < order.size() && tries < kMaxTargets; ++i) {
    const std::uint32_t vertex = order[i];
    ++visits_;
    if (i > 0 && formation.occupant(vertex) == Formation::kNone && !avoided[vertex]) {
      if (!graph_.IsOpen(vertex)) {
        shut.push_back(vertex);
      } else if (try_target(vertex)) {
        return true;
      }
    }
    const std::uint32_t there = formation.occupant(vertex);
    for (const TrafficExit& exit : graph_.exits(vertex)) {
      if (reached[exit.to].is) continue;
      // The robot that will move along the lane is the one there, or the pushed one.
      if (there != Formation::kNone && !MayPass(formation, pinned, there, exit)) continue;
      if (there == Formation::kNone) {
        bool is_free = !closed_[exit.lane];
        formation.ForEachNear(exit.lane, [&](std::uint32_t other) {
          is_free = is_free && (other == pushed || (other != pinned && !is_fixed_[other]));
        });
        if (!is_free) continue;
      }
      reached[exit.to] = {true, vertex, exit};
      order.push_back(exit.to);
    }
  }
  for (const std::uint32_t vertex : shut) {
    if (tries < 2 * kMaxTargets && try_target(vertex)) return true;
  }
  return false;
}

// The robots on a way move on along it, from the last one: that to the end, each other to the place of the next.
bool TrafficSearch::MoveChain(Formation& formation, const std::vector<TrafficExit>& way, std::uint32_t first) const {
  const std::size_t begun = formation.moves().size();
  std::size_t end = way.size();
  for (std::size_t i = way.size(); i-- > 0;) {
    const std::uint32_t from = i == 0 ? first : way[i - 1].to;
    const std::uint32_t robot = formation.occupant(from);
    if (robot == Formation::kNone) continue;
    for (std::size_t k = i; k < end; ++k) {
      if (!formation.CanMove(robot, way[k].lane, way[k].to)) {
        formation.UndoTo(begun);
        return false;
      }
      formation.Move(robot, way[k].lane, way[k].to);
    }
    end = i;
  }
  return true;
}

// The part of the graph that each vertex is in once these are taken away, from 0 on in the order of vertices;
// Formation::kNone for these. Lanes connect in both directions here.
std::vector<std::uint32_t> TrafficSearch::PartsWithout(std::uint32_t one, std::optional<std::uint32_t> two) const {
  visits_ += graph_.vertices();
  std::vector<std::uint32_t> roots(graph_.vertices());
  for (std::uint32_t i = 0; i < roots.size(); ++i) roots[i] = i;
  const auto find = [&](std::uint32_t vertex) {
    while (roots[vertex] != vertex) vertex = roots[vertex] = roots[roots[vertex]];
    return vertex;
  };
  const auto is_away = [&](std::uint32_t vertex) { return vertex == one || vertex == two; };
  for (std::uint32_t vertex = 0; vertex < roots.size(); ++vertex) {
    if (is_away(vertex)) continue;
    for (const TrafficExit& exit : graph_.exits(vertex)) {
      if (closed_[exit.lane] || is_away(exit.to)) continue;
      const std::uint32_t a = find(vertex);
      const std::uint32_t b = find(exit.to);
      roots[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<std::uint32_t> parts(roots.size(), Formation::kNone);
  std::uint32_t count = 0;
  for (std::uint32_t vertex = 0; vertex < roots.size(); ++vertex) {
    if (is_away(vertex)) continue;
    const std::uint32_t root = find(vertex);
    parts[vertex] = root == vertex ? count++ : parts[root];
  }
  return parts;
}

// The vertex of a robot, and the number of free vertices of each part without it.
std::vector<std::uint32_t> TrafficSearch::KeyOf(const Formation& formation, std::uint32_t row) const {
  std::vector<std::uint32_t> key = {formation.place(row)};
  const std::vector<std::uint32_t> parts = PartsWithout(formation.place(row), {});
  for (std::uint32_t vertex = 0; vertex < parts.size(); ++vertex) {
    if (parts[vertex] == Formation::kNone) continue;
    if (parts[vertex] + 2 > key.size()) key.resize(parts[vertex] + 2, 0);
    if (formation.occupant(vertex) == Formation::kNone) ++key[parts[vertex] + 1];
  }
  return key;
}

bool TrafficSearch::FindAnyWay(Formation& formation, std::uint32_t row, std::uint32_t goal,
                               std::size_t max_visits) const {
  struct State {
    std::vector<std::uint32_t> places;
    std::uint32_t parent = Formation::kNone;
    std::vector<RowMove> moves;  // from the parent
    double seconds = 0.0;
  };
  const std::vector<float>& seconds_to = routes_.To(goal);
  if (std::isinf(seconds_to[formation.place(row)])) return false;
  std::vector<State> states = {{formation.places(), Formation::kNone, {}, 0.0}};
  std::set<std::vector<std::uint32_t>> seen;
  Queue open;
  const auto is_nearer = [&](std::uint32_t vertex) {
    return vertex == goal || (graph_.IsOpen(vertex) && seconds_to[vertex] < seconds_to[formation.place(row)]);
  };
  open.push({seconds_to[formation.place(row)], 0});
  seen.insert(KeyOf(formation, row));
  std::optional<std::uint32_t> found;
  visits_ = 0;
  while (!open.empty() && !found && states.size() < kMaxStates && visits_ < max_visits) {
    const std::uint32_t number = open.top().second;
    open.pop();
    const State state = states[number];
    const std::uint32_t at = state.places[row];
    const auto add = [&](Formation& there, const TrafficExit& exit) {
      const std::size_t begun = there.moves().size();
      const Marks marks = Near(std::span(&exit, 1));
      if (!Clear(there, row, exit.lane, exit.to, marks, marks)) return there.UndoTo(begun);
      there.Move(row, exit.lane, exit.to);
      if (!found && seen.insert(KeyOf(there, row)).second) {
        const double seconds = state.seconds + exit.seconds + static_cast<double>(there.moves().size()) - 1.0;
        if (is_nearer(exit.to)) found = static_cast<std::uint32_t>(states.size());
        open.push({seconds + seconds_to[exit.to], static_cast<std::uint32_t>(states.size())});
        states.push_back({there.places(), number, there.moves(), seconds});
      }
      there.UndoTo(begun);
    };
    for (const TrafficExit& exit : graph_.exits(at)) {
      if (closed_[exit.lane] || found || std::isinf(seconds_to[exit.to])) continue;
      Formation there(graph_, state.places);
      add(there, exit);
      // Free vertices move across the next vertex into each of the parts behind it, one after another.
      const std::vector<std::uint32_t> parts = PartsWithout(at, exit.to);
      std::set<std::uint32_t> behind;
      for (const TrafficExit& next : graph_.exits(exit.to)) {
        if (parts[next.to] != Formation::kNone) behind.insert(parts[next.to]);
      }
      for (const std::uint32_t part : behind) {
        there.UndoTo(0);
        Marks avoided = Near(std::span(&exit, 1));
        for (std::uint32_t vertex = 0; vertex < parts.size(); ++vertex) {
          if (parts[vertex] == part) avoided[vertex] = true;
        }
        for (std::size_t i = 0; i < kMaxTransfers && !found && visits_ < max_visits; ++i) {
          // A robot of the part that can leave it: the one nearest to the next vertex is enough, as chains move.
          bool has_moved = false;
          for (std::uint32_t vertex = 0; vertex < parts.size() && !has_moved; ++vertex) {
            const std::uint32_t other = parts[vertex] == part ? there.occupant(vertex) : Formation::kNone;
            if (other == Formation::kNone || is_fixed_[other]) continue;
            has_moved = Push(there, other, row, avoided);
          }
          if (!has_moved) break;
          add(there, exit);
        }
      }
    }
  }
  if (!found) return false;
  std::vector<const State*> path;
  for (std::uint32_t number = *found; number != 0; number = states[number].parent) path.push_back(&states[number]);
  std::reverse(path.begin(), path.end());
  for (const State* state : path) {
    for (const RowMove& move : state->moves) formation.Move(move.row, move.lane, move.to);
  }
  return true;
}

}  // namespace troupe
