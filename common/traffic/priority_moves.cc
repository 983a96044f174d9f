#include "common/traffic/priority_moves.h"

#include <algorithm>
#include <tuple>

namespace troupe {

bool PriorityMoves::Advance(std::uint32_t row, std::uint32_t goal, std::size_t most) {
  const std::size_t begun = formation_.moves().size();
  blocker_.reset();
  std::size_t open = begun;  // moves, with which the robot is at a vertex at which it may wait
  for (std::size_t own = 0; own < most || open != formation_.moves().size(); ++own) {
    if (formation_.place(row) == goal) break;
    ++call_;
    if (!Choose(row, robots_[row].rank)) break;
    if (graph_.IsOpen(formation_.place(row)) || formation_.place(row) == goal) open = formation_.moves().size();
  }
  UndoTo(open);
  return open != begun;
}

bool PriorityMoves::MakeRoom(std::uint32_t row, std::uint32_t lane) {
  ++call_;
  ways_.push_back(lane);
  const bool has_moved = Choose(row, 0);
  ways_.pop_back();
  return has_moved;
}

// One lane: nearer to its goal if it chooses for itself, else out of the way of those that ask.
bool PriorityMoves::Choose(std::uint32_t row, std::size_t rank) {
  struct Candidate {
    bool is_shut = false;  // a vertex at which it may not wait
    float seconds = 0.0F;
    bool is_taken = false;
    const TrafficExit* exit = nullptr;
    bool operator<(const Candidate& other) const {
      return std::tie(is_shut, seconds, is_taken) < std::tie(other.is_shut, other.seconds, other.is_taken);
    }
  };
  const std::uint32_t place = formation_.place(row);
  const bool is_asked_for_room = !ways_.empty();
  const std::vector<float>* seconds = robots_[row].seconds_to_goal;
  std::vector<Candidate> candidates;
  for (const TrafficExit& exit : graph_.exits(place)) {
    if (closed_[exit.lane]) continue;
    if (!is_asked_for_room && (*seconds)[exit.to] >= (*seconds)[place]) continue;
    if (IsInTheWay(exit.to)) continue;
    candidates.push_back({.is_shut = is_asked_for_room && !graph_.IsOpen(exit.to),
                          .seconds = static_cast<float>(exit.seconds) + (seconds ? (*seconds)[exit.to] : 0.0F),
                          .is_taken = formation_.occupant(exit.to) != Formation::kNone,
                          .exit = &exit});
  }
  std::stable_sort(candidates.begin(), candidates.end());
  states_[row].is_asked = true;
  const std::size_t begun = formation_.moves().size();
  for (const Candidate& candidate : candidates) {
    if (Clear(row, *candidate.exit, rank)) {
      states_[row].is_asked = false;
      formation_.Move(row, candidate.exit->lane, candidate.exit->to);
      ++states_[row].moves;
      return true;
    }
    UndoTo(begun);
  }
  states_[row].is_asked = false;
  states_[row].failed_in = call_;
  return false;
}

bool PriorityMoves::Clear(std::uint32_t row, const TrafficExit& exit, std::size_t rank) {
  for (;;) {
    std::optional<std::uint32_t> blocker;
    formation_.ForEachBlocker(row, exit.lane, exit.to, [&](std::uint32_t other) {
      if (!blocker || other < *blocker) blocker = other;
    });
    if (!blocker) return true;
    if (!blocker_) blocker_ = blocker;
    const State& state = states_[*blocker];
    // A robot that has moved has moved out of the way, or is in it for another reason.
    if (!robots_[*blocker].can_move || state.is_asked || state.moves > 0 || state.failed_in == call_ ||
        robots_[*blocker].rank < rank) {
      return false;
    }
    ways_.push_back(exit.lane);
    const bool has_moved = Choose(*blocker, rank);
    ways_.pop_back();
    if (!has_moved) return false;
  }
}

// Of a robot that has been asked for room.
bool PriorityMoves::IsInTheWay(std::uint32_t vertex) const {
  return std::any_of(ways_.begin(), ways_.end(), [&](std::uint32_t lane) {
    const auto near = graph_.VerticesNearLane(lane);
    return std::binary_search(near.begin(), near.end(), vertex);
  });
}

void PriorityMoves::UndoTo(std::size_t count) {
  for (std::size_t i = count; i < formation_.moves().size(); ++i) --states_[formation_.moves()[i].row].moves;
  formation_.UndoTo(count);
}

}  // namespace troupe
