#include "common/spatial/sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "common/base/deterministic_math.h"
#include "common/geometry/rectangle.h"
#include "common/spatial/overlap.h"
#include "common/spatial/sweep_events.h"

namespace troupe {
namespace {

// An event at which the depth is further than this from what is allowed does not mark the contact; then it is searched
// for.
constexpr double kEventAccuracy = 1e-7;  // m

// Of F's origin in the plane, m/s.
double SpeedOf(const Motion& motion) {
  return std::sqrt(motion.twist.vx * motion.twist.vx + motion.twist.vy * motion.twist.vy);
}

// No point within `radius` of F's origin is faster in the plane; m/s.
double MaxSpeed(const Motion& motion, double radius) {
  return SpeedOf(motion) + std::abs(motion.twist.wz) * radius;
}

double RadiusOf(std::span<const Vec2> vertices) {
  double square = 0.0;
  for (const Vec2& vertex : vertices) square = std::max(square, vertex.squaredNorm());
  return std::sqrt(square);
}

// A prism of the moving body, a standing one, and how deep they may overlap on the way.
struct Pair {
  std::span<const Vec2> a_in_F;
  std::span<const Vec2> b_in_W;
  ZRange a_z;  // at the start, in W
  ZRange b_z;
  double initial_depth = 0.0;  // m

  double allowed_depth() const { return std::max(kTouchTolerance, initial_depth); }
};

// Sweeps pairs of polygons, all along one motion.
class PairSweep {
 public:
  explicit PairSweep(const Motion& motion) : motion_(motion), transform_WF_(motion.X_WF) {}

  // The first time at which the pair overlaps too deeply.
  std::optional<double> Find(const Pair& pair) {
    FindTimes(pair);
    for (std::size_t i = 0; i + 1 < times_.size(); ++i) {
      if (times_[i + 1] <= times_[i]) continue;
      const double middle = 0.5 * (times_[i] + times_[i + 1]);
      if (!IsFree(pair, middle)) return Refined(pair, times_[i], middle);
    }
    if (!IsFree(pair, motion_.duration)) return Refined(pair, times_[times_.size() - 2], motion_.duration);
    return std::nullopt;
  }

  bool IsFree(const Pair& pair, double seconds) { return DepthAfter(pair, seconds) <= pair.allowed_depth(); }

  // How far the first prism is in the second one: in the plane, and when heights change, whichever way out is shorter.
  double DepthAfter(const Pair& pair, double seconds) {
    const Transform2 transform(motion_.After(seconds));
    a_in_W_.clear();
    for (const Vec2& vertex : pair.a_in_F) a_in_W_.push_back(transform * vertex);
    const double depth = PenetrationDepth(a_in_W_, pair.b_in_W);
    if (motion_.climb == 0.0) return depth;
    const ZRange a_z = pair.a_z + motion_.climb * seconds;
    return std::min(depth, std::min(a_z.max, pair.b_z.max) - std::max(a_z.min, pair.b_z.min));
  }

 private:
  // Fills times_: the start, the events in order, the end.
  void FindTimes(const Pair& pair) {
    double end = motion_.duration;
    const double rate = std::abs(motion_.twist.wz);
    if (rate * end > 2.0 * kPi) end = 2.0 * kPi / rate;  // from then on the motion repeats itself
    times_ = {0.0, end};
    if (pair.initial_depth > kTouchTolerance) {
      // Getting deeper than at the start is not an event, so look more often.
      for (int i = 1; i < 16; ++i) times_.push_back(end * i / 16.0);
    }
    if (motion_.climb != 0.0) {
      end = motion_.duration;  // heights do not repeat themselves
      times_[1] = end;
      for (double dz : {pair.b_z.min - pair.a_z.max, pair.b_z.max - pair.a_z.min}) {
        const double time = dz / motion_.climb;
        if (time > 0.0 && time < end) times_.push_back(time);
      }
    }
    if (!motion_.twist.IsZero()) {
      b_in_F_.clear();
      for (const Vec2& vertex : pair.b_in_W) b_in_F_.push_back(transform_WF_.InverseTransform(vertex));
      AppendEvents(pair.a_in_F, b_in_F_, motion_.twist, end, times_);
    }
    std::sort(times_.begin(), times_.end());
  }

  // The last free time before `bad`: `good`, unless the overlap begins later than at that event.
  double Refined(const Pair& pair, double good, double bad) {
    const double close = pair.allowed_depth() - kEventAccuracy;
    double depth = DepthAfter(pair, good);
    for (int i = 0; i < 60 && depth < close; ++i) {
      const double middle = 0.5 * (good + bad);
      const double middle_depth = DepthAfter(pair, middle);
      if (middle_depth > pair.allowed_depth()) {
        bad = middle;
      } else {
        good = middle;
        depth = middle_depth;
      }
    }
    return good;
  }

  const Motion motion_;
  const Transform2 transform_WF_;
  std::vector<double> times_;
  std::vector<Vec2> a_in_W_;
  std::vector<Vec2> b_in_F_;
};

// `time`, or as little before it as makes is_free(time) true; 0 at the earliest. max_speed in m/s.
template <typename IsFree>
double SteppedBack(double time, double max_speed, IsFree is_free) {
  double hair = std::max(1e-12 / max_speed, time * 0x1p-50);
  while (time > 0.0 && !is_free(time)) {
    time = std::max(0.0, time - hair);
    hair *= 2.0;
  }
  return time;
}

// Where R's origin may come along during the motion: within `margin` of the straight line from start to end.
struct Corridor {
  std::array<Vec2, 2> chord;  // in W
  double margin;              // m

  explicit Corridor(const Motion& motion)
      : chord{motion.X_WF.translation(), motion.After(motion.duration).translation()} {
    // An arc of angle w and length s leaves its chord by at most s w / 8, and its start by no more than the diameter.
    const double angle = std::abs(motion.twist.wz) * motion.duration;
    const double length = SpeedOf(motion) * motion.duration;
    margin = std::min(length * angle / 8.0, length) + 1e-9;
    if (angle > kPi) {
      chord[1] = chord[0];
      margin = 2.0 * length / angle + 1e-9;
    }
  }

  Rectangle BoxAround(double radius) const {
    Rectangle box = Rectangle::Nothing();
    for (const Vec2& end : chord) box.Extend(end);
    return box.Inflated(margin + radius);
  }
  bool MayReach(const ConvexPiece& piece, double radius) const {
    return -PenetrationDepth(chord, piece.vertices) <= margin + radius;
  }
};

struct Obstacle {
  const ConvexPiece* piece;
  Rectangle box;
};

// Heights that a mover passes.
ZRange SweptHeights(const ZRange& z_in_F, const Motion& motion) {
  const ZRange z = z_in_F + motion.X_WF.z;
  const double dz = motion.climb * motion.duration;
  return {z.min + std::min(dz, 0.0), z.max + std::max(dz, 0.0)};
}

// What of all that stands around the mover may meet on its way.
class ObstacleFilter {
 public:
  ObstacleFilter(const Mover& mover, const Motion& motion)
      : corridor_(motion),
        radius_(mover.radius * (1.0 + 1e-9) + 1e-9),
        z_(SweptHeights(mover.z, motion)),
        box_(corridor_.BoxAround(radius_)) {}

  const Rectangle& box() const { return box_; }

  void Consider(const ConvexPiece& piece, std::vector<Obstacle>& obstacles) const {
    if (!piece.obstacle || !piece.z.Overlaps(z_)) return;
    const Rectangle piece_box = BoundingBox(piece.vertices);
    if (box_.Overlaps(piece_box) && corridor_.MayReach(piece, radius_)) obstacles.push_back({&piece, piece_box});
  }

 private:
  Corridor corridor_;
  double radius_;
  ZRange z_;
  Rectangle box_;
};

std::vector<Obstacle> FindObstacles(const Scene& scene, const BodyIndex& bodies, const Mover& mover,
                                    const Motion& motion) {
  const ObstacleFilter filter(mover, motion);
  std::vector<Obstacle> obstacles;
  std::vector<std::uint32_t> standing;
  scene.static_index().Query(filter.box(), standing);
  for (std::uint32_t index : standing) filter.Consider(scene.static_index().pieces()[index], obstacles);

  std::vector<BodyId> near;
  bodies.Query(filter.box(), near);
  for (BodyId other : near) {
    if (std::binary_search(mover.bodies.begin(), mover.bodies.end(), other)) continue;
    for (const ConvexPiece& piece : bodies.pieces_in_world(other)) filter.Consider(piece, obstacles);
  }
  return obstacles;
}

std::optional<Contact> FirstOf(std::optional<Contact> a, const std::optional<Contact>& b) {
  if (!a || (b && std::tie(b->time, b->other, b->mine) < std::tie(a->time, a->other, a->mine))) return b ? b : a;
  return a;
}

// The first of the mover's pieces to reach the ground.
std::optional<Contact> GroundContact(const Mover& mover, const Motion& motion) {
  if (motion.climb > 0.0) return std::nullopt;
  std::optional<Contact> first;
  for (const ConvexPiece& piece : mover.pieces) {
    if (!piece.obstacle) continue;
    const double height = piece.z.min + motion.X_WF.z;
    if (height < -kTouchTolerance) {
      first = FirstOf(first, Contact{0.0, piece.model, std::nullopt});
    } else if (height + motion.climb * motion.duration < -kTouchTolerance) {
      first = FirstOf(first, Contact{std::max(height, 0.0) / -motion.climb, piece.model, std::nullopt});
    }
  }
  return first;
}

// The first contact of the mover with any of the obstacles.
std::optional<Contact> MeetObstacles(const Mover& mover, const Motion& motion, const std::vector<Obstacle>& obstacles) {
  std::optional<Contact> first;
  std::vector<Pair> pairs;  // all that come near each other
  PairSweep sweep(motion);
  for (const ConvexPiece& mine : mover.pieces) {
    if (!mine.obstacle) continue;
    const ConvexPiece mine_in_W = Transformed(mine, motion.X_WF);
    const ZRange swept = SweptHeights(mine.z, motion);
    const double max_speed = MaxSpeed(motion, RadiusOf(mine.vertices));
    const Rectangle box = BoundingBox(mine_in_W.vertices).Inflated(max_speed * motion.duration + kTouchTolerance);
    for (const Obstacle& other : obstacles) {
      if (!box.Overlaps(other.box) || !swept.Overlaps(other.piece->z)) continue;
      Pair pair{mine.vertices, other.piece->vertices, mine_in_W.z, other.piece->z,
                PenetrationDepth(mine_in_W.vertices, other.piece->vertices)};
      const double gap = -pair.initial_depth - kTouchTolerance;
      if (gap > max_speed * (first ? first->time : motion.duration)) continue;
      if (motion.climb != 0.0) pair.initial_depth = sweep.DepthAfter(pair, 0.0);
      pairs.push_back(pair);
      const std::optional<double> time = sweep.Find(pair);
      if (time) first = FirstOf(first, Contact{*time, mine.model, other.piece->model});
    }
  }
  if (first) {
    // Rounding may leave the contact's pose a little too deep, in this pair or in another.
    const double max_speed = MaxSpeed(motion, mover.radius) + std::abs(motion.climb);
    first->time = SteppedBack(first->time, max_speed, [&](double time) {
      return std::all_of(pairs.begin(), pairs.end(), [&](const Pair& pair) { return sweep.IsFree(pair, time); });
    });
  }
  return first;
}

}  // namespace

Pose Motion::After(double seconds) const {
  if (!(seconds > 0.0)) return X_WF;
  Pose X_WF_then = twist.IsZero() ? X_WF : X_WF * Integrate(twist, seconds);
  if (climb != 0.0) X_WF_then.z = X_WF.z + climb * seconds;
  return X_WF_then;
}

std::optional<double> TimeOfContact(std::span<const Vec2> a_in_R, const Pose& X_WR, const Twist& twist, double duration,
                                    std::span<const Vec2> b_in_W) {
  const Motion motion{X_WR, twist, 0.0, duration};
  if (motion.IsRest()) return std::nullopt;
  const Transform2 transform(X_WR);
  std::vector<Vec2> a_in_W;
  for (const Vec2& vertex : a_in_R) a_in_W.push_back(transform * vertex);
  const Pair pair{a_in_R, b_in_W, {}, {}, PenetrationDepth(a_in_W, b_in_W)};
  PairSweep sweep(motion);
  const std::optional<double> time = sweep.Find(pair);
  if (!time) return std::nullopt;
  return SteppedBack(*time, MaxSpeed(motion, RadiusOf(a_in_R)), [&](double t) { return sweep.IsFree(pair, t); });
}

std::optional<Contact> FirstContact(const Scene& scene, const BodyIndex& bodies, const Mover& mover,
                                    const Motion& motion) {
  if (motion.IsRest()) return std::nullopt;
  const std::optional<Contact> ground = GroundContact(mover, motion);
  if (ground && ground->time == 0.0) return ground;
  const std::vector<Obstacle> obstacles = FindObstacles(scene, bodies, mover, motion);
  if (obstacles.empty()) return ground;
  return FirstOf(MeetObstacles(mover, motion, obstacles), ground);
}

std::optional<Contact> FirstContactWith(std::span<const ConvexPiece> standing, const Mover& mover,
                                        const Motion& motion) {
  if (motion.IsRest()) return std::nullopt;
  const ObstacleFilter filter(mover, motion);
  std::vector<Obstacle> obstacles;
  for (const ConvexPiece& piece : standing) filter.Consider(piece, obstacles);
  return MeetObstacles(mover, motion, obstacles);
}

}  // namespace troupe
