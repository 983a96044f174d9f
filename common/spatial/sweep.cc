#include "common/spatial/sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory_resource>
#include <tuple>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/sweep_events.h"
#include "troupe/deterministic_math.h"
#include "troupe/rectangle.h"

namespace troupe {
namespace {

// An event at which the depth differs from the allowed one by more than this does not mark the contact, which is then
// searched for.
constexpr double kEventAccuracy = 1e-7;  // m

// No point within `radius` of F's origin is faster in the plane; m/s.
double MaxSpeed(const Motion& motion, double radius) {
  const double origin = std::sqrt(motion.twist.vx * motion.twist.vx + motion.twist.vy * motion.twist.vy);
  return origin + std::abs(motion.twist.wz) * radius;
}

double RadiusOf(std::span<const Vec2> vertices) {
  double square = 0.0;
  for (const Vec2& vertex : vertices) square = std::max(square, vertex.squaredNorm());
  return std::sqrt(square);
}

// A prism of the moving body, a static one, and the depth to which they overlap at the start.
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
  PairSweep(const Motion& motion, const Transform2& transform_WF, std::pmr::memory_resource& memory)
      : motion_(motion), transform_WF_(transform_WF), times_(&memory), a_in_W_(&memory), b_in_F_(&memory) {}

  // The first time at which the pair overlaps too deeply.
  // Times are sorted; the pose at a time may be anywhere within an interval, so that its middle is as good as any.
  std::optional<double> Find(const Pair& pair) {
    FindTimes(pair);
    for (std::size_t i = 0; i + 1 < times_.size(); ++i) {
      if (times_[i + 1] <= times_[i]) continue;
      const double middle = 0.5 * (times_[i] + times_[i + 1]);
      if (!IsFree(pair, middle)) return Refined(pair, times_[i], middle);
    }
    // The end itself, which may be the last event.
    if (!IsFree(pair, motion_.duration)) return Refined(pair, times_[times_.size() - 2], motion_.duration);
    return std::nullopt;
  }

  bool IsFree(const Pair& pair, double seconds) {
    // Apart in height: the footprints may overlap.
    if (motion_.climb != 0.0 && HeightsAfter(pair, seconds) <= pair.allowed_depth()) return true;
    Place(pair, seconds);
    return !OverlapBy(a_in_W_, pair.b_in_W, pair.allowed_depth());
  }

  // The depth of the first prism in the second one: in the plane, or, if heights change, along the shorter way out.
  double DepthAfter(const Pair& pair, double seconds) {
    Place(pair, seconds);
    const double depth = PenetrationDepth(a_in_W_, pair.b_in_W);
    return motion_.climb == 0.0 ? depth : std::min(depth, HeightsAfter(pair, seconds));
  }

 private:
  // Fills a_in_W_.
  void Place(const Pair& pair, double seconds) {
    const Transform2 transform(motion_.After(seconds));
    a_in_W_.clear();
    for (const Vec2& vertex : pair.a_in_F) a_in_W_.push_back(transform * vertex);
  }
  // The height that the prisms share, in m.
  double HeightsAfter(const Pair& pair, double seconds) const {
    const ZRange a_z = pair.a_z + motion_.climb * seconds;
    return std::min(a_z.max, pair.b_z.max) - std::max(a_z.min, pair.b_z.min);
  }
  // Fills times_: the start, the events in order, the end.
  void FindTimes(const Pair& pair) {
    double end = motion_.duration;
    const double rate = std::abs(motion_.twist.wz);
    if (rate * end > 2.0 * kPi) end = 2.0 * kPi / rate;  // from then on the motion repeats itself
    times_ = {0.0, end};
    if (pair.initial_depth > kTouchTolerance) {
      // A depth that passes the initial one is not an event, so more times are tested.
      for (int i = 1; i < 16; ++i) times_.push_back(end * i / 16.0);
    }
    if (motion_.climb != 0.0) {
      end = motion_.duration;  // heights do not repeat themselves
      times_[1] = end;
      // The times at which one prism begins to be beside the other, and ends.
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
  std::pmr::vector<double> times_;
  std::pmr::vector<Vec2> a_in_W_;
  std::pmr::vector<Vec2> b_in_F_;
};

// `time`, or the nearest time before it, by doubling steps, at which is_free is true; 0 at the earliest. max_speed:
// m/s.
template <typename IsFree>
double SteppedBack(double time, double max_speed, IsFree is_free) {
  double step_back = std::max(1e-12 / max_speed, time * 0x1p-50);
  while (time > 0.0 && !is_free(time)) {
    time = std::max(0.0, time - step_back);
    step_back *= 2.0;
  }
  return time;
}

// The start and the end of a motion, and its distance from the straight line between them.
class Passage {
 public:
  explicit Passage(const Motion& motion)
      : motion_(motion),
        X_WF_end_(motion.After(motion.duration)),
        start_(motion.X_WF),
        end_(X_WF_end_),
        angle_(std::abs(motion.twist.wz) * motion.duration) {}

  const Motion& motion() const { return motion_; }
  const Transform2& start() const { return start_; }
  const Transform2& end() const { return end_; }
  // No point within `radius` of F's origin is ever farther from the line between its start and end, in m. An arc of
  // angle w and length s leaves its chord by at most s w / 8, as long as it is no more than half a circle; and its
  // start by no more than the diameter, 2 s / w.
  double MarginAt(double radius) const {
    constexpr double kRounding = 1e-12;  // of a pose, for each metre of the way
    const double length = MaxSpeed(motion_, radius) * motion_.duration;
    return length * ((angle_ < kPi ? angle_ / 8.0 : 2.0 / angle_) + kRounding) + kTouchTolerance;
  }
  // False only if no point within `radius` of F's origin comes as near to `point` as this, in m.
  bool MayBeNear(const Vec2& point, double radius, double distance) const {
    constexpr double kRounding = 1e-6;  // m, far above that of a distance
    const Vec2 start = motion_.X_WF.translation();
    const Vec2 along = X_WF_end_.translation() - start;
    const double length = along.squaredNorm();
    const double part = length > 0.0 ? std::clamp(along.dot(point - start) / length, 0.0, 1.0) : 0.0;
    return (point - start - part * along).norm() <= MarginAt(0.0) + radius * (1.0 + 1e-9) + distance + kRounding;
  }
  // A box around the ways of all such points.
  Rectangle BoxAround(double radius) const {
    Rectangle box = Rectangle::Nothing();
    box.Extend(motion_.X_WF.translation());
    box.Extend(X_WF_end_.translation());
    return box.Inflated(MarginAt(0.0) + radius);
  }

 private:
  const Motion motion_;
  const Pose X_WF_end_;
  const Transform2 start_;
  const Transform2 end_;
  const double angle_;  // rad
};

struct Obstacle {
  const ConvexPiece* piece;
  Rectangle box;
};

// The heights that a mover passes.
ZRange SweptHeights(const ZRange& z_in_F, const Motion& motion) {
  const ZRange z = z_in_F + motion.X_WF.z;
  const double dz = motion.climb * motion.duration;
  return {z.min + std::min(dz, 0.0), z.max + std::max(dz, 0.0)};
}

// Selects the pieces that a mover may touch during its motion.
class ObstacleFilter {
 public:
  ObstacleFilter(const Mover& mover, const Passage& passage)
      : z_(SweptHeights(mover.z, passage.motion())), box_(passage.BoxAround(mover.radius * (1.0 + 1e-9) + 1e-9)) {}

  const Rectangle& box() const { return box_; }

  // Appends the piece if it may be touched.
  void Filter(const ConvexPiece& piece, std::pmr::vector<Obstacle>& obstacles) const {
    if (!piece.obstacle || !piece.z.Overlaps(z_)) return;
    const Rectangle piece_box = BoundingBox(piece.vertices);
    if (box_.Overlaps(piece_box)) obstacles.push_back({&piece, piece_box});
  }

 private:
  ZRange z_;
  Rectangle box_;
};

// `static_pieces` has to outlive the result.
std::pmr::vector<Obstacle> FindObstacles(const Scene& scene, const BodyIndex& bodies, const Mover& mover,
                                         const Passage& passage, NearPieces& static_pieces,
                                         std::pmr::memory_resource& memory) {
  const ObstacleFilter filter(mover, passage);
  std::pmr::vector<Obstacle> obstacles(&memory);
  scene.static_index().Query(filter.box(), static_pieces, [&](const PixelPieces::Corners4& corners) {
    return passage.MayBeNear(0.5 * (corners[0] + corners[2]), mover.radius, 0.5 * (corners[2] - corners[0]).norm());
  });
  for (const ConvexPiece* piece : static_pieces) filter.Filter(*piece, obstacles);

  std::pmr::vector<BodyId> near(&memory);
  bodies.Query(filter.box(), near);
  for (BodyId other : near) {
    if (std::binary_search(mover.bodies.begin(), mover.bodies.end(), other)) continue;
    for (const ConvexPiece& piece : bodies.pieces_in_world(other)) filter.Filter(piece, obstacles);
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

// A piece of the mover during its motion.
class MovingPiece {
 public:
  // `margin`: the largest distance, in m, of its vertices from the line between their starts and ends.
  MovingPiece(const ConvexPiece& piece, const Passage& passage, double margin, std::pmr::memory_resource& memory)
      : z_(SweptHeights(piece.z, passage.motion())), margin_(margin), start_(&memory), end_(&memory) {
    start_.reserve(piece.vertices.size());
    for (const Vec2& vertex : piece.vertices) start_.push_back(passage.start() * vertex);
    end_.reserve(piece.vertices.size());
    for (const Vec2& vertex : piece.vertices) end_.push_back(passage.end() * vertex);
    box_ = BoundingBox(start_);
    box_.Extend(BoundingBox(end_));
    box_ = box_.Inflated(margin_);
  }

  std::span<const Vec2> start() const { return start_; }  // vertices in W
  bool MayTouch(const Obstacle& other) const {
    return box_.Overlaps(other.box) && z_.Overlaps(other.piece->z) &&
           !StayApart(start_, end_, other.piece->vertices, margin_);
  }

 private:
  ZRange z_;  // swept heights
  double margin_;
  std::pmr::vector<Vec2> start_;
  std::pmr::vector<Vec2> end_;
  Rectangle box_;  // around its way
};

// The first contact of the mover with any of the obstacles.
std::optional<Contact> ContactWithObstacles(const Mover& mover, const Passage& passage,
                                            const std::pmr::vector<Obstacle>& obstacles,
                                            std::pmr::memory_resource& memory) {
  const Motion& motion = passage.motion();
  const double max_speed = MaxSpeed(motion, mover.radius);
  const double margin = passage.MarginAt(mover.radius);
  std::optional<Contact> first;
  std::pmr::vector<Pair> pairs(&memory);  // the pairs within reach of each other
  PairSweep sweep(motion, passage.start(), memory);
  for (const ConvexPiece& piece : mover.pieces) {
    if (!piece.obstacle) continue;
    const MovingPiece mine(piece, passage, margin, memory);
    for (const Obstacle& other : obstacles) {
      if (!mine.MayTouch(other)) continue;
      Pair pair{piece.vertices, other.piece->vertices, piece.z + motion.X_WF.z, other.piece->z,
                PenetrationDepth(mine.start(), other.piece->vertices)};
      const double gap = -pair.initial_depth - kTouchTolerance;
      if (gap > max_speed * (first ? first->time : motion.duration)) continue;
      if (motion.climb != 0.0) pair.initial_depth = sweep.DepthAfter(pair, 0.0);
      pairs.push_back(pair);
      const std::optional<double> time = sweep.Find(pair);
      if (time) first = FirstOf(first, Contact{*time, piece.model, other.piece->model});
    }
  }
  if (first) {
    // Rounding may leave the contact's pose a little too deep, in this pair or in another.
    first->time = SteppedBack(first->time, max_speed + std::abs(motion.climb), [&](double time) {
      return std::all_of(pairs.begin(), pairs.end(), [&](const Pair& pair) { return sweep.IsFree(pair, time); });
    });
  }
  return first;
}

}  // namespace

namespace internal {

// StackMemory: memory for short-lived vectors, on the stack as long as they are small.
//
//   StackMemory memory;
//   std::pmr::vector<BodyId> near(&memory);

// A base class, so that the bytes outlive the resource that uses them.
struct StackBytes {
  alignas(std::max_align_t) std::array<std::byte, 4096> bytes;
};

}  // namespace internal

// Allocates memory one piece after another, first from the stack and then from the heap. Frees nothing before its
// destruction, so it does not suit a vector that grows and shrinks often. It must outlive its vectors, and is for one
// thread.
class StackMemory : private internal::StackBytes, public std::pmr::monotonic_buffer_resource {
 public:
  StackMemory() : std::pmr::monotonic_buffer_resource(bytes.data(), bytes.size()) {}
};

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
  StackMemory memory;
  std::pmr::vector<Vec2> a_in_W(&memory);
  for (const Vec2& vertex : a_in_R) a_in_W.push_back(transform * vertex);
  const Pair pair{a_in_R, b_in_W, {}, {}, PenetrationDepth(a_in_W, b_in_W)};
  PairSweep sweep(motion, transform, memory);
  const std::optional<double> time = sweep.Find(pair);
  if (!time) return std::nullopt;
  return SteppedBack(*time, MaxSpeed(motion, RadiusOf(a_in_R)), [&](double t) { return sweep.IsFree(pair, t); });
}

std::optional<Contact> FirstContact(const Scene& scene, const BodyIndex& bodies, const Mover& mover,
                                    const Motion& motion) {
  if (motion.IsRest()) return std::nullopt;
  const std::optional<Contact> ground = GroundContact(mover, motion);
  if (ground && ground->time == 0.0) return ground;
  const Passage passage(motion);
  StackMemory memory;
  NearPieces static_pieces(&memory);
  const std::pmr::vector<Obstacle> obstacles = FindObstacles(scene, bodies, mover, passage, static_pieces, memory);
  if (obstacles.empty()) return ground;
  return FirstOf(ContactWithObstacles(mover, passage, obstacles, memory), ground);
}

std::optional<Contact> FirstContactWith(std::span<const ConvexPiece> obstacles, const Mover& mover,
                                        const Motion& motion) {
  if (motion.IsRest()) return std::nullopt;
  const Passage passage(motion);
  const ObstacleFilter filter(mover, passage);
  StackMemory memory;
  std::pmr::vector<Obstacle> near(&memory);
  for (const ConvexPiece& piece : obstacles) filter.Filter(piece, near);
  return ContactWithObstacles(mover, passage, near, memory);
}

}  // namespace troupe
