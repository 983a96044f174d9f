#include "world-service/core/people.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory_resource>
#include <optional>
#include <utility>
#include <vector>

#include "common/crowd/orca.h"
#include "common/spatial/walk_routes.h"
#include "troupe/random.h"
#include "world-service/core/goals_of_people.h"
#include "world-service/core/near_discs.h"

namespace troupe {
namespace {

constexpr std::uint64_t kSwayStream = 0x7377'6179;

constexpr double kAvoidReach = 5.0;         // m: others farther away are not avoided
constexpr std::size_t kMostNeighbors = 12;  // the nearest
constexpr double kWalkerHorizon = 1.5;      // s
constexpr double kWallHorizon = 0.5;        // s
constexpr double kGap = 0.01;               // m that people leave to others and to walls if they can
constexpr double kSway = 0.02;              // of the speed, to all sides: two that are as mirrors of each other pass
constexpr double kSlowDown = 0.5;           // s: so far ahead of its goal a person slows down
constexpr double kTurnRate = 4.0;           // rad/s
constexpr double kStroll = 0.1;             // m/s: slower ones keep their heading
constexpr double kQueueGap = 0.3;           // m between people at one goal
constexpr double kSight = 4.0;              // m at which curious and scared people notice a robot
constexpr double kForget = 6.0;             // m at which curious ones forget the robots that they have watched
constexpr double kWatchDistance = 1.2;      // m between a curious person and a robot
constexpr double kWatchTime = 10.0;         // s
constexpr double kScaredGap = 1.0;          // m that scared people leave to robots
constexpr double kTogether = 1.5;           // m between the people of a group
constexpr double kTooFar = 3.0;             // m at which a leader waits
constexpr double kAllowance = 1e-9;         // m, of rounding
constexpr std::size_t kPeopleClaim = 16;    // people that a thread claims at a time

Vec2 Unit(const Vec2& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec2(v / length) : Vec2(0.0, 0.0);
}

// The memory of a thread for the decisions of people.
struct Deciding {
  explicit Deciding(const OrcaHorizons& horizons) : orca(horizons) {}

  Orca orca;
  std::vector<NearDisc> others;   // people and robots
  std::vector<NearDisc> objects;  // whose sides are walls
  std::vector<WalkerNeighbor> neighbors;
  std::vector<WallSegment> walls;
  std::vector<std::pair<double, std::size_t>> order;  // of the walls, by the square of the distance
  std::vector<WallSegment> nearest;
  NearPieces pieces;
};

class Walks {
 public:
  explicit Walks(StepWorkspace& workspace)
      : workspace_(workspace),
        scene_(workspace.scene),
        world_(workspace.world()),
        routes_(scene_.walk_routes()),
        people_(workspace.next.people),
        plans_(people_.size()) {
    See();
  }

  // The decisions of people `first` to `end`, by any thread.
  void Decide(std::size_t first, std::size_t end, Deciding& deciding) {
    for (std::size_t i = first; i < end; ++i) {
      plans_[i] = people_[i];
      plans_[i].vx = plans_[i].vy = 0.0;
      if (Exists(i) && !is_burdened_[i]) Decide(PersonId(i), deciding, plans_[i]);
    }
  }

  void Move() {
    const std::size_t count = people_.size();
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = (workspace_.next.tick + k) % count;
      if (Exists(i)) Move(PersonId(i), plans_[i]);
    }
  }

 private:
  bool Exists(std::size_t person) const { return !world_.model(world_.people[person].root).removed; }
  double RadiusOf(PersonId person) const {
    return std::max(world_.person(person).radius, scene_.body(scene_.body_of(person)).radius);
  }
  ZRange HeightsOf(PersonId person) const {
    return scene_.body(scene_.body_of(person)).z + people_[person.index()].X_WP.z;
  }

  // Everything that people see: discs of people by id, then of robots and objects.
  void See() {
    for (std::size_t i = 0; i < people_.size(); ++i) {
      const PersonState& person = people_[i];
      discs_.push_back({.center = person.X_WP.translation(),
                        .velocity = {person.vx, person.vy},
                        .radius = RadiusOf(PersonId(i)),
                        .z = Exists(i) ? HeightsOf(PersonId(i)) : ZRange()});
    }
    const WorldState& state = workspace_.next;
    const std::size_t robots = state.robots.size();
    for (std::size_t i = 0; i < robots + state.objects.size(); ++i) {
      const BodyId id(i);
      const Body& body = scene_.body(id);
      if (body.pieces.empty()) continue;
      const Pose& X_WB = workspace_.bodies.X_WB(id);
      Disc disc{.center = X_WB.translation(),
                .radius = body.radius,
                .z = body.z + X_WB.z,
                .is_robot = i < robots,
                .pieces = &workspace_.bodies.pieces_in_world(id)};
      if (disc.is_robot) {
        const Twist& twist = state.robots[i].twist;
        disc.velocity = workspace_.bodies.transform(id).Rotate({twist.vx, twist.vy});
      }
      discs_.push_back(disc);
    }
    walkers_.Fill(discs_, [](const Disc& disc) { return !disc.is_object(); });
    objects_.Fill(discs_, [](const Disc& disc) { return disc.is_object(); });
    is_burdened_.assign(people_.size(), false);
    for (const ObjectState& object : state.objects) {
      const std::optional<PersonId> under = object.support ? scene_.person_of(*object.support) : std::nullopt;
      if (under) is_burdened_[under->index()] = true;
    }
    // How far the last of each group is behind its leader.
    behind_.assign(people_.size(), 0.0);
    for (std::size_t i = 0; i < people_.size(); ++i) {
      const std::optional<PersonId>& leader = world_.people[i].leader;
      if (!leader || !Exists(i)) continue;
      const double distance = (discs_[i].center - discs_[leader->index()].center).norm();
      behind_[leader->index()] = std::max(behind_[leader->index()], distance);
    }
  }

  // True where another one that waits for the same point is beside it: the point itself may be taken.
  bool IsInQueue(std::size_t i, const Vec2& target) const {
    bool found = false;
    const PersonState& mine = people_[i];
    const double distance = (target - discs_[i].center).norm();
    walkers_.ForEachNear(discs_[i].center, discs_[i].z, discs_[i].radius + kQueueGap, [&](std::uint32_t k) {
      if (k >= people_.size() || k == i) return;
      const PersonState& other = people_[k];
      if (other.goals != mine.goals || other.goal != mine.goal || other.waits == 0) return;
      const double gap = (discs_[k].center - discs_[i].center).norm() - discs_[k].radius - discs_[i].radius;
      found = found || (gap <= kQueueGap && (target - discs_[k].center).norm() < distance);
    });
    return found;
  }

  // The velocity that the person would have alone.
  Vec2 Walk(PersonId id, PersonState& person) {
    const std::size_t i = id.index();
    const PersonDescription& description = world_.person(id);
    const Vec2& here = discs_[i].center;
    // With whom it walks; itself without a leader.
    const std::size_t leader =
        description.leader && Exists(description.leader->index()) ? description.leader->index() : i;
    const bool follows = leader != i;
    if (follows) {
      const PersonState& first = people_[leader];
      person.goals = first.goals;
      person.goal = first.goal;
      person.choices = first.choices;
      person.waits = first.waits;
    } else {
      const bool ends_waiting = person.choices > 0 && person.waits > 0 && --person.waits == 0;
      if (person.choices == 0 || ends_waiting) ChooseGoal(world_, id, person);
    }
    Vec2 velocity(0.0, 0.0);
    const GoalSet& set = world_.goal_sets[person.goals];
    if (person.waits == 0 && person.choices > 0) {
      if (set.points.empty()) {
        if (!follows) ArriveAtGoal(world_, id, person);
      } else if (const std::optional<Vec2> target = routes_.Target(id, person.goals, person.goal)) {
        const double distance = (*target - here).norm();
        if (distance <= set.reach || (distance <= kAvoidReach && IsInQueue(i, *target))) {
          if (!follows) ArriveAtGoal(world_, id, person);
        } else if (const std::optional<Vec2> next = routes_.NextPoint(id, person.goals, person.goal, here)) {
          velocity =
              description.speed * std::min(1.0, distance / (kSlowDown * description.speed + 1e-9)) * Unit(*next - here);
        } else if (!follows) {
          ChooseGoal(world_, id, person);  // no way leads there
        }
      } else if (!follows) {
        ChooseGoal(world_, id, person);
      }
    }
    if (follows) {
      const Vec2 to_leader = discs_[leader].center - here;
      const double distance = to_leader.norm();
      if (person.waits > 0) velocity = Vec2(0.0, 0.0);
      if (distance > kTogether) velocity += std::min(description.speed, distance - kTogether) * Unit(to_leader);
    } else if (behind_[i] > kTooFar) {
      velocity *= 0.3;
    }
    return velocity;
  }

  // The nearest robot at the person's height; null if none is within kForget.
  const Disc* NearestRobot(std::size_t i) const {
    const Disc* nearest = nullptr;
    double least = kForget;
    std::uint32_t number = 0;
    walkers_.ForEachNear(discs_[i].center, discs_[i].z, kForget, [&](std::uint32_t k) {
      const Disc& disc = discs_[k];
      if (!disc.is_robot) return;
      const double distance = (disc.center - discs_[i].center).norm() - disc.radius;
      if (distance > least || (distance == least && k > number)) return;
      nearest = &disc;
      least = distance;
      number = k;
    });
    return nearest;
  }

  // Changes the velocity by the person's reaction to robots; a point that it looks at, if there is one.
  std::optional<Vec2> React(PersonId id, PersonState& person, Vec2& velocity) const {
    const PersonDescription& description = world_.person(id);
    if (description.reaction != PersonReaction::kCurious && description.reaction != PersonReaction::kScared) return {};
    const Disc* const robot = NearestRobot(id.index());
    if (robot == nullptr) {
      person.watched = 0;
      return {};
    }
    const Vec2 to = robot->center - discs_[id.index()].center;
    const double distance = to.norm() - robot->radius;
    if (distance > kSight) return {};
    if (description.reaction == PersonReaction::kScared) {
      velocity -= description.speed * (1.0 - std::max(0.0, distance) / kSight) * Unit(to);
      return {};
    }
    if (person.watched >= TicksOf(world_, kWatchTime)) return {};
    ++person.watched;
    velocity = distance > kWatchDistance ? Vec2(description.speed * Unit(to)) : Vec2(0.0, 0.0);
    return robot->center;
  }

  // Avoidance.

  Vec2 Avoid(PersonId id, const Vec2& preferred, Deciding& deciding) {
    const std::size_t i = id.index();
    const PersonDescription& description = world_.person(id);
    const Disc& me = discs_[i];
    Walker walker{me.center, me.velocity, preferred, me.radius + kGap, description.max_speed};
    std::vector<NearDisc>& others = deciding.others;
    std::vector<NearDisc>& objects = deciding.objects;
    std::vector<WallSegment>& walls = deciding.walls;
    others.clear();
    objects.clear();
    // Its square, if it is within reach.
    const auto square_to = [&](const Disc& other) -> std::optional<double> {
      const double reach = kAvoidReach + other.radius;
      const double square = (other.center - me.center).squaredNorm();
      return square < reach * reach ? std::optional(square) : std::nullopt;
    };
    walkers_.ForEachNear(
        me.center, me.z, kAvoidReach,
        [&](std::uint32_t k) {
          if (k == i || (discs_[k].is_robot && description.reaction == PersonReaction::kCareless)) return;
          if (const auto square = square_to(discs_[k])) AddNearest({*square, k}, kMostNeighbors, others);
        },
        [&](double distance) { return others.size() == kMostNeighbors && others.back().square < distance * distance; });
    objects_.ForEachNear(me.center, me.z, kAvoidReach, [&](std::uint32_t k) {
      if (const auto square = square_to(discs_[k])) objects.push_back({*square, k});
    });
    deciding.neighbors.clear();
    for (const NearDisc& near : others) {
      const Disc& other = discs_[near.number];
      const bool avoids = other.pieces == nullptr;
      const bool is_feared = other.is_robot && description.reaction == PersonReaction::kScared;
      deciding.neighbors.push_back(
          {other.center, other.velocity, other.radius + (is_feared ? kScaredGap : 0.0), avoids ? 0.5 : 1.0});
    }
    walls.clear();
    std::sort(objects.begin(), objects.end());
    for (const NearDisc& near : objects) {
      for (const ConvexPiece& piece : *discs_[near.number].pieces) AddWalls(piece, me, walls);
    }
    const double reach = me.radius + kGap + kWallHorizon * description.max_speed;
    scene_.static_index().Query(Rectangle::Around(me.center, reach), deciding.pieces);
    for (const ConvexPiece* piece : deciding.pieces) AddWalls(*piece, me, walls);
    const auto distance_to = [&](const WallSegment& wall) {
      const Vec2 along = wall.b - wall.a;
      const double s = std::clamp((me.center - wall.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
      return (wall.a + s * along - me.center).squaredNorm();
    };
    deciding.order.clear();
    for (std::size_t k = 0; k < walls.size(); ++k) {
      const double square = distance_to(walls[k]);
      if (square < reach * reach) deciding.order.emplace_back(square, k);
    }
    std::sort(deciding.order.begin(), deciding.order.end());
    deciding.nearest.clear();
    for (const auto& [square, k] : deciding.order) deciding.nearest.push_back(walls[k]);
    return deciding.orca.Velocity(walker, deciding.neighbors, deciding.nearest);
  }

  // The sides of a piece that the person sees.
  static void AddWalls(const ConvexPiece& piece, const Disc& me, std::vector<WallSegment>& walls) {
    if (!piece.obstacle || !piece.z.Overlaps(me.z)) return;
    for (std::size_t k = 0; k < piece.vertices.size(); ++k) {
      const Vec2& a = piece.vertices[k];
      const Vec2& b = piece.vertices[(k + 1) % piece.vertices.size()];
      if (Cross(b - a, me.center - a) < 0.0) walls.push_back({a, b});
    }
  }

  void Decide(PersonId id, Deciding& deciding, PersonState& person) {
    Vec2 preferred = Walk(id, person);
    const std::optional<Vec2> look_at = React(id, person, preferred);
    if (preferred.x() != 0.0 || preferred.y() != 0.0) {
      const Tick tick = workspace_.next.tick;
      const double size = 2.0 * kSway * world_.person(id).speed;
      preferred += size * Vec2(RandomUniform({world_.seed, kSwayStream, id.index(), tick, 0}) - 0.5,
                               RandomUniform({world_.seed, kSwayStream, id.index(), tick, 1}) - 0.5);
    }
    const Vec2 velocity = Avoid(id, preferred, deciding);
    person.vx = velocity.x();
    person.vy = velocity.y();
    const Vec2 ahead = look_at ? Vec2(*look_at - discs_[id.index()].center) : velocity;
    if (!look_at && ahead.squaredNorm() < kStroll * kStroll) return;
    const double most = kTurnRate * world_.interval_seconds();
    const double turn = WrapAngle(Atan2(ahead.y(), ahead.x()) - person.X_WP.heading);
    person.X_WP.heading = WrapAngle(person.X_WP.heading + std::clamp(turn, -most, most));
  }

  // Moves.

  enum class Room : std::uint8_t { kFree, kTaken, kTight };

  // Whether the person's cylinder is free from `from` to `to`. Tight: others are inside it already, at `from`.
  Room RoomOn(PersonId id, const Vec2& from, const Vec2& to) {
    const std::size_t i = id.index();
    const double radius = discs_[i].radius;
    const ZRange z = discs_[i].z;
    Rectangle box = Rectangle::Nothing();
    box.Extend(from);
    box.Extend(to);
    box = box.Inflated(radius);
    const Vec2 way[2] = {from, to};
    const std::span<const Vec2> path(way, from == to ? 1 : 2);
    Room room = Room::kFree;
    const auto consider = [&](std::span<const Vec2> outline, double distance) {
      if (FindNearestPoints(path, outline).distance >= distance - kAllowance) return;
      const bool is_inside = FindNearestPoints(path.first(1), outline).distance < distance - kAllowance;
      room = is_inside ? Room::kTight : std::max(room, Room::kTaken);
    };
    const auto consider_piece = [&](const ConvexPiece& piece) {
      if (piece.obstacle && piece.z.Overlaps(z)) consider(piece.vertices, radius);
    };
    scene_.static_index().Query(box, static_pieces_);
    for (const ConvexPiece* piece : static_pieces_) consider_piece(*piece);
    bodies_.clear();
    workspace_.bodies.Query(box, bodies_);
    const BodyId first_person = scene_.body_of(PersonId(0));
    for (const BodyId body : bodies_) {
      if (body == scene_.body_of(id)) continue;
      if (body < first_person) {
        for (const ConvexPiece& piece : workspace_.bodies.pieces_in_world(body)) consider_piece(piece);
        continue;
      }
      const std::size_t other = body.index() - first_person.index();
      if (!discs_[other].z.Overlaps(z)) continue;
      const Vec2 center = people_[other].X_WP.translation();
      consider(std::span(&center, 1), radius + discs_[other].radius);
    }
    return room;
  }

  void Move(PersonId id, const PersonState& plan) {
    PersonState& person = people_[id.index()];
    const Pose before = person.X_WP;
    const Vec2 from = before.translation();
    const double seconds = workspace_.seconds();
    const Vec2 velocity(plan.vx, plan.vy);
    person = plan;
    const bool stays = plan.vx == 0.0 && plan.vy == 0.0 && plan.X_WP.heading == before.heading;
    if (stays) return workspace_.bodies.Move(scene_.body_of(id), person.X_WP);
    for (const double part : {1.0, 0.5, 0.25, 0.0}) {
      const Vec2 to = from + part * seconds * velocity;
      const Room room = RoomOn(id, from, to);
      if (room == Room::kTaken) continue;
      person.X_WP.x = to.x();
      person.X_WP.y = to.y();
      if (room == Room::kTight) {
        // Another body is closer than the cylinder, but not in the body itself: exactly, and without turning.
        person.X_WP.heading = before.heading;
        if (!IsFree(id, before, part * velocity)) continue;
      }
      person.vx = part * plan.vx;
      person.vy = part * plan.vy;
      break;
    }
    workspace_.bodies.Move(scene_.body_of(id), person.X_WP);
  }

  // True at rest.
  bool IsFree(PersonId id, const Pose& X_WP, const Vec2& velocity) const {
    const BodyId body = scene_.body_of(id);
    const Vec2 in_P = Transform2(X_WP).InverseRotate(velocity);
    const Motion motion{.X_WF = X_WP, .twist = {in_P.x(), in_P.y(), 0.0}, .duration = workspace_.seconds()};
    if (motion.IsRest()) return true;
    return !FirstContact(scene_, workspace_.bodies, MoverOf(scene_, body), motion);
  }

  StepWorkspace& workspace_;
  const Scene& scene_;
  const WorldDescription& world_;
  const WalkRoutes& routes_;
  std::vector<PersonState>& people_;  // before the tick until Move
  std::vector<PersonState> plans_;
  std::vector<Disc> discs_;
  NearDiscs walkers_;  // people and robots
  NearDiscs objects_;
  std::vector<bool> is_burdened_;  // by person, like the next
  std::vector<double> behind_;
  NearPieces static_pieces_;  // memory of RoomOn
  std::pmr::vector<BodyId> bodies_;
};

}  // namespace

void MovePeople(StepWorkspace& workspace, ThreadPool* pool) {
  const std::size_t count = workspace.next.people.size();
  if (count == 0) return;
  Walks walks(workspace);
  const OrcaHorizons horizons{kWalkerHorizon, kWallHorizon, workspace.seconds()};
  std::atomic<std::size_t> next = 0;  // the first person that no thread has claimed
  const auto decide = [&](std::size_t) {
    Deciding deciding(horizons);
    for (std::size_t first = next.fetch_add(kPeopleClaim); first < count; first = next.fetch_add(kPeopleClaim)) {
      walks.Decide(first, std::min(first + kPeopleClaim, count), deciding);
    }
  };
  if (pool != nullptr) {
    pool->Run(pool->size(), decide);
  } else {
    decide(0);
  }
  walks.Move();
}

}  // namespace troupe
