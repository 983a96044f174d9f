// The people of an experiment (people_experiments.h) as agents of the library RVO2 (github.com/snape/RVO2), with the
// same places, radii, speeds, goals and walls, and the parameters of its examples for people. RVO2 has no ways around
// walls: an agent in a room looks at the nearest place in the opening. Compiled with people_flow.cc only where
// TROUPE_PEER_RVO2 is defined.
#pragma once

#include <RVO.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "benchmarks/people_experiments.h"
#include "troupe/world_description.h"

namespace troupe::bench {

class Rvo2Run {
 public:
  explicit Rvo2Run(const WorldDescription& world) : world_(world) {
    simulator_.setTimeStep(0.1F);
    simulator_.setAgentDefaults(5.0F, 12, 1.5F, 0.5F, static_cast<float>(kBodyRadius), 1.8F);
    for (const PersonDescription& person : world.people) {
      const std::size_t i = simulator_.addAgent(Of(world.model(person.root).X_PM.translation()));
      simulator_.setAgentMaxSpeed(i, static_cast<float>(person.max_speed));
      goals_.push_back(person.goals);
    }
    for (const Block& block : world.shapes[0].blocks) {
      std::vector<RVO::Vector2> outline;
      for (const Vec2& vertex : block.outline) outline.push_back(Of(vertex));
      simulator_.addObstacle(outline);
    }
    simulator_.processObstacles();
  }

  std::size_t size() const { return goals_.size(); }
  double seconds() const { return 0.1; }
  Vec2 At(std::size_t i) const { return {simulator_.getAgentPosition(i).x(), simulator_.getAgentPosition(i).y()}; }
  Vec2 VelocityOf(std::size_t i) const {
    return {simulator_.getAgentVelocity(i).x(), simulator_.getAgentVelocity(i).y()};
  }
  void StepOnly() {
    for (std::size_t i = 0; i < size(); ++i) {
      Follow(i);
      Vec2 way = Aim(i) - At(i);
      // A trace of noise, as its examples have it, against encounters that are exactly symmetric.
      way += 0.001 * Vec2(RandomUniform({7, i, tick_}) - 0.5, RandomUniform({8, i, tick_}) - 0.5);
      const double length = std::max(way.norm(), 1e-9);
      const double speed = std::min(world_.people[i].speed, 2.0 * length);
      simulator_.setAgentPrefVelocity(i, Of(way * (speed / length)));
    }
    ++tick_;
    simulator_.doStep();
  }
  void Measure() {
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) least_square_ = std::min(least_square_, (At(i) - At(k)).squaredNorm());
    }
  }
  double least_gap() const { return std::sqrt(least_square_) - 2.0 * kBodyRadius; }

 private:
  static RVO::Vector2 Of(const Vec2& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y())}; }

  const GoalSet& SetOf(std::size_t i) const { return world_.goal_sets[goals_[i]]; }
  void Follow(std::size_t i) {
    const GoalSet& set = SetOf(i);
    if (!set.next.empty() && (set.points.front() - At(i)).norm() <= set.reach) goals_[i] = set.next.front().goals;
  }
  Vec2 Aim(std::size_t i) const {
    const Vec2 goal = SetOf(i).points.front();
    // Of the room, whose last two walls are beside the opening, at x from 0 to 0.3.
    const std::vector<Block>& walls = world_.shapes[0].blocks;
    if (walls.size() != 5 || At(i).x() > 0.3) return goal;
    const double half = walls[4].outline.front().y() - kBodyRadius;
    return {0.4, std::clamp(At(i).y(), -half, half)};
  }

  const WorldDescription& world_;
  std::vector<std::uint32_t> goals_;
  RVO::RVOSimulator simulator_;
  std::uint64_t tick_ = 0;
  double least_square_ = std::numeric_limits<double>::infinity();
};

}  // namespace troupe::bench
