#include "world-service/core/avoidance.h"

#include <algorithm>

#include "world-service/core/pedestrian_goals.h"

namespace troupe {
namespace {

constexpr double kAvoidReach = 5.0;        // m: others farther away are not avoided
constexpr std::size_t kMaxNeighbors = 12;  // the nearest
constexpr double kWalkerHorizon = 1.0;     // s
constexpr double kBoundHorizon = 1.5;      // s, of people who get on or off a lift: they have no other way round
constexpr double kWallHorizon = 0.5;       // s
constexpr double kGap = 0.01;              // m that people leave to others and to walls if they can
constexpr double kOneWay = 3.0;            // how much more people of one way care for those before them alone
constexpr double kGoesFirst = 0.2;         // of the avoidance: one that has less to do does nothing
constexpr double kPress = 0.5;             // m/s, of one that goes first: others make room for it, even if it stands
constexpr double kSight = 4.0;             // m at which curious and scared people notice a robot
constexpr double kForget = 6.0;            // m at which curious ones forget the robots that they have watched
constexpr double kWatchDistance = 1.2;     // m between a curious person and a robot
constexpr double kWatchTime = 10.0;        // s
constexpr double kScaredGap = 1.0;         // m that scared people leave to robots

// The nearest robot at the person's height; null if none is within kForget.
// Of several at the same distance it is the one with the lowest number.
const Disc* NearestRobot(const PeopleView& view, std::size_t i) {
  const Disc* nearest = nullptr;
  double least = kForget;
  std::uint32_t number = 0;
  view.walkers().ForEachNear(view.disc(i).center, view.disc(i).z, kForget, [&](std::uint32_t k) {
    const Disc& disc = view.disc(k);
    if (!disc.is_robot) return;
    const double distance = (disc.center - view.disc(i).center).norm() - disc.radius;
    // The order of visits is that of the cells of the grid: the number decides between equal distances.
    if (distance > least || (distance == least && k > number)) return;
    nearest = &disc;
    least = distance;
    number = k;
  });
  return nearest;
}

// The share of a person in the avoidance of another one; both together make all of it. Halves where they meet from
// opposite sides. Else the one that is before the other, as they look, does less: people look ahead, and leave it to
// those behind them to keep clear. The more they have one way, the more it is so: at a doorway one goes first.
double ShareBeside(const Disc& me, const Disc& other) {
  const Vec2 to = other.center - me.center;
  const double distance = to.norm();
  if (distance == 0.0) return 0.5;
  const double is_ahead = to.dot(me.heading + other.heading) / (2.0 * distance);  // -1: the other is behind, to 1
  return std::clamp(0.5 + (1.0 + kOneWay * std::max(0.0, me.heading.dot(other.heading))) * is_ahead, 0.0, 1.0);
}

}  // namespace

std::optional<Vec2> ReactToRobots(const PeopleView& view, PersonId id, PersonState& person, Vec2& velocity) {
  const PersonDescription& description = view.world().person(id);
  if (description.reaction != PersonReaction::kCurious && description.reaction != PersonReaction::kScared) return {};
  const Disc* const robot = NearestRobot(view, id.index());
  if (robot == nullptr) {
    // It forgets the robots that it has watched.
    person.watch_ticks = 0;
    return {};
  }
  const Vec2 to = robot->center - view.disc(id.index()).center;
  const double distance = to.norm() - robot->radius;
  if (distance > kSight) return {};
  if (description.reaction == PersonReaction::kScared) {
    // From nothing at kSight to the whole speed at a contact, added to the walk to its goal: it still gets there, on a
    // detour.
    velocity -= description.speed * (1.0 - std::max(0.0, distance) / kSight) * Unit(to);
    return {};
  }
  // It has seen enough until it has been away from robots.
  if (person.watch_ticks >= TicksOf(view.world(), kWatchTime)) return {};
  ++person.watch_ticks;
  velocity = distance > kWatchDistance ? Vec2(description.speed * Unit(to)) : Vec2(0.0, 0.0);
  return robot->center;
}

Avoidance::Avoidance(const PeopleView& view)
    : view_(view),
      orca_({kWalkerHorizon, kWallHorizon, view.seconds()}),
      bound_orca_({kBoundHorizon, kWallHorizon, view.seconds()}) {}

Vec2 Avoidance::Velocity(PersonId id, const Vec2& preferred, bool steers) {
  const Disc& me = view_.disc(id.index());
  FindOthers(id, steers);
  FindWalls(id);
  // The gap is added to the radius of the walker, not kept as a constraint of its own: where there is no room for it,
  // ORCA gives the velocity that violates it least, and the bodies still do not meet.
  Walker walker{me.center, me.velocity, preferred, me.radius + kGap, view_.world().person(id).max_speed};
  if (steers) walker.preferred = steering_.Prefer(walker, neighbors_, nearest_);
  return (steers ? orca_ : bound_orca_).Velocity(walker, neighbors_, nearest_);
}

void Avoidance::FindOthers(PersonId id, bool steers) {
  const std::size_t i = id.index();
  const Disc& me = view_.disc(i);
  const PersonReaction reaction = view_.world().person(id).reaction;
  others_.clear();
  objects_.clear();
  // Its square, if it is within reach.
  const auto square_to = [&](const Disc& other) -> std::optional<double> {
    const double reach = kAvoidReach + other.radius;
    const double square = (other.center - me.center).squaredNorm();
    return square < reach * reach ? std::optional(square) : std::nullopt;
  };
  // A search by rings of cells ends as soon as no farther disc could be among the nearest.
  view_.walkers().ForEachNear(
      me.center, me.z, kAvoidReach,
      [&](std::uint32_t k) {
        if (k == i || (view_.disc(k).is_robot && reaction == PersonReaction::kCareless)) return;
        if (const auto square = square_to(view_.disc(k))) AddNearest({*square, k}, kMaxNeighbors, others_);
      },
      [&](double distance) { return others_.size() == kMaxNeighbors && others_.back().square < distance * distance; });
  view_.objects().ForEachNear(me.center, me.z, kAvoidReach, [&](std::uint32_t k) {
    if (const auto square = square_to(view_.disc(k))) objects_.push_back({*square, k});
  });
  neighbors_.clear();
  for (const NearDisc& near : others_) {
    const Disc& other = view_.disc(near.number);
    // A robot keeps its way, so that the person does all of the avoidance.
    const bool avoids = other.pieces == nullptr;
    const bool is_feared = other.is_robot && reaction == PersonReaction::kScared;
    const double radius = other.radius + (is_feared ? kScaredGap : 0.0);
    if (!avoids) {
      neighbors_.push_back({other.center, other.velocity, radius, 1.0});
      continue;
    }
    const double share = steers ? ShareBeside(me, other) : 0.5;
    // It is for the other one to keep clear.
    if (share <= kGoesFirst) continue;
    const bool makes_room = share > 0.5 && other.heading.dot(me.center - other.center) > 0.0 &&
                            other.velocity.squaredNorm() < kPress * kPress;
    neighbors_.push_back(
        {other.center, makes_room ? Vec2(kPress * other.heading) : other.velocity, radius, share, other.heading});
  }
}

void Avoidance::FindWalls(PersonId id) {
  const Disc& me = view_.disc(id.index());
  walls_.clear();
  // By distance, then by number: the order of the walls is an input of ORCA.
  std::sort(objects_.begin(), objects_.end());
  for (const NearDisc& near : objects_) {
    for (const ConvexPiece& piece : *view_.disc(near.number).pieces) AddWalls(piece, me);
  }
  // A wall beyond it cannot be met within the horizon, even at full speed straight to it.
  const double reach = me.radius + kGap + kWallHorizon * view_.world().person(id).max_speed;
  view_.scene().static_index().Query(Rectangle::Around(me.center, reach), pieces_);
  for (const ConvexPiece* piece : pieces_) AddWalls(*piece, me);
  const auto distance_to = [&](const WallSegment& wall) {
    const Vec2 along = wall.b - wall.a;
    const double s = std::clamp((me.center - wall.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (wall.a + s * along - me.center).squaredNorm();
  };
  // The nearest first, as ORCA asks for (orca.h); equal distances keep the order of the list.
  order_.clear();
  for (std::size_t k = 0; k < walls_.size(); ++k) {
    const double square = distance_to(walls_[k]);
    if (square < reach * reach) order_.emplace_back(square, k);
  }
  std::sort(order_.begin(), order_.end());
  nearest_.clear();
  for (const auto& [square, k] : order_) nearest_.push_back(walls_[k]);
}

void Avoidance::AddWalls(const ConvexPiece& piece, const Disc& me) {
  if (!piece.obstacle || !piece.z.Overlaps(me.z)) return;
  for (std::size_t k = 0; k < piece.vertices.size(); ++k) {
    const Vec2& a = piece.vertices[k];
    const Vec2& b = piece.vertices[(k + 1) % piece.vertices.size()];
    // Outlines are counter-clockwise: the person is outside of the sides to whose right it stands, and sees only these
    // sides.
    if (Cross(b - a, me.center - a) < 0.0) walls_.push_back({a, b});
  }
}

}  // namespace troupe
