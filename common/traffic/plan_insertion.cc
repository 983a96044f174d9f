#include "common/traffic/plan_insertion.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

namespace troupe {
namespace {

constexpr std::uint32_t kNoState = 0xffffffff;

// At rest at a vertex, in the search.
struct State {
  std::uint32_t vertex = 0;
  MoveSequence::Position position = 0;
  MoveSequence::Range rest = {};
  double seconds = 0.0;  // at rest there from then on
  double delays = 0.0;   // s, of others
  double moving = 0.0;   // s, on the way there
  std::uint32_t parent = kNoState;
  std::uint32_t lane = 0;  // of the move that leads there
};

// Calls visit(position, rest, finish, delay) for the moves along an exit: for each range of positions at the end of the
// lane the first one possible, and the best one after moves that would lose time by it. `delay` with its weight.
template <typename Visit>
void ForEachNext(const MoveSequence& sequence, const State& state, const TrafficExit& exit, double delay_weight,
                 std::vector<MoveSequence::Range>& scratch, const Visit& visit) {
  const auto move_at = [&](MoveSequence::Position position) {
    const MoveSequence::Times times = sequence.TimesNear(exit.lane, position);
    const double finish = std::max({state.seconds, times.latest_finish, sequence.busy(exit.lane)}) + exit.seconds;
    return std::pair(finish, delay_weight * std::max(0.0, finish - times.earliest_start));
  };
  sequence.FindFree(exit.lane, exit.to, {state.position, state.rest.end}, scratch);
  for (const MoveSequence::Range& free : scratch) {
    for (MoveSequence::Position from = free.begin; from <= free.end;) {
      const MoveSequence::Range rest = sequence.RestAt(exit.to, from);
      const MoveSequence::Position to = std::min(free.end, rest.end);
      auto [finish, delay] = move_at(from);
      visit(from, rest, finish, delay);
      MoveSequence::Position best = from;
      for (MoveSequence::Position next = from; delay > 0.0; ++next) {
        next = sequence.NextNear(exit.lane, next);
        if (next >= to) break;
        const auto [later, less] = move_at(next + 1);
        if (later + less >= finish + delay) continue;
        finish = later;
        delay = less;
        best = next + 1;
      }
      if (best != from) visit(best, rest, finish, delay);
      if (rest.end == MoveSequence::kEnd) break;
      from = rest.end + 1;
    }
  }
}

}  // namespace

PlanInsertion::PlanInsertion(const TrafficGraph& graph, const std::vector<bool>& closed)
    : graph_(graph), closed_(closed), done_(graph.vertices()) {}

bool PlanInsertion::IsDone(std::uint32_t vertex, Position begin, Position position) const {
  const auto& rests = done_[vertex];
  return std::any_of(rests.begin(), rests.end(),
                     [&](const auto& rest) { return rest.first == begin && rest.second <= position; });
}

// False: it has been left at that position or before.
bool PlanInsertion::SetDone(std::uint32_t vertex, Position begin, Position position) {
  auto& rests = done_[vertex];
  const auto found = std::find_if(rests.begin(), rests.end(), [&](const auto& rest) { return rest.first == begin; });
  if (found != rests.end()) {
    if (found->second <= position) return false;
    found->second = position;
    return true;
  }
  if (rests.empty()) reached_.push_back(vertex);
  rests.emplace_back(begin, position);
  return true;
}

// Whether a way from a vertex to a goal is left once all others are at their ends.
bool PlanInsertion::IsOpenAtEnd(const MoveSequence& sequence, std::uint32_t from, std::uint32_t goal) const {
  std::vector<bool> is_reached(graph_.vertices(), false);
  std::vector<std::uint32_t> reached = {goal};
  is_reached[goal] = true;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i] == from) return true;
    for (const TrafficExit& entry : graph_.entries(reached[i])) {
      if (is_reached[entry.to] || closed_[entry.lane] || sequence.IsTakenAtEnd(entry.to)) continue;
      is_reached[entry.to] = true;
      reached.push_back(entry.to);
    }
  }
  return false;
}

std::optional<std::vector<MoveSequence::Step>> PlanInsertion::Find(const MoveSequence& sequence, std::uint32_t row,
                                                                   std::uint32_t goal,
                                                                   const std::vector<float>& seconds_to_goal,
                                                                   double delay_weight) {
  if (!sequence.IsFreeAtEnd(goal)) return std::nullopt;
  for (const std::uint32_t vertex : reached_) done_[vertex].clear();
  reached_.clear();
  std::vector<State> states;
  std::vector<MoveSequence::Range> scratch;
  // Of equal costs the shortest way is first: a robot that has to wait would else drive to and fro, and keep others
  // from moves before it for ever. Of equally long ones, as on a grid, it is the one that is nearest to the goal.
  using Entry = std::tuple<double, double, double, Position, std::uint32_t>;  // cost, s on the way and to the goal, ...
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  // It stays only after the last move that needs its goal.
  const double least = sequence.LastFinishNear(goal);
  const std::size_t begun = visits_;
  const std::size_t most = IsOpenAtEnd(sequence, sequence.place(row), goal) ? kMaxVisits : kMaxVisitsOfShut;
  const auto add = [&](const State& state) {
    const auto left = static_cast<double>(seconds_to_goal[state.vertex]);
    if (left == MoveSequence::kNever || IsDone(state.vertex, state.rest.begin, state.position)) return;
    const double weight = visits_ - begun < kExactVisits ? 1.0 : kHaste;
    open.push({state.delays + std::max(state.seconds + weight * left, least), state.moving + weight * left, left,
               state.position, static_cast<std::uint32_t>(states.size())});
    states.push_back(state);
  };
  const std::uint32_t place = sequence.place(row);
  add({.vertex = place, .rest = sequence.RestAt(place, 0), .seconds = sequence.ready(row)});
  while (!open.empty() && visits_ - begun < most) {
    const std::uint32_t number = std::get<4>(open.top());
    open.pop();
    const State state = states[number];
    if (!SetDone(state.vertex, state.rest.begin, state.position)) continue;
    ++visits_;
    if (state.rest.end == MoveSequence::kEnd && state.vertex == goal) {
      std::vector<MoveSequence::Step> steps;
      for (std::uint32_t at = number; states[at].parent != kNoState; at = states[at].parent) {
        steps.push_back({states[at].position, states[at].lane, states[at].vertex});
      }
      std::reverse(steps.begin(), steps.end());
      return steps;
    }
    for (const TrafficExit& exit : graph_.exits(state.vertex)) {
      if (closed_[exit.lane]) continue;
      ForEachNext(sequence, state, exit, delay_weight, scratch,
                  [&](Position position, const MoveSequence::Range& rest, double finish, double delay) {
                    add({exit.to, position, rest, finish, state.delays + delay, state.moving + exit.seconds, number,
                         exit.lane});
                  });
    }
  }
  return std::nullopt;
}

}  // namespace troupe
