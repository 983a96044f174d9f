// PeopleView: the world as people see it when they decide: a disc for each person, robot and object, with a velocity
// and an interval of heights. Private to this folder.
//
// Made once in a tick, after robots, doors and lifts have moved, and then constant: all threads read it while people
// decide, each person from the same state. It refers to the workspace and copies only what is cheaper to have side by
// side: discs by number, people first, so that disc i is person i for i < count().
//
// Discs are sorted into two grids, walkers and objects, because people avoid the former as discs and the latter by
// their sides. People that are removed or away and bodies without pieces have no heights or no disc: no person sees
// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/spatial/walk_routes.h"
#include "world-service/core/near_discs.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

class PeopleView {
 public:
  // REQUIRES: the workspace outlives the view, and no body moves before all people have decided.
  explicit PeopleView(const StepWorkspace& workspace);

  const Scene& scene() const { return workspace_.scene; }
  const WorldDescription& world() const { return workspace_.world(); }
  const WalkRoutes& routes() const { return workspace_.scene.walk_routes(); }
  // The state before the people decide.
  const WorldState& state() const { return workspace_.next; }
  double seconds() const { return workspace_.seconds(); }

  std::size_t count() const { return discs_of_people_; }
  const PersonState& person(std::size_t i) const { return workspace_.next.people[i]; }
  // It is in the world: neither removed nor away.
  bool Exists(std::size_t i) const { return !world().model(world().people[i].root).removed && !IsAway(person(i)); }
  // An object rests on its head.
  bool IsBurdened(std::size_t person) const { return is_burdened_[person]; }
  // m, how far the last of its group on its level is behind a leader.
  double behind(std::size_t person) const { return behind_[person]; }
  // The doors that open for a person and are blocked: people in the way of a leaf make room.
  const std::vector<std::size_t>& blocked_doors() const { return blocked_doors_; }

  // The discs of people by id, then of robots and objects.
  const std::vector<Disc>& discs() const { return discs_; }
  const Disc& disc(std::size_t i) const { return discs_[i]; }
  const NearDiscs& walkers() const { return walkers_; }  // people and robots
  const NearDiscs& objects() const { return objects_; }

 private:
  void AddPeople();
  void AddBodies();
  void FindBurdens();
  void MeasureGroups();
  void FindBlockedDoors();

  const StepWorkspace& workspace_;
  std::size_t discs_of_people_ = 0;
  std::vector<Disc> discs_;
  NearDiscs walkers_;
  NearDiscs objects_;
  std::vector<bool> is_burdened_;
  std::vector<double> behind_;
  std::vector<std::size_t> blocked_doors_;
};

constexpr double kQueueReach = 5.0;  // m from a target, for people behind others who wait for it
constexpr double kQueueGap = 0.3;    // m between people who wait

// Another person that waits for the same target, waits(person), is beside this one, and nearer to it.
template <typename Waits>
bool IsInQueue(const PeopleView& view, std::size_t i, const Vec2& target, Waits waits) {
  bool found = false;
  const Disc& me = view.disc(i);
  const double distance = (target - me.center).norm();
  view.walkers().ForEachNear(me.center, me.z, me.radius + kQueueGap, [&](std::uint32_t k) {
    if (k >= view.count() || k == i || !waits(view.person(k))) return;
    const double gap = (view.disc(k).center - me.center).norm() - view.disc(k).radius - me.radius;
    found = found || (gap <= kQueueGap && (target - view.disc(k).center).norm() < distance);
  });
  return found;
}

// The direction of a vector; zero for a vector without one.
inline Vec2 Unit(const Vec2& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec2(v / length) : Vec2(0.0, 0.0);
}

// Heights of floors (m) that are so near to each other are one level.
inline bool AreOnOneLevel(double a, double b) {
  return a - b < kSameLevel && b - a < kSameLevel;
}

}  // namespace troupe
