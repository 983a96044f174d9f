#include "common/spatial/sweep_events.h"

#include <cmath>
#include <optional>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

// Edges count as longer by this at both ends: an event too many costs a test, an event too few lets a body through a
// wall.
constexpr double kEdgeMargin = 1e-6;  // m

Vec2 QuarterTurn(const Vec2& v) {
  return {-v.y(), v.x()};
}

// Vertices that move with a constant twist, against fixed edges.
class EventFinder {
 public:
  EventFinder(const Twist& twist, double duration, std::pmr::vector<double>& times)
      : velocity_(twist.vx, twist.vy), rate_(twist.wz), duration_(duration), times_(times) {
    // Bounds r from above by its value at the end of the motion, so that later roots are thrown out before they cost an
    // arctangent; with a margin, because the exact comparison comes last.
    const double half_turn = 0.5 * std::abs(rate_) * duration;
    if (half_turn < 1e-8) {
      largest_root_ = duration * (1.0 + 1e-9);
    } else if (half_turn < 0.5 * kPi - 1e-6) {
      const SinCosResult trig = SinCos(half_turn);
      largest_root_ = 2.0 / std::abs(rate_) * (trig.sin / trig.cos) * (1.0 + 1e-6);
    }
  }

  // The most that a vertex that starts at p moves, in m.
  double ReachOf(const Vec2& p) const {
    return (std::sqrt(velocity_.squaredNorm()) + std::abs(rate_) * std::sqrt(p.squaredNorm())) * duration_ +
           kEdgeMargin;
  }

  // Adds the times at which the vertex that starts at p, and moves no more than `reach`, touches the edge.
  //
  // With c = cos(wt), s = sin(wt), J a quarter turn to the left and v the velocity, p moves to
  //   c p + s Jp + (s/w) v + ((1-c)/w) Jv.
  // The condition that it lies on the edge's line becomes, with r = (2/w) tan(wt/2), a quadratic without a singularity
  // at w = 0, where r = t.
  void Add(const Vec2& p, double reach, const Vec2& start, const Vec2& end) {
    const Vec2 along = end - start;
    const Vec2 normal(along.y(), -along.x());
    const double c = normal.dot(p - start);
    // The vertex cannot come as far as the edge's line in this motion.
    if (c * c > reach * reach * normal.squaredNorm()) return;
    const double b = rate_ * normal.dot(QuarterTurn(p)) + normal.dot(velocity_);
    const double a = 0.5 * rate_ * normal.dot(QuarterTurn(velocity_)) - 0.25 * rate_ * rate_ * normal.dot(p + start);
    const double discriminant = b * b - 4.0 * a * c;
    if (!(discriminant >= 0.0)) return;
    // The stable form of the quadratic's solution: b and the root have the same sign, so that no digits cancel.
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    if (a != 0.0) AddRoot(q / a, p, start, along);
    if (q != 0.0) AddRoot(c / q, p, start, along);
  }

 private:
  void AddRoot(double r, const Vec2& p, const Vec2& start, const Vec2& along) {
    if (largest_root_ && !(r >= 0.0 && r <= *largest_root_)) return;  // too early or too late
    const double half_tangent = 0.5 * rate_ * r;                      // tan(wt/2)
    if (!std::isfinite(half_tangent)) return;                         // half a turn, which is always tested
    // On the line; but between the edge's ends? With u = tan(wt/2): c = (1-u^2)/(1+u^2), s = 2u/(1+u^2).
    const double scale = 1.0 / (1.0 + half_tangent * half_tangent);
    const double cosine = 2.0 * scale - 1.0;
    const Vec2 at = cosine * p + (rate_ * r * scale) * QuarterTurn(p) + (r * scale) * velocity_ +
                    (half_tangent * r * scale) * QuarterTurn(velocity_);
    const double length = std::sqrt(along.squaredNorm());
    const double place = along.dot(at - start);  // times the length
    if (!(place >= -kEdgeMargin * length && place <= (length + kEdgeMargin) * length)) return;
    double time = r;
    if (std::abs(half_tangent) > 1e-8) {
      time = 2.0 * Atan2(half_tangent, 1.0) / rate_;
      if (time < 0.0) time += 2.0 * kPi / std::abs(rate_);
    }
    if (time >= 0.0 && time <= duration_) times_.push_back(time);
  }

  Vec2 velocity_;
  double rate_;
  double duration_;
  std::optional<double> largest_root_;  // r at the end of the motion; nothing from half a turn on, where r wraps round
  std::pmr::vector<double>& times_;
};

void AppendContacts(std::span<const Vec2> moving, std::span<const Vec2> fixed, const Twist& twist, double duration,
                    std::pmr::vector<double>& times) {
  EventFinder finder(twist, duration, times);
  for (const Vec2& vertex : moving) {
    const double reach = finder.ReachOf(vertex);
    for (std::size_t i = 0; i < fixed.size(); ++i) {
      finder.Add(vertex, reach, fixed[i], fixed[i + 1 < fixed.size() ? i + 1 : 0]);
    }
  }
}

}  // namespace

void AppendEvents(std::span<const Vec2> a, std::span<const Vec2> b, const Twist& twist, double duration,
                  std::pmr::vector<double>& times) {
  AppendContacts(a, b, twist, duration, times);
  // Seen from the moving body, the static one moves with the opposite twist.
  AppendContacts(b, a, {-twist.vx, -twist.vy, -twist.wz}, duration, times);
  if (std::abs(twist.wz) * duration > kPi) times.push_back(kPi / std::abs(twist.wz));  // where tan(wt/2) is infinite
}

}  // namespace troupe
