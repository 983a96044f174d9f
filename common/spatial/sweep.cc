#include "common/spatial/sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
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

struct Motion {
  Pose X_WR;  // at the start
  Twist twist;
  double duration = 0.0;  // s

  // As Step sets it, to the last bit.
  Pose After(double seconds) const { return seconds > 0.0 ? X_WR * Integrate(twist, seconds) : X_WR; }
  double speed() const { return std::sqrt(twist.vx * twist.vx + twist.vy * twist.vy); }
  // No point within `radius` of R's origin is faster; m/s.
  double MaxSpeed(double radius) const { return speed() + std::abs(twist.wz) * radius; }
};

double RadiusOf(std::span<const Vec2> vertices) {
  double square = 0.0;
  for (const Vec2& vertex : vertices) square = std::max(square, vertex.squaredNorm());
  return std::sqrt(square);
}

// A polygon of the moving body, a standing one, and how deep they may overlap on the way.
struct Pair {
  std::span<const Vec2> a_in_R;
  std::span<const Vec2> b_in_W;
  double initial_depth = 0.0;  // m

  double allowed_depth() const { return std::max(kTouchTolerance, initial_depth); }
};

// Sweeps pairs of polygons, all along one motion.
class PairSweep {
 public:
  explicit PairSweep(const Motion& motion) : motion_(motion), transform_WR_(motion.X_WR) {}

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

 private:
  double DepthAfter(const Pair& pair, double seconds) {
    const Transform2 transform(motion_.After(seconds));
    a_in_W_.clear();
    for (const Vec2& vertex : pair.a_in_R) a_in_W_.push_back(transform * vertex);
    return PenetrationDepth(a_in_W_, pair.b_in_W);
  }

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
    b_in_R_.clear();
    for (const Vec2& vertex : pair.b_in_W) b_in_R_.push_back(transform_WR_.InverseTransform(vertex));
    AppendEvents(pair.a_in_R, b_in_R_, motion_.twist, end, times_);
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
  const Transform2 transform_WR_;
  std::vector<double> times_;
  std::vector<Vec2> a_in_W_;
  std::vector<Vec2> b_in_R_;
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
      : chord{motion.X_WR.translation(), motion.After(motion.duration).translation()} {
    // An arc of angle w and length s leaves its chord by at most s w / 8, and its start by no more than the diameter.
    const double angle = std::abs(motion.twist.wz) * motion.duration;
    const double length = motion.speed() * motion.duration;
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

// Everything that the body may meet on its way.
std::vector<Obstacle> FindObstacles(const Scene& scene, const RobotIndex& robots, RobotId robot, const Motion& motion) {
  const RobotBody& body = scene.body(robot);
  const Corridor corridor(motion);
  const double radius = body.radius * (1.0 + 1e-9) + 1e-9;
  const ZRange z = body.z + motion.X_WR.z;
  const Rectangle box = corridor.BoxAround(radius);

  std::vector<Obstacle> obstacles;
  const auto consider = [&](const ConvexPiece& piece) {
    if (!piece.obstacle || !piece.z.Overlaps(z)) return;
    const Rectangle piece_box = BoundingBox(piece.vertices);
    if (box.Overlaps(piece_box) && corridor.MayReach(piece, radius)) obstacles.push_back({&piece, piece_box});
  };
  std::vector<std::uint32_t> standing;
  scene.static_index().Query(box, standing);
  for (std::uint32_t index : standing) consider(scene.static_index().pieces()[index]);

  std::vector<RobotId> near;
  robots.Query(box, near);
  for (RobotId other : near) {
    if (other == robot) continue;
    for (const ConvexPiece& piece : robots.pieces_in_world(other)) consider(piece);
  }
  return obstacles;
}

}  // namespace

std::optional<double> TimeOfContact(std::span<const Vec2> a_in_R, const Pose& X_WR, const Twist& twist, double duration,
                                    std::span<const Vec2> b_in_W) {
  if (twist.IsZero() || !(duration > 0.0)) return std::nullopt;
  const Motion motion{X_WR, twist, duration};
  const Transform2 transform(X_WR);
  std::vector<Vec2> a_in_W;
  for (const Vec2& vertex : a_in_R) a_in_W.push_back(transform * vertex);
  const Pair pair{a_in_R, b_in_W, PenetrationDepth(a_in_W, b_in_W)};
  PairSweep sweep(motion);
  const std::optional<double> time = sweep.Find(pair);
  if (!time) return std::nullopt;
  return SteppedBack(*time, motion.MaxSpeed(RadiusOf(a_in_R)), [&](double t) { return sweep.IsFree(pair, t); });
}

std::optional<Contact> FirstContact(const Scene& scene, const RobotIndex& robots, RobotId robot, const Pose& X_WR,
                                    const Twist& twist, double duration) {
  if (twist.IsZero() || !(duration > 0.0)) return std::nullopt;
  const RobotBody& body = scene.body(robot);
  for (const ConvexPiece& piece : body.pieces) {
    if (piece.obstacle && piece.z.min + X_WR.z < -kTouchTolerance) return Contact{.time = 0.0, .other = std::nullopt};
  }
  const Motion motion{X_WR, twist, duration};
  const std::vector<Obstacle> obstacles = FindObstacles(scene, robots, robot, motion);
  if (obstacles.empty()) return std::nullopt;

  std::optional<Contact> first;
  std::vector<Pair> pairs;  // all that come near each other
  PairSweep sweep(motion);
  for (const ConvexPiece& mine : body.pieces) {
    if (!mine.obstacle) continue;
    const ConvexPiece mine_in_W = Transformed(mine, X_WR);
    const double max_speed = motion.MaxSpeed(RadiusOf(mine.vertices));
    const Rectangle box = BoundingBox(mine_in_W.vertices).Inflated(max_speed * duration + kTouchTolerance);
    for (const Obstacle& other : obstacles) {
      if (!box.Overlaps(other.box) || !mine_in_W.z.Overlaps(other.piece->z)) continue;
      const Pair pair{mine.vertices, other.piece->vertices,
                      PenetrationDepth(mine_in_W.vertices, other.piece->vertices)};
      const double gap = -pair.initial_depth - kTouchTolerance;
      if (gap > max_speed * (first ? first->time : duration)) continue;
      pairs.push_back(pair);
      const std::optional<double> time = sweep.Find(pair);
      if (!time) continue;
      if (!first || *time < first->time || (*time == first->time && other.piece->model < first->other)) {
        first = Contact{*time, other.piece->model};
      }
    }
  }
  if (first) {
    // Rounding may leave the contact's pose a little too deep, in this pair or in another.
    first->time = SteppedBack(first->time, motion.MaxSpeed(body.radius), [&](double time) {
      return std::all_of(pairs.begin(), pairs.end(), [&](const Pair& pair) { return sweep.IsFree(pair, time); });
    });
  }
  return first;
}

}  // namespace troupe
