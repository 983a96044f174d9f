// BodyIndex: the poses of a state's bodies, with an index of the bodies near a box. The one place at which a step, a
// ray and a sensor find moving bodies; static models are in StaticIndex.
//
// It follows a state instead of being made from it: Assign and Move touch only what has changed, and derived data (the
// transform, the poses of links, the pieces in W) is computed when it is first asked for after a motion. Most bodies of
// a tick are never looked at closely.
//
// Invariants: the index has the bodies of its scene by their ids in it; a query returns every body that overlaps the
// box, and may return others near it, because it tests discs in single precision with a margin. Results in id order
// (Query) do not depend on the history of moves; the order of ForEachNear does, so that its users must not depend on
// the order.
//
// Up to 256 bodies are tested one after another by vector instructions; more are in a grid, of which a cell is a linked
// list, so that a move from cell to cell costs a few writes. The grid is made again when bodies have left it or crowd
// in a small part of it.
//
// Not safe to share between threads, not even for reading: derived poses and pieces are computed on first use and kept.
// A thread that needs its own copies it, or assigns the state to another one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <optional>
#include <vector>

#include "common/spatial/disc_list.h"
#include "common/spatial/grid.h"
#include "common/spatial/scene.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"
#include "troupe/world_state.h"

namespace troupe {

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
  // Transform2(X_WM), without sines of its own where the model has the heading of its body. REQUIRES: X_WM =
  // X_WM(model)
  Transform2 TransformOf(ModelId model, const Pose& X_WM) const;
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
  // For many bodies: the bodies of a cell are a list: cell_first_, then next_ of each. kNone ends it.
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
