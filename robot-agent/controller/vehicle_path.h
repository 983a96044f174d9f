// The line of an edge of VDA 5050: straight, or a NURBS curve, as points with their way along it.
//
// A curve is evaluated by de Boor's algorithm in homogeneous coordinates (L. Piegl and W. Tiller, The NURBS Book, 2nd
// edition, 1997, A4.1) at a fixed number of parameters for each span, so that all processors find the same bits.
#pragma once

#include <string>
#include <vector>

#include "fleet/order_message.h"
#include "troupe/vec2.h"

namespace troupe {

class VehiclePath {
 public:
  VehiclePath() = default;
  // Of two points or more; equal neighbours are one.
  explicit VehiclePath(const std::vector<Vec2>& points);

  bool empty() const { return points_.empty(); }
  double length() const { return along_.empty() ? 0.0 : along_.back(); }  // m
  const Vec2& end() const { return points_.back(); }
  // The point after `along` m; beyond an end on the straight line from there. REQUIRES: !empty()
  Vec2 At(double along) const;
  // A unit vector; zero on a path without length.
  Vec2 DirectionAt(double along) const;
  // Adds the points of the path that lie behind `along` m, its end among them.
  void AddRest(double along, std::vector<Vec2>& points) const;
  // The way along the path to its point that is nearest to `p`, of those from `from` to `to` m.
  double Nearest(const Vec2& p, double from, double to) const;

 private:
  std::size_t SegmentAt(double along) const;

  std::vector<Vec2> points_;   // m, in W
  std::vector<double> along_;  // m, to each point
};

// The way of a vehicle along the base of its order, as far as it looks.
struct VehicleWay {
  struct Point {
    Vec2 place{0.0, 0.0};  // W
    bool is_node = false;
    std::string map = {};    // of a node; empty: the one before
    bool is_traced = false;  // the way to it is on a trajectory that the order has
  };
  std::vector<Point> points;  // the first one is where the vehicle is
};

// Points on a curve, its ends among them. REQUIRES: fleet::CheckOrder has found nothing.
std::vector<Vec2> PointsOf(const fleet::Trajectory& trajectory);

}  // namespace troupe
