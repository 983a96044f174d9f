#include "common/spatial/walk_portals.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace troupe {
namespace {

constexpr double kRoom = 0.08;        // m, beyond their radii between people in a cabin who pass each other
constexpr double kWallRoom = 0.03;    // m, between people in a cabin and its walls
constexpr double kDoorRoom = 0.1;     // m, between people and the leaves of a lift
constexpr double kLane = 1.0;         // m, beside a person, that is kept free before a lift
constexpr double kSearchStep = 0.05;  // m
constexpr double kSlack = 1e-3;       // m, of heights in a cabin
constexpr int kFanParts = 6;

// The corners of a box in frame F.
std::vector<Vec2> OutlineOf(const Rectangle& box, const Pose& X_WF) {
  const Transform2 to_world(X_WF);
  std::vector<Vec2> outline;
  for (const Vec2& corner : Corners(box)) outline.push_back(to_world * corner);
  return outline;
}

// A vector of a length and direction.
Vec2 Polar(double length, double angle) {
  return Transform2(Pose{0.0, 0.0, 0.0, WrapAngle(angle)}).Rotate({length, 0.0});
}

// The pieces of a leaf at an opening, in W.
std::vector<ConvexPiece> LeafAt(const Scene& scene, const DoorLeaf& leaf, double opening) {
  std::vector<ConvexPiece> pieces;
  for (const ConvexPiece& piece : scene.body(scene.body_of(leaf.object)).pieces) {
    pieces.push_back(Transformed(piece, leaf.X_WH_at(opening)));
  }
  return pieces;
}

// A sector around the hinge, as a fan whose chords are outside of the arc.
std::vector<Vec2> HingedSweep(const Rectangle& leaf, const DoorLeaf& description) {
  // A leaf may be as thick as it likes: its corners stay within the radius.
  const double thickness = std::max(std::fabs(leaf.min_y), std::fabs(leaf.max_y));
  const double radius = std::max({std::fabs(leaf.min_x), std::fabs(leaf.max_x), thickness}) + thickness;
  const double start = -leaf.min_x > leaf.max_x ? kPi : 0.0;  // the direction of the leaf in H
  const bool is_round = std::fabs(description.turn) > kPi - 0.1;
  const double turn = is_round ? 2.0 * kPi : description.turn;
  const int parts = is_round ? 3 * kFanParts : kFanParts;
  const double part = turn / parts;
  // The corners of the fan are outside of the arc so far that its chords touch it.
  const double reach = radius / Polar(1.0, 0.5 * part).x();
  const Transform2 X_WH(description.X_WH);
  std::vector<Vec2> fan;
  if (!is_round) fan.push_back(X_WH * Vec2(0.0, 0.0));
  if (!is_round) fan.push_back(X_WH * Polar(radius, start));
  for (int i = 0; i < parts; ++i) fan.push_back(X_WH * Polar(reach, start + (i + 0.5) * part));
  if (!is_round) fan.push_back(X_WH * Polar(radius, start + turn));
  // Polygons are counter-clockwise.
  if (turn < 0.0) std::reverse(fan.begin(), fan.end());
  return fan;
}

std::vector<Vec2> SlidingSweep(Rectangle leaf, const DoorLeaf& description) {
  Rectangle open = leaf;
  open.min_x += description.shift;
  open.max_x += description.shift;
  leaf.Extend(open);
  return OutlineOf(leaf, description.X_WH);
}

DoorPortal MakeDoor(const Scene& scene, const DoorDescription& door) {
  DoorPortal portal;
  for (const DoorLeaf& leaf : door.leaves) {
    Rectangle box = Rectangle::Nothing();  // frame H
    for (const ConvexPiece& piece : scene.body(scene.body_of(leaf.object)).pieces) {
      box.Extend(BoundingBox(piece.vertices));
    }
    if (box.empty()) continue;  // a leaf without blocks
    for (ConvexPiece& piece : LeafAt(scene, leaf, 0.0)) portal.closed.push_back(std::move(piece));
    const bool is_hinged = leaf.turn != 0.0;
    portal.sweeps.push_back(is_hinged ? HingedSweep(box, leaf) : SlidingSweep(box, leaf));
    portal.hinges.push_back(is_hinged ? std::optional(leaf.X_WH.translation()) : std::nullopt);
  }
  return portal;
}

// The doorway of a lift at one of its floors, by its cabin's door, else by the first one.
std::optional<LiftStop> MakeStop(const Scene& scene, const LiftDescription& lift, std::size_t number, const Vec2& cabin,
                                 double radius) {
  const WorldDescription& world = scene.world();
  const LiftFloor& floor = lift.floors[number];
  if (floor.doors.empty()) return std::nullopt;
  const auto is_of_cabin = [&](std::size_t door) {
    return std::find(lift.cabin_doors.begin(), lift.cabin_doors.end(), door) != lift.cabin_doors.end();
  };
  const auto found = std::find_if(floor.doors.begin(), floor.doors.end(), is_of_cabin);
  const DoorDescription& door = world.doors[found != floor.doors.end() ? *found : floor.doors.front()];
  LiftStop stop;
  stop.z = floor.z;
  stop.outward = Transform2(door.leaves.front().X_WH).Rotate({0.0, 1.0});
  const auto extent = [&](const DoorDescription& its) {  // in U
    Rectangle box = Rectangle::Nothing();
    for (const DoorLeaf& leaf : its.leaves) {
      for (const ConvexPiece& piece : LeafAt(scene, leaf, 0.0)) {
        for (const Vec2& corner : piece.vertices) box.Extend(stop.ToU(corner));
      }
    }
    return box;
  };
  stop.door = door.leaves.front().X_WH.translation();
  // The file may give the leaf either direction: out is away from the cabin's middle.
  if (stop.ToU(cabin).x() > 0.0) stop.outward = -stop.outward;
  const Rectangle box = extent(door);
  if (box.empty()) return std::nullopt;  // leaves without blocks
  stop.door = stop.FromU({0.5 * (box.min_x + box.max_x), 0.5 * (box.min_y + box.max_y)});
  stop.half_width = 0.5 * box.height();
  double edge = 0.5 * box.width();
  constexpr double kBeside = 1.0;  // m
  for (const std::size_t other : floor.doors) {
    const Rectangle its = extent(world.doors[other]);
    if (its.empty()) continue;
    const bool is_beside = std::fabs(0.5 * (its.min_x + its.max_x)) < kBeside && its.min_y < stop.half_width &&
                           its.max_y > -stop.half_width;
    if (is_beside) edge = std::max(edge, its.max_x);
  }
  stop.outside = edge + radius + kDoorRoom;
  stop.lane = stop.outside + kLane;
  return stop;
}

// Finds where people of a radius can stand in a cabin. A way as wide as a person leads from the door to the wall
// opposite; they stand beside it and at its end, so that each can get off without asking the others to make room.
class PlaceFinder {
 public:
  // `walls`: of the cabin, in W.
  PlaceFinder(const std::vector<ConvexPiece>& walls, const LiftStop& stop, const Rectangle& outline_U, double radius)
      : walls_(walls), stop_(stop), outline_(outline_U), radius_(radius) {}

  std::vector<Vec2> Find(bool may_close_the_end) {
    const double pitch = 2.0 * radius_ + kRoom;
    const double front = -radius_ - kDoorRoom;
    const std::optional<double> back = Last(0.5 * front, outline_.min_x, [](double u) { return Vec2(u, 0.0); });
    if (!back) return {};
    std::vector<Vec2> places;
    if (may_close_the_end) places.push_back(stop_.FromU({*back, 0.0}));
    for (int row = 0; *back + row * pitch <= front + 1e-9; ++row) {
      const double u = *back + row * pitch;
      for (const double side : {1.0, -1.0}) {
        const double end = side > 0.0 ? outline_.max_y : outline_.min_y;
        const std::optional<double> v = Last(side * pitch, end, [u](double at) { return Vec2(u, at); });
        if (v) places.push_back(stop_.FromU({u, *v}));
      }
    }
    return places;
  }

 private:
  // The last of the coordinates from `from` to `to` up to which a person is free.
  template <typename PointAt>
  std::optional<double> Last(double from, double to, PointAt point_at) const {
    std::optional<double> last;
    const int steps = static_cast<int>(std::fabs(to - from) / kSearchStep);
    if ((to - from) * (from < 0.0 ? -1.0 : 1.0) < 0.0) return last;
    for (int i = 0; i <= steps; ++i) {
      const double at = from + std::copysign(i * kSearchStep, to - from);
      if (!IsFree(stop_.FromU(point_at(at)))) break;
      last = at;
    }
    return last;
  }
  bool IsFree(const Vec2& p) const {
    return std::none_of(walls_.begin(), walls_.end(), [&](const ConvexPiece& wall) {
      return FindNearestPoints(std::span(&p, 1), wall.vertices).distance < radius_ + kWallRoom;
    });
  }

  const std::vector<ConvexPiece>& walls_;
  const LiftStop& stop_;
  const Rectangle outline_;  // of the cabin, in U
  const double radius_;
};

// For people of a radius; without stops where there is no room for them.
LiftPortal MakeLift(const Scene& scene, const LiftDescription& lift, double radius) {
  LiftPortal portal;
  portal.radius = radius;
  const Body& cabin = scene.body(scene.body_of(lift.cabin));
  portal.X_WC = scene.world().model(scene.world().objects[lift.cabin.index()]).X_PM;
  portal.height = cabin.z.max;
  if (cabin.pieces.empty()) {
    portal.stops.resize(lift.floors.size());
    return portal;
  }
  std::vector<ConvexPiece> walls;
  for (const ConvexPiece& piece : cabin.pieces) {
    portal.outline.Extend(BoundingBox(piece.vertices));
    constexpr double kKnee = 0.3;  // m: lower blocks are its floor
    if (piece.obstacle && piece.z.max > kKnee) walls.push_back(Transformed(piece, portal.X_WC));
  }
  const Vec2 middle = Transform2(portal.X_WC) * portal.outline.center();
  bool is_straight = true;  // all doors on one side
  const LiftStop* first = nullptr;
  portal.stops.reserve(lift.floors.size());
  for (std::size_t i = 0; i < lift.floors.size(); ++i) {
    portal.stops.push_back(MakeStop(scene, lift, i, middle, radius));
    const std::optional<LiftStop>& stop = portal.stops.back();
    if (!stop) continue;
    if (first == nullptr) first = &*stop;
    is_straight = is_straight && (stop->door - first->door).norm() < kSlack;
  }
  if (first == nullptr) return portal;
  Rectangle outline_U = Rectangle::Nothing();
  for (const Vec2& corner : OutlineOf(portal.outline, portal.X_WC)) outline_U.Extend(first->ToU(corner));
  portal.places = PlaceFinder(walls, *first, outline_U, radius).Find(is_straight);
  // Without room to stand there is no way to get on.
  if (portal.places.empty()) std::fill(portal.stops.begin(), portal.stops.end(), std::nullopt);
  return portal;
}

// For the widest people that find room in the cabin. `radii`: of all people, descending.
LiftPortal MakeLift(const Scene& scene, const LiftDescription& lift, std::span<const double> radii) {
  // From the widest down: a lift that is too narrow for some people is still there for the others.
  for (const double radius : radii) {
    LiftPortal portal = MakeLift(scene, lift, radius);
    if (!portal.places.empty() || radius == radii.back()) return portal;
  }
  return MakeLift(scene, lift, 0.0);
}

}  // namespace

double RadiusOf(const Scene& scene, PersonId person) {
  const std::optional<BodyId> body = scene.body_of(scene.world().person(person).root);
  return std::max(scene.world().person(person).radius, body ? scene.body(*body).radius : 0.0);
}

DoorPortal::Clearance DoorPortal::ClearanceOf(const Vec2& p) const {
  Clearance least{.distance = 1e9};
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    const NearestPoints near = FindNearestPoints(std::span(&p, 1), sweeps[i]);
    if (near.distance >= least.distance) continue;
    Vec2 away = p - near.b;
    if (near.distance == 0.0) away = p - hinges[i].value_or(closed.front().vertices.front());
    const double length = away.norm();
    least = {near.distance, length > 0.0 ? Vec2(away / length) : Vec2(0.0, 0.0)};
  }
  return least;
}

bool LiftPortal::IsInside(const Vec2& p, double above) const {
  if (!(above >= -kSlack && above <= height + kSlack)) return false;
  const Vec2 p_C = Transform2(X_WC).InverseTransform(p);
  return p_C.x() > outline.min_x && p_C.x() < outline.max_x && p_C.y() > outline.min_y && p_C.y() < outline.max_y;
}

std::optional<std::uint32_t> LiftPortal::FloorAt(double z) const {
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (stops[i] && std::fabs(stops[i]->z - z) < kSameLevel) return static_cast<std::uint32_t>(i);
  }
  return std::nullopt;
}

WalkPortals::WalkPortals(const Scene& scene) {
  const WorldDescription& world = scene.world();
  std::vector<double> radii;
  for (std::size_t i = 0; i < world.people.size(); ++i) radii.push_back(RadiusOf(scene, PersonId(i)));
  std::sort(radii.begin(), radii.end(), std::greater<>());
  radii.erase(std::unique(radii.begin(), radii.end()), radii.end());
  std::vector<bool> is_of_lift(world.doors.size(), false);
  for (const LiftDescription& lift : world.lifts) {
    for (const LiftFloor& floor : lift.floors) {
      for (const std::size_t door : floor.doors) is_of_lift[door] = true;
    }
    for (const std::size_t door : lift.cabin_doors) is_of_lift[door] = true;
    lifts.push_back(MakeLift(scene, lift, radii));
    const LiftPortal& portal = lifts.back();
    if (portal.outline.empty()) continue;  // a cabin without blocks
    // People walk around the whole shaft at all heights between its floors: on a level without the cabin there may be a
    // hole behind the door.
    ConvexPiece shaft{.vertices = OutlineOf(portal.outline, portal.X_WC), .z = {1e9, -1e9}, .model = lift.model};
    for (const LiftFloor& floor : lift.floors) {
      shaft.z.min = std::min(shaft.z.min, floor.z);
      shaft.z.max = std::max(shaft.z.max, floor.z + portal.height);
    }
    walls.push_back(std::move(shaft));
  }
  for (std::size_t i = 0; i < world.doors.size(); ++i) {
    const DoorDescription& door = world.doors[i];
    doors.emplace_back();
    if (is_of_lift[i]) continue;
    if (door.is_operated) {
      doors.back() = MakeDoor(scene, door);
      for (const DoorLeaf& leaf : door.leaves) {
        for (ConvexPiece& piece : LeafAt(scene, leaf, 1.0)) open_leaves.push_back(std::move(piece));
      }
      continue;
    }
    for (const DoorLeaf& leaf : door.leaves) {
      for (ConvexPiece& piece : LeafAt(scene, leaf, door.opening)) walls.push_back(std::move(piece));
    }
  }
}

}  // namespace troupe
