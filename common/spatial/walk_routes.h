// WalkRoutes: the ways of people through the static bodies of a world, on grids of cells in which a person fits,
// through doors, and with lifts between levels; and grids for robots, which search their ways alone (way_search.h).
//
// Levels are those of the world and the heights at which people start and lifts stop. A grid for each level, height and
// radius of people, and on it a field for each goal and each stop of a lift: the length of the shortest way from every
// cell. A field is made when a person first asks for it, by any thread; it is a pure function of the world.
//
// Memory is the reason for sizes: radii are rounded up to classes of 5 cm, so that a crowd of different people has a
// few grids. Goals at one point share their fields, and of very many fields only so many are kept as people can use at
// one time: one for each person, and those of the stops. The field that was not used for the longest time goes, and is
// made again for the next person that asks. MostBytes is an upper bound for the limits of loaders; it is asked before a
// scene is made.
//
// Safe for any number of threads: a field is made by one, while others with the same goal wait for it, and a thread
// that uses a field keeps it. The time of making a field is the only difference that threads see, never a result.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "common/spatial/scene.h"
#include "common/spatial/walk_portals.h"
#include "troupe/ids.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"

namespace troupe {

class WalkGrid;
class WalkField;

class WalkRoutes {
 public:
  // A point of a goal set of the world. REQUIRES, here and below: the set and the point exist.
  struct Goal {
    std::uint32_t goals = 0;
    std::uint32_t point = 0;
  };
  // A floor of a lift at which people get on and off. REQUIRES, here and below: it has such a stop.
  struct Stop {
    std::uint32_t lift = 0;
    std::uint32_t floor = 0;
  };
  struct Ride {
    std::uint32_t lift = 0;
    std::uint32_t to = 0;  // floor
  };
  // The next part of a way.
  struct Ahead {
    Vec2 point;                            // m, W: a person can walk straight there
    std::optional<std::size_t> door = {};  // the first doorway on the next metres of the way, if there is one
  };

  // More fields than people use are kept while they take less than `spare_bytes`.
  explicit WalkRoutes(const Scene& scene, std::size_t spare_bytes = kSpareBytes);
  // The memory (bytes) that the routes of a world with people may need at most. `scene`: that world, or the same
  // without people.
  static double MostBytes(const Scene& scene, const WorldDescription& world);
  ~WalkRoutes();

  const WalkPortals& portals() const { return portals_; }

  // The grid of robots at the heights `z` (m, W) with a radius (m). The same for all that ask for these, while it is in
  // use. REQUIRES: `scene` is that of the constructor, or a copy.
  std::shared_ptr<const WalkGrid> RobotGrid(const Scene& scene, const ZRange& z, double radius) const;

  // The level of a person at height `z`.
  std::size_t LevelAt(double z) const;
  // The level of a goal; of one without a height that on which the person starts.
  std::size_t LevelOf(PersonId person, const Goal& goal) const;

  // The place (m, W) at which a person can stand that is nearest to a goal: mostly the goal itself. Nothing if there is
  // none nearby.
  std::optional<Vec2> Target(PersonId person, const Goal& goal) const;

  // The way from a point on the level of the goal or stop: a point on the shortest one, the target itself where it is
  // near. Nothing if no way is known.
  std::optional<Ahead> AheadTo(PersonId person, const Goal& goal, const Vec2& from) const;
  std::optional<Ahead> AheadTo(PersonId person, const Stop& stop, const Vec2& from) const;

  // The length of that way, m, by steps between cells.
  std::optional<double> Length(PersonId person, const Goal& goal, const Vec2& from) const;
  std::optional<double> Length(PersonId person, const Stop& stop, const Vec2& from) const;

  // The next ride of the shortest way from a point on `level` to a goal on another one: with as few rides as possible.
  // Nothing if no lift leads there for a person of this width.
  std::optional<Ride> FindRide(PersonId person, std::size_t level, const Goal& goal, const Vec2& from) const;

 private:
  static constexpr std::size_t kSpareBytes = std::size_t{1} << 30;

  struct Size {  // of people: few, so that there are few grids
    ZRange z;    // above their floor
    double radius = 0.0;
    bool operator==(const Size&) const = default;
  };
  static Size SizeOf(const Scene& scene, PersonId person);

  void FindLevels(const WorldDescription& world);
  void FindSizes(const Scene& scene);
  void NumberTargets(const WorldDescription& world);

  // The numbers of goals and stops among the targets.
  std::size_t NumberOf(const Goal& goal) const;
  std::size_t NumberOf(const Stop& stop) const { return first_stop_[stop.lift] + stop.floor; }
  const LiftStop& StopOf(const Stop& stop) const { return *portals_.lifts[stop.lift].stops[stop.floor]; }
  using SharedField = std::shared_ptr<const WalkField>;
  SharedField FieldTo(PersonId person, const Goal& goal) const;
  SharedField FieldTo(PersonId person, const Stop& stop) const;
  SharedField FieldOf(PersonId person, std::size_t level, std::size_t number, const Vec2& target) const;
  // Null for one that is not there; else it counts as used.
  SharedField FieldIn(std::size_t slot) const;
  SharedField MakeField(std::size_t number, const WalkGrid& grid, const Vec2& target) const;
  void DropUnused() const;
  bool FitsIn(PersonId person, const LiftPortal& lift) const { return radii_[person.index()] <= lift.radius; }
  // Calls visit(stop) for the stops of a lift, by floor.
  template <typename Visit>
  void ForEachStop(std::uint32_t lift, Visit visit) const;
  // By number of a stop among the targets, from first_stop_[0] on: the fewest rides from its entrance to the goal.
  const std::vector<std::uint32_t>& RidesTo(PersonId person, const Goal& goal) const;
  std::vector<std::uint32_t> CountRides(PersonId person, const Goal& goal) const;

  const WalkPortals portals_;
  Rectangle robot_bounds_ = Rectangle::Nothing();
  struct RobotSize {
    ZRange z;
    double radius = 0.0;
    std::weak_ptr<const WalkGrid> grid;
  };
  mutable std::mutex making_robot_grids_;  // guards the next
  mutable std::vector<RobotSize> robot_sizes_;
  std::vector<double> levels_;                             // m, ascending
  std::vector<std::vector<Vec2>> goals_;                   // points, by set
  std::vector<std::vector<std::size_t>> levels_of_goals_;  // of the points, by set; empty for a set without heights
  std::vector<std::vector<std::size_t>> numbers_;          // of the points among the targets, by set
  std::vector<std::size_t> first_stop_;                    // by lift: the number of its first stop among the targets
  std::size_t targets_ = 0;
  std::vector<Size> sizes_;
  std::vector<double> radii_;  // m, by person, like the next
  std::vector<std::size_t> size_of_;
  std::vector<std::size_t> kind_of_;  // people of one size and radius are of one kind
  std::size_t kinds_ = 0;
  std::vector<std::size_t> start_level_;
  std::vector<std::unique_ptr<const WalkGrid>> grids_;  // by size and level
  struct Slot {
    SharedField field;             // null: not made, or dropped
    std::uint64_t used_after = 0;  // so many were made when it was used last
  };
  // Some mutexes for many slots, by their numbers. In a guard nothing takes long; the search for a field is in making_.
  using Mutexes = std::array<std::mutex, 64>;
  std::mutex& GuardOf(std::size_t slot) const { return guards_[slot % guards_.size()]; }
  mutable std::vector<Slot> slots_;  // by size, level and target
  mutable Mutexes guards_;
  mutable Mutexes making_;
  std::size_t most_fields_ = 0;  // that are kept
  mutable std::mutex dropping_;
  mutable std::atomic<std::uint64_t> made_ = 0;                      // fields, so far
  mutable std::atomic<std::size_t> kept_ = 0;                        // fields
  mutable std::mutex counting_;                                      // guards the next
  mutable std::map<std::size_t, std::vector<std::uint32_t>> rides_;  // by kind, level and target
};

// The routes of a scene, once they are asked for.
struct LazyWalkRoutes {
  std::once_flag made;
  std::unique_ptr<const WalkRoutes> routes;
};

}  // namespace troupe
