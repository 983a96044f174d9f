// BodyIndex: the poses of a state's bodies, with an index of the bodies near a box. Updated as bodies move.
//
// Not safe to share between threads, not even for reading: derived poses and pieces are computed on first use and kept.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <optional>
#include <vector>

#include "common/spatial/grid.h"
#include "common/spatial/ray_shape.h"
#include "common/spatial/scene.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"
#include "troupe/world_state.h"

namespace troupe {

// Discs in single precision, tested four at a time: for finding the few of many that are near a box.

// The box of a query, along the x axis or any other direction.
class DiscBox {
 public:
  // `box`: m, its x axis being `along`, of length 1. `max_radius`: no disc has a larger one.
  DiscBox(const Rectangle& box, double max_radius, const Vec2& along = Vec2(1.0, 0.0)) {
    // The numbers of a disc that overlaps the box are not larger than those of the box and its radius together, so this
    // makes up for the rounding of both.
    constexpr double kRounding = 2e-6;  // many times that of a float
    const Vec2 center = box.center();
    const double rounding =
        kRounding * (std::abs(center.x()) + std::abs(center.y()) + box.width() + box.height() + max_radius);
    cos_ = static_cast<float>(along.x());
    sin_ = static_cast<float>(along.y());
    x_ = static_cast<float>(center.x());
    y_ = static_cast<float>(center.y());
    half_width_ = static_cast<float>(0.5 * box.width() + rounding);
    half_height_ = static_cast<float>(0.5 * box.height() + rounding);
  }

 private:
  friend class DiscList;
  float cos_;  // of its direction
  float sin_;
  float x_;  // m, its middle
  float y_;
  float half_width_;
  float half_height_;
};

class DiscList {
 public:
  struct Disc {
    float x;  // m
    float y;
    float radius;
  };

  Disc operator[](std::size_t i) const {
    const Group& group = groups_[i / 4];
    return {group.x[i % 4], group.y[i % 4], group.radius[i % 4]};
  }

  void Clear() {
    groups_.clear();
    size_ = 0;
  }
  void Reserve(std::size_t count) { groups_.reserve((count + 3) / 4); }
  void Add(const Vec2& center, double radius) {
    if (size_ % 4 == 0) groups_.push_back(Group{{}, {}, kNoDisc});
    groups_.back().radius[size_ % 4] = static_cast<float>(radius);
    Move(size_++, center);
  }
  void Move(std::size_t i, const Vec2& center) {
    groups_[i / 4].x[i % 4] = static_cast<float>(center.x());
    groups_[i / 4].y[i % 4] = static_cast<float>(center.y());
  }

  // False only if the disc and the box have nothing in common; NaN overlaps. Never wrong by rounding.
  bool Overlaps(std::size_t i, const DiscBox& box) const {
    return (Overlapping(groups_[i / 4], box) >> (i % 4) & 1) != 0;
  }

  // Calls visit(i) for the discs that overlap the box, in order.
  template <typename Visit>
  void ForEachOverlapping(const DiscBox& box, Visit visit) const {
    for (std::size_t group = 0; group < groups_.size(); ++group) {
      for (std::uint32_t lanes = Overlapping(groups_[group], box); lanes != 0; lanes &= lanes - 1) {
        const std::size_t i = 4 * group + static_cast<std::size_t>(std::countr_zero(lanes));
        if (i < size_) visit(i);  // a box without bounds overlaps the lanes without a disc as well
      }
    }
  }

 private:
  struct Group {
    Float4 x;
    Float4 y;
    Float4 radius;
  };
  static constexpr Float4 kNoDisc{-1e30f, -1e30f, -1e30f, -1e30f};  // the radius of lanes without a disc

  static std::uint32_t Overlapping(const Group& discs, const DiscBox& box) {
    const Float4 x = box.cos_ * discs.x + box.sin_ * discs.y - box.x_;
    const Float4 y = box.cos_ * discs.y - box.sin_ * discs.x - box.y_;
    const Float4 reach_x = discs.radius + box.half_width_;
    const Float4 reach_y = discs.radius + box.half_height_;
    return BitsOf(~((x > reach_x) | (x < -reach_x) | (y > reach_y) | (y < -reach_y)));
  }

  std::vector<Group> groups_;
  std::size_t size_ = 0;
};

class BodyIndex {
 public:
  // The scene must outlive the index.
  explicit BodyIndex(const Scene& scene) : scene_(&scene) {}

  // Updates to a state: the poses of all robots, objects and people, the joints, and the holder of each object. Cheap
  // for bodies that have not moved since the last call.
  void Assign(const WorldState& state);
  // Updates one body's pose, or one joint's position. REQUIRES: Assign has been called.
  void Move(BodyId body, const Pose& X_WB);
  void MoveJoint(JointId joint, double position);

  const Pose& X_WB(BodyId body) const { return X_WB_[body.index()]; }
  const Transform2& transform(BodyId body) const;  // X_WB
  // Pose of a model with its joints at their present positions. REQUIRES: it belongs to a body.
  Pose X_WM(ModelId model) const;
  // Poses of a body's links in its frame at present.
  const std::vector<Pose>& X_BL(BodyId body) const;
  // The body's pieces in W at present. Valid until the body is moved.
  const std::vector<ConvexPiece>& pieces_in_world(BodyId body) const;
  // The robot that the body is, or that held it in the state last assigned; nothing for an object without a holder, and
  // for a person.
  std::optional<RobotId> owner(BodyId body) const { return owner_[body.index()]; }

  // The bodies that may overlap `box`, in id order without repeats. Appends to `result`.
  void Query(const Rectangle& box, std::pmr::vector<BodyId>& result) const;
  // Calls visit(body) for the same bodies, in an order that depends on their earlier poses.
  template <typename Visit>
  void ForEachNear(const Rectangle& box, Visit visit) const;

 private:
  struct Cache {
    std::vector<ConvexPiece> pieces;
    std::vector<Pose> X_BL;
  };

  // Testing all of so few is quicker than keeping the grid, and needs less memory.
  static constexpr std::size_t kFewBodies = 256;

  bool has_grid() const { return X_WB_.size() > kFewBodies; }
  bool FitsGrid() const;
  void Rebuild();
  void Insert(std::uint32_t body);
  void Remove(std::uint32_t body);

  const Scene* scene_;
  std::vector<Pose> X_WB_;
  DiscList discs_;                 // around the bodies
  std::vector<double> positions_;  // by joint
  std::vector<std::optional<RobotId>> owner_;
  mutable std::vector<Cache> cache_;
  // The fresh parts of the cache, by body; apart from it, so that moving a body touches less memory.
  static constexpr std::uint8_t kPiecesFresh = 1;
  static constexpr std::uint8_t kLinksFresh = 2;
  static constexpr std::uint8_t kTransformFresh = 4;
  mutable std::vector<std::uint8_t> fresh_;
  mutable std::vector<Transform2> transforms_;
  // For many bodies: those of a cell are a list, cell_first_, then next_ of each. kNone ends it.
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  Grid grid_;
  std::vector<std::uint32_t> cell_first_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> cell_of_;
};

template <typename Visit>
void BodyIndex::ForEachNear(const Rectangle& box, Visit visit) const {
  if (X_WB_.empty() || box.empty()) return;
  // A body may reach into the box from as far as its radius; in the grid it is in the cell of its origin.
  const double max_radius = scene_->max_body_radius() * (1.0 + 1e-9) + 1e-9;
  const DiscBox disc_box(box, max_radius);
  const CellRange range = has_grid() ? grid_.CellsOf(box.Inflated(max_radius)) : CellRange{};
  if (!has_grid() || range.count() >= X_WB_.size()) {
    discs_.ForEachOverlapping(disc_box, [&](std::size_t i) { visit(BodyId(i)); });
    return;
  }
  for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
    for (std::int32_t column = range.min_column; column <= range.max_column; ++column) {
      for (std::uint32_t i = cell_first_[grid_.CellAt(column, row)]; i != kNone; i = next_[i]) {
        if (discs_.Overlaps(i, disc_box)) visit(BodyId(i));
      }
    }
  }
}

struct PointVelocity {
  Vec2 xy{0.0, 0.0};  // m/s, in W
  double z = 0.0;     // m/s
  double turn = 0.0;  // rad/s, about z
};

// The velocity of the origin of frame S, at X_MS on `model`, with the twist and the joint velocities of `state`.
// REQUIRES: `bodies` is an index of `scene` at `state`, and `model` is of a robot.
PointVelocity VelocityOf(const Scene& scene, const BodyIndex& bodies, const WorldState& state, ModelId model,
                         const Pose& X_MS);

}  // namespace troupe
