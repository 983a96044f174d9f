#include "world-service/core/find_overlap.h"

#include <algorithm>
#include <memory_resource>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/lift_shafts.h"

namespace troupe {
namespace {

class OverlapFinder {
 public:
  OverlapFinder(const Scene& scene, const WorldState& state, ModelId root)
      : scene_(scene), root_(root), own_body_(scene.body_of(root)), bodies_(scene) {
    bodies_.Assign(state);
    // Only of what moves: a static model stands beside the cabin, or is the shaft.
    if (!own_body_) return;
    std::vector<double> cabins;
    for (const LiftState& lift : state.lifts) cabins.push_back(lift.z);
    shafts_ = EmptyShafts(scene.world(), cabins);
  }

  std::optional<ModelId> Find() {
    if (own_body_) {
      for (const ConvexPiece& piece : bodies_.pieces_in_world(*own_body_)) {
        if (piece.obstacle) Compare(piece);
      }
    } else {
      // A static model has no body of its own: its pieces are the pieces of the index that belong to its tree.
      scene_.static_index().ForEachPiece([this](const ConvexPiece& piece) {
        if (piece.obstacle && IsInTree(scene_.world(), piece.model, root_)) Compare(piece);
      });
    }
    return found_;
  }

 private:
  void Compare(const ConvexPiece& piece) {
    const Rectangle box = BoundingBox(piece.vertices);
    scene_.static_index().Query(box, static_pieces_);
    for (const ConvexPiece* other : static_pieces_) {
      // The tree of a moving body is in no static index, so that the walk up the tree is spared.
      if (own_body_ || !IsInTree(scene_.world(), other->model, root_)) Consider(piece, *other);
    }
    for (const ConvexPiece& shaft : shafts_) Consider(piece, shaft);
    near_.clear();
    bodies_.Query(box, near_);
    for (const BodyId body : near_) {
      if (body == own_body_) continue;
      for (const ConvexPiece& other : bodies_.pieces_in_world(body)) Consider(piece, other);
    }
  }

  void Consider(const ConvexPiece& piece, const ConvexPiece& other) {
    if (!other.obstacle || !OverlapBy(piece, other, kNoticeableDepth)) return;
    found_ = found_ ? std::min(*found_, other.model) : other.model;
  }

  const Scene& scene_;
  const ModelId root_;
  const std::optional<BodyId> own_body_;
  BodyIndex bodies_;
  std::vector<ConvexPiece> shafts_;
  std::optional<ModelId> found_;
  NearPieces static_pieces_;
  std::pmr::vector<BodyId> near_;
};

}  // namespace

std::optional<ModelId> FindOverlap(const Scene& scene, const WorldState& state, ModelId root) {
  return OverlapFinder(scene, state, root).Find();
}

double LowestPoint(const Scene& scene, const WorldState& state, ModelId root) {
  std::optional<double> lowest;
  const auto consider = [&lowest](const ConvexPiece& piece) {
    lowest = std::min(lowest.value_or(piece.z.min), piece.z.min);
  };
  const std::optional<BodyId> body = scene.body_of(root);
  if (!body) {
    scene.static_index().ForEachPiece([&](const ConvexPiece& piece) {
      if (IsInTree(scene.world(), piece.model, root)) consider(piece);
    });
    return lowest.value_or(scene.world().model(root).X_PM.z);
  }
  BodyIndex bodies(scene);
  bodies.Assign(state);
  for (const ConvexPiece& piece : bodies.pieces_in_world(*body)) consider(piece);
  return lowest.value_or(bodies.X_WB(*body).z);
}

}  // namespace troupe
