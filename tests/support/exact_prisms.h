// ExactPrisms: all bodies of a world as prisms in its frame, with more digits than the code under test, and without
// convex pieces, half planes or indices. For brute-force computations.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "tests/support/test_world.h"
#include "troupe/world_state.h"

namespace troupe::test {

struct ExactPoint {
  long double x;
  long double y;
};

struct ExactPrism {
  std::vector<ExactPoint> outline;
  long double min_z;
  long double max_z;
  ModelId model;
  ModelId root;

  bool Contains(const ExactPoint& point) const {
    bool inside = false;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const ExactPoint& a = outline[i];
      const ExactPoint& b = outline[(i + 1) % outline.size()];
      if ((a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)) {
        inside = !inside;
      }
    }
    return inside;
  }
};

class ExactPrisms {
 public:
  // Of the models for which `sees(model)` is true.
  template <typename Sees>
  ExactPrisms(const WorldDescription& world, const WorldState& state, Sees sees) : world_(world), state_(state) {
    for (std::size_t m = 0; m < world.models.size(); ++m) {
      if (sees(ModelId(m))) Add(ModelId(m));
    }
  }

  std::vector<ExactPrism> Take() { return std::move(prisms_); }

 private:
  struct Frame {
    long double x = 0.0L;
    long double y = 0.0L;
    long double z = 0.0L;
    long double heading = 0.0L;

    ExactPoint operator*(const ExactPoint& p) const {
      return {x + std::cos(heading) * p.x - std::sin(heading) * p.y,
              y + std::sin(heading) * p.x + std::cos(heading) * p.y};
    }
    Frame operator*(const Frame& inner) const {
      const ExactPoint p = *this * ExactPoint{inner.x, inner.y};
      return {p.x, p.y, z + inner.z, heading + inner.heading};
    }
  };

  static Frame FrameOf(const Pose& pose) { return {pose.x, pose.y, pose.z, pose.heading}; }

  Frame FrameOf(ModelId id) const {
    for (std::size_t i = 0; i < world_.robots.size(); ++i) {
      if (world_.robots[i].root == id) return FrameOf(state_.robots[i].X_WR);
    }
    for (std::size_t i = 0; i < world_.objects.size(); ++i) {
      if (world_.objects[i] == id) return FrameOf(state_.objects[i].X_WO);
    }
    const ModelDescription& model = world_.model(id);
    Frame frame = FrameOf(model.X_PM);
    if (model.parent) frame = FrameOf(*model.parent) * frame;
    for (std::size_t i = 0; i < world_.joints.size(); ++i) {
      const JointDescription& joint = world_.joints[i];
      if (joint.model != id) continue;
      const long double q = state_.joints[i].position;
      const bool turns = joint.type == JointType::kRevolute;
      frame = frame * (turns ? Frame{0.0L, 0.0L, 0.0L, q}
                             : Frame{q * joint.axis_xy.x(), q * joint.axis_xy.y(), q * joint.axis_z, 0.0L});
    }
    return frame;
  }

  void Add(ModelId id) {
    ModelId root = id;
    while (world_.model(root).parent) root = *world_.model(root).parent;
    const Frame frame = FrameOf(id);
    const Shape& shape = world_.shape(world_.model(id).shape);
    const auto add = [&](const Polygon& polygon, const ZRange& z) {
      ExactPrism prism{{}, z.min + frame.z, z.max + frame.z, id, root};
      for (const Vec2& vertex : polygon) prism.outline.push_back(frame * ExactPoint{vertex.x(), vertex.y()});
      prisms_.push_back(std::move(prism));
    };
    for (const Block& block : shape.blocks) add(block.outline, block.z);
    for (const Rectangle& r : shape.rectangles) add(Box(r.min_x, r.min_y, r.max_x, r.max_y), shape.rectangles_z);
  }

  const WorldDescription& world_;
  const WorldState& state_;
  std::vector<ExactPrism> prisms_;
};

}  // namespace troupe::test
