// The usual experiments with crowds: an opening, a corridor one way and both ways, streams that cross, a circle. Each
// is a world of people alone, with its measurements. Used by people_flow.cc, and by tests with the published
// bands.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/deterministic_math.h"
#include "troupe/polygon.h"
#include "troupe/random.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"
#include "world-service/core/step.h"

namespace troupe::bench {

inline constexpr double kBodyRadius = 0.25;  // m, as of a rule for people without another one

class CrowdWorld {
 public:
  explicit CrowdWorld(std::uint64_t seed) {
    world.name = "experiment";
    world.seed = seed;
    world.shapes.resize(2);
    world.shapes[1].blocks.push_back({RegularPolygon(12, kBodyRadius), {0.0, 1.75}});
    ModelDescription walls;
    walls.name = "walls";
    walls.shape = ShapeId(0);
    world.models.push_back(walls);
  }

  void AddWall(double min_x, double min_y, double max_x, double max_y) {
    AddWall({{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}});
  }
  void AddWall(Polygon outline) { world.shapes[0].blocks.push_back({std::move(outline), {0.0, 2.5}}); }

  std::uint32_t AddGoals(std::vector<Vec2> points, double reach = 0.5) {
    GoalSet& set = world.goal_sets.emplace_back();
    set.name = "goals" + std::to_string(world.goal_sets.size());
    set.points = std::move(points);
    set.reach = reach;
    return static_cast<std::uint32_t>(world.goal_sets.size() - 1);
  }

  // At 1.34 m/s on average, with the deviation of Weidmann (0.26 m/s).
  void AddPerson(const Vec2& at, std::uint32_t goals) {
    constexpr double kMean = 1.34;
    constexpr double kHalfWidth = 0.45;  // of a uniform distribution with that deviation
    const std::size_t i = world.people.size();
    ModelDescription model;
    model.name = "person" + std::to_string(i);
    model.type = "person";
    model.shape = ShapeId(1);
    model.X_PM = {at.x(), at.y(), 0.0, 0.0};
    PersonDescription person;
    person.root = ModelId(world.models.size());
    person.radius = kBodyRadius;
    person.speed = kMean + kHalfWidth * (2.0 * RandomUniform({world.seed, 1, i}) - 1.0);
    person.max_speed = 1.4 * person.speed;
    person.goals = goals;
    world.models.push_back(model);
    world.people.push_back(person);
  }

  // A place in a box at least a body from all people so far; nothing if none was found.
  template <typename Accept>
  std::optional<Vec2> FindPlace(const Rectangle& box, double gap, Accept accept) {
    for (int i = 0; i < 5000; ++i) {
      const std::uint64_t draw = draws_++;
      const Vec2 at(box.min_x + box.width() * RandomUniform({world.seed, 2, draw, 0}),
                    box.min_y + box.height() * RandomUniform({world.seed, 2, draw, 1}));
      const auto is_near = [&](const PersonDescription& other) {
        return (world.model(other.root).X_PM.translation() - at).norm() < 2.0 * kBodyRadius + gap;
      };
      if (accept(at) && std::none_of(world.people.begin(), world.people.end(), is_near)) return at;
    }
    return std::nullopt;
  }

  WorldDescription world;

 private:
  std::uint64_t draws_ = 0;
};

// Steps a world. The experiments take another class with its functions, too: of a peer.
class CrowdRun {
 public:
  explicit CrowdRun(const WorldDescription& world) : scene_(world), state(InitialState(scene_)), bodies_(scene_) {}

  void Step() {
    StepOnly();
    Measure();
  }
  void StepOnly() { state = troupe::Step(scene_, state, {}, bodies_).state; }
  void Measure() {
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) least_square_ = std::min(least_square_, (At(i) - At(k)).squaredNorm());
    }
  }
  // m, so far, between the bodies of two people; negative: they overlapped.
  double least_gap() const { return std::sqrt(least_square_) - 2.0 * kBodyRadius; }
  Vec2 At(std::size_t i) const { return state.people[i].X_WP.translation(); }
  Vec2 VelocityOf(std::size_t i) const { return {state.people[i].vx, state.people[i].vy}; }
  std::size_t size() const { return state.people.size(); }
  const Scene& scene() const { return scene_; }
  double seconds() const { return scene_.world().interval_seconds(); }

 private:
  const Scene scene_;

 public:
  WorldState state;

 private:
  BodyIndex bodies_;
  double least_square_ = std::numeric_limits<double>::infinity();
};

// People leave a room of 10 m x 10 m by an opening in the middle of a side, 0.3 m thick.
struct OpeningFlow {
  double flow = 0.0;     // persons per metre and second, from the tenth to the last tenth of them
  double seconds = 0.0;  // until nine of ten are out; 0: never
  double least_gap = 0.0;
};
template <typename Run = CrowdRun>
OpeningFlow MeasureOpening(double width, std::size_t people, std::uint64_t seed, double most_seconds = 300.0) {
  CrowdWorld crowd(seed);
  const double half = 0.5 * width;
  crowd.AddWall(-10.3, -5.3, 0.0, -5.0);
  crowd.AddWall(-10.3, 5.0, 0.0, 5.3);
  crowd.AddWall(-10.3, -5.3, -10.0, 5.3);
  crowd.AddWall(0.0, -5.3, 0.3, -half);
  crowd.AddWall(0.0, half, 0.3, 5.3);
  std::vector<std::uint32_t> goals;
  for (int i = 0; i < 5; ++i) goals.push_back(crowd.AddGoals({{14.0, 4.0 * (i - 2)}}));
  const Rectangle room{-9.6, -4.6, -0.6, 4.6};
  for (std::size_t i = 0; i < people; ++i) {
    const auto at = crowd.FindPlace(room, 0.05, [](const Vec2&) { return true; });
    if (!at) break;
    crowd.AddPerson(*at, goals[i % goals.size()]);
  }
  Run run(crowd.world);
  OpeningFlow result;
  const std::size_t first = people / 10;
  const std::size_t last = people * 9 / 10;
  double begin = 0.0;
  for (double t = 0.0; t < most_seconds;) {
    run.Step();
    t += run.seconds();
    std::size_t out = 0;
    for (std::size_t i = 0; i < run.size(); ++i) out += run.At(i).x() > 0.3 ? 1 : 0;
    if (begin == 0.0 && out >= first) begin = t;
    if (out >= last) {
      result.seconds = t;
      result.flow = static_cast<double>(last - first) / (t - begin) / width;
      break;
    }
  }
  result.least_gap = run.least_gap();
  return result;
}

// The speed (m/s) at a density (persons per square metre) in the measurements that Weidmann (1993) collected.
inline double WeidmannSpeed(double density) {
  return 1.34 * (1.0 - std::exp(-1.913 * (1.0 / density - 1.0 / 5.4)));
}

// One way in a straight corridor of 3 m x 60 m that is full at the start, measured in 12 m in its middle from the 4th
// to the 10th second.
struct CorridorFlow {
  double density = 0.0;  // persons per square metre
  double speed = 0.0;    // m/s, along the corridor
  double least_gap = 0.0;
};
inline CrowdWorld CorridorWorld(double density, std::uint64_t seed) {
  constexpr double kLength = 60.0;
  constexpr double kWidth = 3.0;
  constexpr double kRoom = kWidth - 2.0 * kBodyRadius - 0.04;  // for axes
  CrowdWorld crowd(seed);
  crowd.AddWall(-1.0, -0.5 * kWidth - 0.3, kLength + 60.0, -0.5 * kWidth);
  crowd.AddWall(-1.0, 0.5 * kWidth, kLength + 60.0, 0.5 * kWidth + 0.3);
  std::vector<std::uint32_t> goals;
  constexpr int kLanes = 5;
  for (int i = 0; i < kLanes; ++i)
    goals.push_back(crowd.AddGoals({{kLength + 58.0, kRoom * (i / (kLanes - 1.0) - 0.5)}}));
  const auto people = static_cast<std::size_t>(std::lround(density * kLength * kWidth));
  // In rows on a lattice: random places leave no room from 2 persons per square metre on.
  const int files = std::max(2, static_cast<int>(std::lround(kWidth * std::sqrt(density))));
  const int rows = (static_cast<int>(people) + files - 1) / files;
  for (std::size_t i = 0; i < people; ++i) {
    const int row = static_cast<int>(i) / files;
    const int file = static_cast<int>(i) % files;
    const double across = kRoom * (file / (files - 1.0) - 0.5);
    const auto lane = static_cast<std::size_t>(std::clamp((across / kRoom + 0.5) * kLanes, 0.0, kLanes - 1.0));
    crowd.AddPerson({kLength * (row + 0.5 * (file % 2)) / rows, across}, goals[lane]);
  }
  return crowd;
}
template <typename Run = CrowdRun>
CorridorFlow MeasureCorridor(double density, std::uint64_t seed) {
  const CrowdWorld crowd = CorridorWorld(density, seed);
  Run run(crowd.world);
  CorridorFlow result;
  std::size_t samples = 0;
  std::size_t ticks = 0;
  for (int tick = 0; tick * run.seconds() < 10.0; ++tick) {
    run.Step();
    if (tick * run.seconds() < 4.0) continue;
    ++ticks;
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (run.At(i).x() < 24.0 || run.At(i).x() > 36.0) continue;
      result.speed += run.VelocityOf(i).x();
      ++samples;
    }
  }
  result.speed /= static_cast<double>(std::max<std::size_t>(samples, 1));
  result.density = static_cast<double>(samples) / static_cast<double>(ticks) / (12.0 * 3.0);
  result.least_gap = run.least_gap();
  return result;
}

// A round corridor with a middle line of radius kRing m and `width` m. `backwards`: of each so many people, one walks
// the other way; 0: none.
inline constexpr double kRing = 6.0;
struct RingFlow {
  double density = 0.0;  // persons per square metre
  double speed = 0.0;    // m/s, mean along the corridor, in their direction
  double order = 0.0;    // 1: in all places people at one radius walk one way; 0: mixed
  double jammed = 0.0;   // share of the people at less than 0.05 m/s
  double least_gap = 0.0;
};
inline CrowdWorld RingWorld(double width, double density, int backwards, std::uint64_t seed) {
  CrowdWorld crowd(seed);
  constexpr int kSides = 48;
  const double inner = kRing - 0.5 * width;
  const double outer = kRing + 0.5 * width;
  const auto at = [](double radius, double turn) {
    const SinCosResult direction = SinCos(2.0 * kPi * turn);
    return Vec2(radius * direction.cos, radius * direction.sin);
  };
  for (int i = 0; i < kSides; ++i) {
    const double a = static_cast<double>(i) / kSides;
    const double b = static_cast<double>(i + 1) / kSides;
    const double thick = 0.3;
    crowd.AddWall({at(outer, a), at(outer + thick, a), at(outer + thick, b), at(outer, b)});
    crowd.AddWall({at(inner - thick, a), at(inner, a), at(inner, b), at(inner - thick, b)});
  }
  constexpr int kGates = 8;
  constexpr int kLanes = 3;
  const auto sets = static_cast<std::uint32_t>(kGates * kLanes);
  const double spread = 0.5 * width - kBodyRadius - 0.15;
  for (int direction = 0; direction < (backwards > 0 ? 2 : 1); ++direction) {
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int gate = 0; gate < kGates; ++gate) {
        crowd.AddGoals({at(kRing + spread * (lane - 1), static_cast<double>(gate) / kGates)}, 2.4);
        const int next = (gate + (direction == 0 ? 1 : kGates - 1)) % kGates;
        crowd.world.goal_sets.back().next = {
            {static_cast<std::uint32_t>(direction) * sets + static_cast<std::uint32_t>(lane * kGates + next), 1.0}};
      }
    }
  }
  const double area = kPi * (outer * outer - inner * inner);
  const auto people = static_cast<std::size_t>(std::lround(density * area));
  // Rows across the corridor, as dense as it needs, on a lattice: random places leave no room from 2 persons per
  // square metre on.
  const double pitch = std::sqrt(area / static_cast<double>(people));
  const int files = std::max(1, static_cast<int>((width - 2.0 * kBodyRadius - 0.04) / std::min(pitch, 1.2) + 1.0));
  const int rows = (static_cast<int>(people) + files - 1) / files;
  std::size_t placed = 0;
  for (int row = 0; row < rows; ++row) {
    for (int file = 0; file < files && placed < people; ++file, ++placed) {
      const double room = width - 2.0 * kBodyRadius - 0.04;
      const double across = files == 1 ? 0.0 : room * (static_cast<double>(file) / (files - 1) - 0.5);
      const double turn = (row + 0.5 * (file % 2)) / rows;
      const bool is_back = backwards > 0 && placed % static_cast<std::size_t>(backwards) == 0;
      int gate = static_cast<int>(turn * kGates) + (is_back ? 0 : 1);
      gate = (gate % kGates + kGates) % kGates;
      const int lane = static_cast<int>(RandomUniform({seed, 3, placed}) * kLanes);
      crowd.AddPerson(at(kRing + across, turn),
                      (is_back ? sets : 0) + static_cast<std::uint32_t>(lane * kGates + gate));
    }
  }
  return crowd;
}

template <typename Run = CrowdRun>
RingFlow MeasureRing(double width, double density, int backwards, std::uint64_t seed, double warm_up = 15.0,
                     double seconds = 20.0) {
  const CrowdWorld crowd = RingWorld(width, density, backwards, seed);
  Run run(crowd.world);
  RingFlow result;
  const double inner = kRing - 0.5 * width;
  const double outer = kRing + 0.5 * width;
  result.density = static_cast<double>(run.size()) / (kPi * (outer * outer - inner * inner));
  const auto is_back = [&](std::size_t i) { return backwards > 0 && i % static_cast<std::size_t>(backwards) == 0; };
  const auto measured_from = static_cast<int>(std::lround(warm_up / run.seconds()));
  const auto measured_to = static_cast<int>(std::lround((warm_up + seconds) / run.seconds()));
  int tick = 0;
  for (; tick < measured_from; ++tick) run.Step();
  std::size_t samples = 0;
  double order = 0.0;
  std::size_t orders = 0;
  for (; tick < measured_to; ++tick) {
    run.Step();
    constexpr int kSectors = 24;
    constexpr int kRadii = 5;
    constexpr std::size_t kPlaces = 120;  // of both
    std::vector<int> forth(kPlaces);
    std::vector<int> back(kPlaces);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const Vec2 at = run.At(i);
      const Vec2 along = Vec2(-at.y(), at.x()) / at.norm() * (is_back(i) ? -1.0 : 1.0);
      const double speed = run.VelocityOf(i).dot(along);
      result.speed += speed;
      result.jammed += run.VelocityOf(i).norm() < 0.05 ? 1.0 : 0.0;
      ++samples;
      const int sector = static_cast<int>((std::atan2(at.y(), at.x()) / (2.0 * kPi) + 0.5) * kSectors) % kSectors;
      const int ring = std::clamp(static_cast<int>((at.norm() - inner) / width * kRadii), 0, kRadii - 1);
      const int place = sector * kRadii + ring;
      ++(is_back(i) ? back : forth)[static_cast<std::size_t>(place)];
    }
    for (std::size_t k = 0; k < forth.size(); ++k) {
      const int all = forth[k] + back[k];
      if (all < 2) continue;
      const double share = static_cast<double>(forth[k] - back[k]) / all;
      order += share * share;
      ++orders;
    }
  }
  result.speed /= static_cast<double>(samples);
  result.jammed /= static_cast<double>(samples);
  result.least_gap = run.least_gap();
  result.order = orders > 0 ? order / static_cast<double>(orders) : 0.0;
  return result;
}

struct Passage {
  double seconds = 0.0;     // until all are at their goals; 0: never
  double mean_speed = 0.0;  // m/s, straight distance by time
  double least_gap = 0.0;
};
// `beyond`: a person that is so far along its axis has arrived, too.
template <typename Run = CrowdRun>
Passage RunToGoals(const CrowdWorld& crowd, double most_seconds, double beyond = 1e9, double reach = 1.5) {
  Run run(crowd.world);
  std::vector<double> arrival(run.size(), 0.0);
  Passage result;
  std::size_t there = 0;
  double t = 0.0;
  while (t < most_seconds && there < run.size()) {
    run.Step();
    t += run.seconds();
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (arrival[i] > 0.0) continue;
      const Vec2 goal = crowd.world.goal_sets[crowd.world.people[i].goals].points.front();
      const bool is_beyond = std::max(run.At(i).x(), run.At(i).y()) > beyond;
      if (!is_beyond && (goal - run.At(i)).norm() > reach) continue;
      arrival[i] = t;
      ++there;
      const Vec2 start = crowd.world.model(crowd.world.people[i].root).X_PM.translation();
      result.mean_speed += (is_beyond ? (run.At(i) - start).norm() : (goal - start).norm() - reach) / t;
    }
  }
  result.mean_speed /= static_cast<double>(run.size());
  result.least_gap = run.least_gap();
  if (there == run.size()) result.seconds = t;
  return result;
}

// Two groups whose ways cross at right angles, each in an own corridor of `width` m.
inline CrowdWorld CrossingWorld(double width, std::size_t people, std::uint64_t seed) {
  CrowdWorld crowd(seed);
  const double half = 0.5 * width;
  const double far = 12.0;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const double x0 = std::min(sx * half, sx * far);
      const double x1 = std::max(sx * half, sx * far);
      const double y0 = std::min(sy * half, sy * far);
      const double y1 = std::max(sy * half, sy * far);
      crowd.AddWall(x0, y0, x1, y1);
    }
  }
  std::vector<std::uint32_t> east;
  std::vector<std::uint32_t> north;
  for (int i = 0; i < 4; ++i) {
    const double across = (half - 0.6) * (2.0 * i / 3.0 - 1.0);
    east.push_back(crowd.AddGoals({{far + 20.0, across}}));
    north.push_back(crowd.AddGoals({{across, far + 20.0}}));
  }
  for (std::size_t i = 0; i < people; ++i) {
    const bool goes_east = i % 2 == 0;
    const Rectangle box = goes_east ? Rectangle{-far, -half + 0.3, -half - 0.5, half - 0.3}
                                    : Rectangle{-half + 0.3, -far, half - 0.3, -half - 0.5};
    const auto at = crowd.FindPlace(box, 0.1, [](const Vec2&) { return true; });
    if (!at) break;
    const double across = goes_east ? at->y() : at->x();
    const auto lane = static_cast<std::size_t>(std::clamp((across / half + 1.0) * 2.0, 0.0, 3.0));
    crowd.AddPerson(*at, (goes_east ? east : north)[lane]);
  }
  return crowd;
}

// People on a circle of `radius` m who go to the opposite places.
inline CrowdWorld CircleWorld(double radius, std::size_t people, std::uint64_t seed) {
  CrowdWorld crowd(seed);
  for (std::size_t i = 0; i < people; ++i) {
    const double turn = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(people);
    const SinCosResult direction = SinCos(turn);
    const Vec2 at(radius * direction.cos, radius * direction.sin);
    crowd.AddPerson(at, crowd.AddGoals({-at}));
  }
  return crowd;
}

}  // namespace troupe::bench
