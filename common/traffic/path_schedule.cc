#include "common/traffic/path_schedule.h"

#include <algorithm>
#include <tuple>

namespace troupe {
namespace {

// A stay of a trip at a vertex: from its step until the step at which it is at its next vertex.
struct Visit {
  std::uint32_t vertex = 0;
  std::uint32_t step = 0;
  std::uint32_t trip = 0;
  std::uint32_t place = 0;  // in the path
};

// By vertex, then by step.
std::vector<Visit> VisitsOf(std::span<const LaneTrip> trips) {
  std::vector<Visit> visits;
  for (std::uint32_t trip = 0; trip < trips.size(); ++trip) {
    const LaneTrip& each = trips[trip];
    for (std::uint32_t place = 0; place < each.path.size(); ++place) {
      visits.push_back({each.path[place], each.steps[place], trip, place});
    }
  }
  std::sort(visits.begin(), visits.end(), [](const Visit& a, const Visit& b) {
    return std::tie(a.vertex, a.step, a.trip) < std::tie(b.vertex, b.step, b.trip);
  });
  return visits;
}

}  // namespace

std::optional<PathConflict> FindConflict(std::span<const LaneTrip> trips) {
  const std::vector<Visit> visits = VisitsOf(trips);
  std::optional<PathConflict> found;
  const auto add = [&](const Visit& first, const Visit& second, bool is_swap) {
    if (found && found->step <= second.step) return;
    found = {first.trip, second.trip, second.place, second.step, is_swap};
  };
  for (std::size_t i = 1; i < visits.size(); ++i) {
    const Visit& before = visits[i - 1];
    const Visit& after = visits[i];
    if (before.vertex != after.vertex || before.trip == after.trip) continue;
    const LaneTrip& first = trips[before.trip];
    // It stays at its last vertex for ever.
    const bool stays = before.place + 1 == first.path.size() || first.steps[before.place + 1] > after.step;
    if (stays) {
      add(before, after, false);
      continue;
    }
    if (after.place == 0 || first.steps[before.place + 1] != after.step) continue;
    // It leaves in the step in which the other one comes: not to where that one comes from.
    if (first.path[before.place + 1] == trips[after.trip].path[after.place - 1]) add(before, after, true);
  }
  return found;
}

PathSchedule::PathSchedule(std::span<const LaneTrip> trips) {
  for (std::uint32_t trip = 0; trip < trips.size(); ++trip) {
    const LaneTrip& each = trips[trip];
    first_.push_back(needs_.size());
    if (each.path.empty()) continue;
    const std::size_t robot = each.robot.index();
    if (robot >= trip_of_.size()) trip_of_.resize(robot + 1, kNone);
    trip_of_[robot] = trip;
    needs_.resize(needs_.size() + each.path.size() - 1);
  }
  first_.push_back(needs_.size());
  const std::vector<Visit> visits = VisitsOf(trips);
  for (std::size_t i = 1; i < visits.size(); ++i) {
    const Visit& before = visits[i - 1];
    const Visit& after = visits[i];
    if (before.vertex != after.vertex || before.trip == after.trip || after.place == 0) continue;
    // The move by which the other one leaves.
    needs_[first_[after.trip] + after.place - 1] = {before.trip, before.place + 1, kNone};
  }
  FindCircles(trips);
}

// Moves that need each other: of one step, each to the start of the next one.
void PathSchedule::FindCircles(std::span<const LaneTrip> trips) {
  for (std::uint32_t trip = 0; trip < trips.size(); ++trip) {
    for (std::uint32_t move = 0; move < MovesOf(trip); ++move) {
      const std::uint32_t step = trips[trip].steps[move + 1];
      CircleMove at{trip, move};
      std::vector<CircleMove> chain;
      // A circle is found at its least trip, so that each is found once.
      do {
        chain.push_back(at);
        const Need& need = NeedOf(at.trip, at.move);
        if (need.trip == kNone || need.trip < trip || need.moves > MovesOf(need.trip)) break;
        at = {need.trip, need.moves - 1};
      } while (at.trip != trip && trips[at.trip].steps[at.move + 1] == step && chain.size() <= trips.size());
      const bool is_circle = chain.size() > 1 && at.trip == trip && at.move == move;
      if (!is_circle) continue;
      for (const CircleMove& each : chain) {
        needs_[first_[each.trip] + each.move].circle = static_cast<std::uint32_t>(circles_.size() - 1);
        circle_moves_.push_back(each);
      }
      circles_.push_back(circle_moves_.size());
    }
  }
}

}  // namespace troupe
