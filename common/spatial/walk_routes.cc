#include "common/spatial/walk_routes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "common/spatial/walk_grid.h"
#include "troupe/check.h"
#include "troupe/rectangle.h"

namespace troupe {
namespace {

constexpr int kLookAhead = 48;      // steps, whole strides
constexpr double kDoorAhead = 3.0;  // m, by steps: a door that is nearer is seen
constexpr double kPressed = 0.3;    // m from the free cells, of a person that touches a wall
constexpr double kBorder = 2.0;     // m, of grids around all that is in them
constexpr std::uint32_t kNoRide = std::numeric_limits<std::uint32_t>::max();

// The next part of the way from the cell `start`, as seen from `origin`; nothing if no part is in sight.
std::optional<WalkRoutes::Ahead> SeeAhead(const WalkField& field, std::size_t start, const Vec2& origin) {
  const WalkGrid& grid = field.grid();
  std::optional<std::size_t> door = grid.DoorOf(start);
  const int most = kLookAhead / field.stride();
  const int door_strides = static_cast<int>(kDoorAhead / (field.stride() * grid.cell()));
  std::array<std::size_t, kLookAhead> way;  // the ends of strides
  int strides = 0;
  for (std::size_t at = start; strides < most; ++strides) {
    const std::size_t next = field.CellAhead(at);
    if (next == at) break;  // the goal
    way[static_cast<std::size_t>(strides)] = at = next;
    if (!door && strides < door_strides) door = grid.DoorOf(next);
  }
  const bool is_near = strides == 0 || field.IsTarget(way[static_cast<std::size_t>(strides) - 1]);
  if (is_near && grid.IsClear(origin, *field.target())) return WalkRoutes::Ahead{*field.target(), door};
  // The farthest cell of the way in sight, nearly: straight lines in place of the steps of the grid. A few tests,
  // because each costs a line of cells.
  for (int ahead = strides; ahead > 0; ahead = ahead * 3 / 4) {
    const Vec2 center = grid.CenterOf(way[static_cast<std::size_t>(ahead) - 1]);
    if (grid.IsClear(origin, center)) return WalkRoutes::Ahead{center, door};
  }
  return std::nullopt;
}

// The next part of the way of a field.
std::optional<WalkRoutes::Ahead> AheadIn(const WalkField& field, const Vec2& from) {
  const std::optional<std::size_t> start = field.StartOf(from);
  if (!start) return std::nullopt;
  const WalkGrid& grid = field.grid();
  // Where a person is pressed against a wall it is beside the free cells, and walks as from the nearest one: the wall
  // keeps it from the corners that it would cut. Farther away, or beyond the grid: back to them first.
  Vec2 origin = from;
  if (*start != grid.CellOf(from) || !grid.Contains(from)) {
    origin = grid.CenterOf(*start);
    if ((origin - from).norm() > kPressed) return WalkRoutes::Ahead{origin};
  }
  // All cells of a block use the way from one of them: most of it has been found for others.
  const std::size_t shared = field.SharedStart(*start);
  if (auto ahead = SeeAhead(field, shared, origin)) return ahead;
  if (shared != *start) {
    if (auto ahead = SeeAhead(field, *start, origin)) return ahead;
  }
  const std::size_t next = field.NextCell(*start);
  return WalkRoutes::Ahead{next != *start ? grid.CenterOf(next) : *field.target(), grid.DoorOf(*start)};
}

std::optional<double> LengthIn(const WalkField& field, const Vec2& from) {
  const std::optional<std::size_t> start = field.StartOf(from);
  return start ? std::optional(field.LengthFrom(*start)) : std::nullopt;
}

// m: people of nearly one radius have one grid.
double ClassOf(double radius) {
  constexpr double kClass = 0.05;  // m
  // Rounded up: a person fits wherever its class does.
  return kClass * std::ceil(radius / kClass - 1e-6);
}

// With room around all that people come to.
Rectangle FindBounds(const StaticIndex& walls, const WorldDescription& world, const WalkPortals& portals) {
  Rectangle bounds = walls.bounds();
  for (const GoalSet& set : world.goal_sets) {
    for (const Vec2& point : set.points) bounds.Extend(point);
  }
  for (const PersonDescription& person : world.people) bounds.Extend(world.model(person.root).X_PM.translation());
  for (const LiftPortal& lift : portals.lifts) {
    for (const std::optional<LiftStop>& stop : lift.stops) {
      if (stop) bounds.Extend(stop->Entrance());
    }
  }
  return bounds.Inflated(kBorder);
}

std::size_t CountStops(const WalkPortals& portals) {
  std::size_t stops = 0;
  for (const LiftPortal& lift : portals.lifts) stops += lift.stops.size();
  return stops;
}

// The fields that are kept: as many as people use at one time, with room for those that they have just used, and more
// within the spare bytes. `cells`: of one.
std::size_t MaxFields(const WorldDescription& world, std::size_t sizes, std::size_t stops, std::size_t cells,
                      std::size_t spare_bytes) {
  const std::size_t people = world.people.size();
  return std::max(people + people / 2 + sizes * stops, spare_bytes / (WalkGrid::kBytesOfCell * cells));
}

}  // namespace

WalkRoutes::~WalkRoutes() = default;

WalkRoutes::WalkRoutes(const Scene& scene, std::size_t spare_bytes) : portals_(scene) {
  const WorldDescription& world = scene.world();
  FindLevels(world);
  FindSizes(scene);
  NumberTargets(world);
  const Rectangle bounds = FindBounds(scene.static_index(), world, portals_);
  robot_bounds_ = bounds;
  for (const RobotDescription& robot : world.robots) {
    const Vec2 start = world.model(robot.root).X_PM.translation();
    robot_bounds_.Extend(Rectangle::Around(start, kBorder));
  }
  for (const Size& size : sizes_) {
    for (const double level : levels_) {
      // By size and level; their order is that of FieldOf.
      grids_.push_back(
          std::make_unique<const WalkGrid>(scene.static_index(), portals_, size.z + level, size.radius, bounds));
    }
  }
  slots_ = std::vector<Slot>(grids_.size() * targets_);
  if (sizes_.empty()) return;  // of robots alone, perhaps without bounds
  most_fields_ = MaxFields(world, sizes_.size(), CountStops(portals_), WalkGrid::CountCells(bounds), spare_bytes);
}

double WalkRoutes::MostBytes(const Scene& scene, const WorldDescription& world) {
  const WalkPortals portals(scene);
  std::set<std::pair<double, double>> sizes;
  for (const PersonDescription& person : world.people) {
    sizes.emplace(ClassOf(person.radius), world.model(person.root).size_z);
  }
  std::set<std::pair<double, double>> points;
  for (const GoalSet& set : world.goal_sets) {
    for (const Vec2& point : set.points) points.emplace(point.x(), point.y());
  }
  const std::size_t stops = CountStops(portals);
  const std::size_t levels = std::max<std::size_t>(1, world.levels.size());
  const std::size_t slots = sizes.size() * levels * (points.size() + stops);
  const std::size_t cells = WalkGrid::CountCells(FindBounds(scene.static_index(), world, portals));
  const std::size_t fields = std::min(slots, MaxFields(world, sizes.size(), stops, cells, kSpareBytes));
  return static_cast<double>(WalkGrid::kBytesOfCell * cells) * static_cast<double>(fields + sizes.size() * levels) +
         static_cast<double>(sizeof(Slot) * slots);
}

void WalkRoutes::FindLevels(const WorldDescription& world) {
  std::vector<double> heights;
  for (const PersonDescription& person : world.people) heights.push_back(world.model(person.root).X_PM.z);
  for (const LevelDescription& level : world.levels) heights.push_back(level.z);  // also without a stop
  for (const LiftPortal& lift : portals_.lifts) {
    for (const std::optional<LiftStop>& stop : lift.stops) {
      if (stop) heights.push_back(stop->z);
    }
  }
  std::sort(heights.begin(), heights.end());
  for (const double height : heights) {
    // Floors within a step's height are one level.
    if (levels_.empty() || height - levels_.back() > kSameLevel) levels_.push_back(height);
  }
}

WalkRoutes::Size WalkRoutes::SizeOf(const Scene& scene, PersonId person) {
  return {scene.body(scene.body_of(person)).z, ClassOf(RadiusOf(scene, person))};
}

void WalkRoutes::FindSizes(const Scene& scene) {
  std::map<std::pair<std::size_t, double>, std::size_t> kinds;
  for (std::size_t i = 0; i < scene.world().people.size(); ++i) {
    radii_.push_back(RadiusOf(scene, PersonId(i)));
    const Size size = SizeOf(scene, PersonId(i));
    const auto same = std::find(sizes_.begin(), sizes_.end(), size);
    size_of_.push_back(static_cast<std::size_t>(same - sizes_.begin()));
    if (same == sizes_.end()) sizes_.push_back(size);
    const auto kind = kinds.emplace(std::pair(size_of_.back(), radii_.back()), kinds.size()).first;
    kind_of_.push_back(kind->second);
    start_level_.push_back(LevelAt(scene.world().model(scene.world().people[i].root).X_PM.z));
  }
  kinds_ = kinds.size();
}

void WalkRoutes::NumberTargets(const WorldDescription& world) {
  std::map<std::pair<double, double>, std::size_t> numbers;  // of points, which sets may share
  for (const GoalSet& set : world.goal_sets) {
    goals_.push_back(set.points);
    std::vector<std::size_t>& of_set = numbers_.emplace_back();
    for (const Vec2& point : set.points) {
      const auto [found, is_new] = numbers.emplace(std::pair(point.x(), point.y()), targets_);
      if (is_new) ++targets_;
      of_set.push_back(found->second);
    }
    std::vector<std::size_t>& of_points = levels_of_goals_.emplace_back();
    for (const double height : set.heights) {
      // A place on a table belongs to the floor below.
      const auto above =
          std::find_if(levels_.begin(), levels_.end(), [&](double level) { return level > height + kSameLevel; });
      of_points.push_back(above == levels_.begin() ? 0 : static_cast<std::size_t>(above - levels_.begin()) - 1);
    }
  }
  for (const LiftPortal& lift : portals_.lifts) {
    first_stop_.push_back(targets_);
    targets_ += lift.stops.size();
  }
}

std::size_t WalkRoutes::LevelAt(double z) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    if (std::fabs(levels_[i] - z) < std::fabs(levels_[best] - z)) best = i;
  }
  return best;
}

std::size_t WalkRoutes::LevelOf(PersonId person, const Goal& goal) const {
  const std::vector<std::size_t>& levels = levels_of_goals_[goal.goals];
  return levels.empty() ? start_level_[person.index()] : levels[goal.point];
}

std::size_t WalkRoutes::NumberOf(const Goal& goal) const {
  TROUPE_CHECK(goal.goals < goals_.size() && goal.point < goals_[goal.goals].size());
  return numbers_[goal.goals][goal.point];
}

WalkRoutes::SharedField WalkRoutes::FieldTo(PersonId person, const Goal& goal) const {
  return FieldOf(person, LevelOf(person, goal), NumberOf(goal), goals_[goal.goals][goal.point]);
}

WalkRoutes::SharedField WalkRoutes::FieldTo(PersonId person, const Stop& stop) const {
  return FieldOf(person, LevelAt(StopOf(stop).z), NumberOf(stop), StopOf(stop).Entrance());
}

WalkRoutes::SharedField WalkRoutes::FieldOf(PersonId person, std::size_t level, std::size_t number,
                                            const Vec2& target) const {
  const std::size_t grid = size_of_[person.index()] * levels_.size() + level;
  const std::size_t slot = grid * targets_ + number;
  SharedField field = FieldIn(slot);
  return field ? field : MakeField(slot, *grids_[grid], target);
}

WalkRoutes::SharedField WalkRoutes::FieldIn(std::size_t slot) const {
  const std::scoped_lock lock(GuardOf(slot));
  slots_[slot].used_after = made_.load(std::memory_order_relaxed);
  return slots_[slot].field;
}

WalkRoutes::SharedField WalkRoutes::MakeField(std::size_t slot, const WalkGrid& grid, const Vec2& target) const {
  const std::scoped_lock lock(making_[slot % making_.size()]);
  if (SharedField other = FieldIn(slot)) return other;  // another thread was first
  SharedField field = std::make_shared<const WalkField>(grid, target);
  ++made_;
  {
    const std::scoped_lock guard(GuardOf(slot));
    slots_[slot] = {field, made_};
  }
  if (++kept_ > most_fields_) DropUnused();
  return field;
}

// Down to three quarters, so that the search for them is rare.
void WalkRoutes::DropUnused() const {
  const std::scoped_lock lock(dropping_);
  if (kept_ <= most_fields_) return;
  std::vector<std::pair<std::uint64_t, std::size_t>> used;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    const std::scoped_lock guard(GuardOf(slot));
    if (slots_[slot].field) used.emplace_back(slots_[slot].used_after, slot);
  }
  std::sort(used.begin(), used.end());
  used.resize(used.size() - std::min(used.size(), most_fields_ * 3 / 4));
  for (const auto& [when, slot] : used) {
    const std::scoped_lock guard(GuardOf(slot));
    slots_[slot].field.reset();
  }
  kept_ -= used.size();
}

// Weak, so that a robot that goes up in a lift leaves no grids behind.
std::shared_ptr<const WalkGrid> WalkRoutes::RobotGrid(const Scene& scene, const ZRange& z, double radius) const {
  // A robot of two cells or less would see gaps that are not there, and miss others.
  constexpr double kCellsOfRadius = 3.0;
  constexpr double kSmallest = 0.02;  // m
  radius = std::max(radius, kSmallest);
  const std::scoped_lock lock(making_robot_grids_);
  std::erase_if(robot_sizes_, [](const RobotSize& size) { return size.grid.expired(); });
  for (const RobotSize& size : robot_sizes_) {
    if (size.z == z && size.radius == radius) return size.grid.lock();
  }
  auto grid = std::make_shared<const WalkGrid>(scene.static_index(), portals_, z, radius, robot_bounds_,
                                               std::min(radius / kCellsOfRadius, WalkGrid::kMinCell));
  robot_sizes_.push_back({z, radius, grid});
  return grid;
}

std::optional<Vec2> WalkRoutes::Target(PersonId person, const Goal& goal) const {
  return FieldTo(person, goal)->target();
}

std::optional<WalkRoutes::Ahead> WalkRoutes::AheadTo(PersonId person, const Goal& goal, const Vec2& from) const {
  return AheadIn(*FieldTo(person, goal), from);
}

std::optional<WalkRoutes::Ahead> WalkRoutes::AheadTo(PersonId person, const Stop& stop, const Vec2& from) const {
  return AheadIn(*FieldTo(person, stop), from);
}

std::optional<double> WalkRoutes::Length(PersonId person, const Goal& goal, const Vec2& from) const {
  return LengthIn(*FieldTo(person, goal), from);
}

std::optional<double> WalkRoutes::Length(PersonId person, const Stop& stop, const Vec2& from) const {
  return LengthIn(*FieldTo(person, stop), from);
}

template <typename Visit>
void WalkRoutes::ForEachStop(std::uint32_t lift, Visit visit) const {
  const std::vector<std::optional<LiftStop>>& stops = portals_.lifts[lift].stops;
  for (std::uint32_t floor = 0; floor < stops.size(); ++floor) {
    if (stops[floor]) visit(Stop{lift, floor});
  }
}

// From the goal backwards: each round finds the stops from which one ride more is needed.
std::vector<std::uint32_t> WalkRoutes::CountRides(PersonId person, const Goal& goal) const {
  std::vector<Stop> stops;
  for (std::uint32_t lift = 0; lift < portals_.lifts.size(); ++lift)
    ForEachStop(lift, [&](const Stop& stop) { stops.push_back(stop); });
  std::vector<std::uint32_t> rides(targets_ - first_stop_.front(), kNoRide);
  const auto rides_from = [&](const Stop& stop) -> std::uint32_t& {
    return rides[NumberOf(stop) - first_stop_.front()];
  };
  const std::size_t to = LevelOf(person, goal);
  for (const Stop& stop : stops) {
    // From its entrance a person walks to the goal.
    if (LevelAt(StopOf(stop).z) == to && Length(person, goal, StopOf(stop).Entrance())) rides_from(stop) = 0;
  }
  bool has_found = true;
  for (std::uint32_t count = 1; has_found; ++count) {
    has_found = false;
    for (const Stop& on : stops) {
      if (!FitsIn(person, portals_.lifts[on.lift])) continue;
      const bool leads_on = std::any_of(stops.begin(), stops.end(), [&](const Stop& off) {
        return off.lift == on.lift && rides_from(off) == count - 1;
      });
      if (!leads_on) continue;
      for (const Stop& from : stops) {
        if (rides_from(from) != kNoRide || LevelAt(StopOf(from).z) != LevelAt(StopOf(on).z)) continue;
        if (!Length(person, on, StopOf(from).Entrance())) continue;
        rides_from(from) = count;
        has_found = true;
      }
    }
  }
  return rides;
}

const std::vector<std::uint32_t>& WalkRoutes::RidesTo(PersonId person, const Goal& goal) const {
  const std::size_t number =
      (kind_of_[person.index()] * levels_.size() + LevelOf(person, goal)) * targets_ + NumberOf(goal);
  // Rare: when a trip to another level begins.
  const std::scoped_lock lock(counting_);
  const auto [entry, is_new] = rides_.try_emplace(number);
  if (is_new) entry->second = CountRides(person, goal);
  return entry->second;
}

std::optional<WalkRoutes::Ride> WalkRoutes::FindRide(PersonId person, std::size_t level, const Goal& goal,
                                                     const Vec2& from) const {
  if (level == LevelOf(person, goal) || first_stop_.empty()) return std::nullopt;
  const std::vector<std::uint32_t>& rides = RidesTo(person, goal);
  std::optional<Ride> best;
  std::pair least(kNoRide, std::numeric_limits<double>::infinity());  // rides after this one, and the length
  for (std::uint32_t lift = 0; lift < portals_.lifts.size(); ++lift) {
    if (!FitsIn(person, portals_.lifts[lift])) continue;
    ForEachStop(lift, [&](const Stop& on) {
      if (LevelAt(StopOf(on).z) != level) return;
      const std::optional<double> before = Length(person, on, from);
      if (!before) return;
      ForEachStop(lift, [&](const Stop& off) {
        const std::uint32_t more = rides[NumberOf(off) - first_stop_.front()];
        if (more == kNoRide) return;
        // The way after a further ride is not counted.
        const double after = more == 0 ? *Length(person, goal, StopOf(off).Entrance()) : 0.0;
        const std::pair length(more, *before + std::fabs(StopOf(off).z - StopOf(on).z) + after);
        // Fewer rides before a shorter way; of equal ones the first lift and floor.
        if (length >= least) return;
        least = length;
        best = Ride{lift, off.floor};
      });
    });
  }
  return best;
}

}  // namespace troupe
