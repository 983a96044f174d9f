#include "python/native/cubes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "troupe/deterministic_math.h"

namespace troupe::python {
namespace {

constexpr double kCubeSide = 0.2;          // m
constexpr double kPlaceTolerance = 0.15;   // m
constexpr double kHeightTolerance = 0.05;  // m
constexpr double kFar = 1000.0;            // m: of a cube or robot that does not exist

// The number from 0 to `count` - 1 with the least distance; nothing if none counts.
template <typename DistanceOf>
std::optional<std::size_t> Nearest(std::size_t count, const DistanceOf& distance_of) {
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<double> distance = distance_of(i);
    if (!distance || !(*distance < least)) continue;
    least = *distance;
    nearest = i;
  }
  return nearest;
}

}  // namespace

CubeJobs::CubeJobs(std::size_t robots, std::size_t cubes)
    : jobs_(robots), carried_(robots), place_of_(cubes), was_gripped_(cubes, false) {}

void CubeJobs::Begin() {
  std::fill(carried_.begin(), carried_.end(), std::nullopt);
  std::fill(place_of_.begin(), place_of_.end(), std::nullopt);
  was_gripped_.assign(was_gripped_.size(), false);
}

const std::vector<CubeJob>& CubeJobs::Update(const WorldState& state,
                                             const std::vector<std::optional<std::size_t>>& held,
                                             const std::vector<CubePlace>& places) {
  Score(state, held, places);
  Guide(state, places);
  return jobs_;
}

void CubeJobs::Score(const WorldState& state, const std::vector<std::optional<std::size_t>>& held,
                     const std::vector<CubePlace>& places) {
  for (std::size_t robot = 0; robot < jobs_.size(); ++robot) {
    CubeJob& job = jobs_[robot];
    job = {};
    if (held[robot] && !was_gripped_[*held[robot]]) {
      was_gripped_[*held[robot]] = true;
      job.gripped = true;
    }
    if (held[robot] || !carried_[robot] || place_of_[*carried_[robot]]) continue;
    const Pose& cube = state.objects[*carried_[robot]].X_WO;
    const auto is_taken = [&](std::size_t place) {
      return std::find(place_of_.begin(), place_of_.end(), std::optional(place)) != place_of_.end();
    };
    const std::optional<std::size_t> place = Nearest(places.size(), [&](std::size_t i) -> std::optional<double> {
      if (is_taken(i) || std::abs(places[i].level * kCubeSide - cube.z) > kHeightTolerance) return std::nullopt;
      return (places[i].at - cube.translation()).norm();
    });
    if (!place || (places[*place].at - cube.translation()).norm() >= kPlaceTolerance) continue;
    place_of_[*carried_[robot]] = place;
    job.placed = true;
  }
  carried_ = held;
}

CubePlace CubeJobs::PlaceFor(std::size_t robot, const std::vector<CubePlace>& places) const {
  // Carriers have different places, in the order of their numbers.
  std::size_t before = 0;
  for (std::size_t other = 0; other < robot; ++other) before += carried_[other].has_value();
  CubePlace last;
  for (std::size_t place = 0; place < places.size(); ++place) {
    if (std::find(place_of_.begin(), place_of_.end(), std::optional(place)) != place_of_.end()) continue;
    last = places[place];
    if (before-- == 0) break;
  }
  return last;
}

void CubeJobs::Guide(const WorldState& state, const std::vector<CubePlace>& places) {
  const std::size_t cubes = place_of_.size();
  const auto way_to = [&](std::size_t robot, std::size_t cube) -> Vec2 {
    return state.objects[cube].X_WO.translation() - state.robots[robot].X_WR.translation();
  };
  std::vector<bool> is_left(cubes);
  std::size_t left = 0;
  for (std::size_t cube = 0; cube < cubes; ++cube) {
    is_left[cube] =
        !place_of_[cube] && std::find(carried_.begin(), carried_.end(), std::optional(cube)) == carried_.end();
    left += is_left[cube];
  }
  const bool none_is_left = left == 0;
  for (std::size_t robot = 0; robot < jobs_.size(); ++robot) {
    CubeJob& job = jobs_[robot];
    const Pose& X_WR = state.robots[robot].X_WR;
    std::optional<std::size_t> chosen = carried_[robot];
    job.way = X_WR.heading;
    if (carried_[robot]) {
      const CubePlace place = PlaceFor(robot, places);
      job.goal = place.at - X_WR.translation();
      job.goal_level = place.level;
      job.way = 0.0;  // places are approached towards the east
    } else if (!none_is_left) {
      chosen = Nearest(cubes, [&](std::size_t cube) -> std::optional<double> {
        if (!is_left[cube]) return std::nullopt;
        return way_to(robot, cube).norm();
      });
      job.goal = way_to(robot, *chosen);
      job.way = Atan2(job.goal.y(), job.goal.x());
      // It is for this robot, if there are others for those that follow.
      if (left > 1) {
        is_left[*chosen] = false;
        --left;
      }
    } else {
      job.idle = true;
    }
    const std::optional<std::size_t> cube = Nearest(cubes, [&](std::size_t i) -> std::optional<double> {
      if (i == chosen) return std::nullopt;
      return way_to(robot, i).norm();
    });
    job.cube = cube ? way_to(robot, *cube) : Vec2(kFar, 0.0);
    const std::optional<std::size_t> peer = Nearest(jobs_.size(), [&](std::size_t i) -> std::optional<double> {
      if (i == robot) return std::nullopt;
      return (state.robots[i].X_WR.translation() - X_WR.translation()).norm();
    });
    job.peer = peer ? Vec2(state.robots[*peer].X_WR.translation() - X_WR.translation()) : Vec2(kFar, 0.0);
  }
}

}  // namespace troupe::python
