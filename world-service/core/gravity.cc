// Gravity (step_workspace.h): objects fall straight down onto the highest top under their footprint, and rest there.
// There is no tilting, sliding or bouncing: in two and a half dimensions an object keeps its heading and its place in
// the plane.
//
// A tick looks only at objects that may have lost their support: released, touched, falling, on a support that moved
// down, or resting with their centre above no support. All others rest without a search, so that the cost follows the
// number of disturbed objects.
//
// Objects move from the lowest up: when an object looks for its support, all that could be below it has found its place
// for this tick already. Equal heights keep the order of ids.
//
// An object that comes within kRestReach of a support is put onto it exactly. So stacks do not gather gaps, and resting
// is stable: the same search gives a gap of 0 in the next tick. A support that moves down (a lift, an arm) takes its
// load with it without a fall, by the distance in StepWorkspace::lowered.
#include <algorithm>
#include <limits>
#include <memory_resource>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// An object this near above a support rests on it, and is placed exactly there: far more than rounding, far less than a
// picture could show.
constexpr double kRestReach = 1e-6;  // m

// The support of an object: the highest top under its footprint.
struct Support {
  double height = -std::numeric_limits<double>::infinity();  // m; infinitely low without support, not even ground
  bool is_under_center = false;
  std::optional<ModelId> model;  // under the centre; nothing for the ground
  std::optional<ModelId> any;    // of all at that height the one with the lowest id; nothing for the ground
};

class SupportFinder {
 public:
  // An object without a body has its origin as its bottom.
  SupportFinder(const StepWorkspace& workspace, ObjectId object)
      : workspace_(workspace), body_(workspace.scene.body_of(object)) {
    const std::vector<ConvexPiece>& pieces = Pieces();
    if (pieces.empty()) bottom_ = workspace.bodies.X_WB(body_).z;
    for (const ConvexPiece& piece : pieces) bottom_ = std::min(bottom_, piece.z.min);
    center_ = Center();
  }

  // Height of the object's lowest block, m. Only the ground supports an object that is no obstacle.
  double bottom() const { return bottom_; }

  // Among tops of one height that under the centre counts as the support, with which the object moves; then the lowest
  // id, whatever the order of the index.
  Support Find() const {
    Support best;
    if (bottom_ >= -kRestReach) best = {.height = 0.0, .is_under_center = true, .model = {}, .any = {}};
    const auto consider = [&](const ConvexPiece& piece) {
      if (!piece.obstacle || piece.z.max > bottom_ + kRestReach) return;
      // The cheap comparisons of heights come before the footprints.
      if (piece.z.max < best.height - kRestReach) return;
      if (!IsUnder(piece)) return;
      const bool under_center = Contains(piece.vertices, center_);
      if (piece.z.max > best.height + kRestReach) {
        best = {piece.z.max, under_center, under_center ? std::optional(piece.model) : std::nullopt, piece.model};
        return;
      }
      // As high as the best so far, which may be the ground.
      best.height = std::max(best.height, piece.z.max);
      best.any = best.any ? std::min(*best.any, piece.model) : piece.model;
      if (under_center) best.model = best.model ? std::min(*best.model, piece.model) : piece.model;
      best.is_under_center = best.is_under_center || under_center;
    };
    Rectangle box = Rectangle::Nothing();
    for (const ConvexPiece& piece : Pieces()) {
      for (const Vec2& vertex : piece.vertices) box.Extend(vertex);
    }
    NearPieces static_pieces;
    workspace_.scene.static_index().Query(box, static_pieces);
    for (const ConvexPiece* piece : static_pieces) consider(*piece);
    std::pmr::vector<BodyId> near;
    workspace_.bodies.Query(box, near);
    for (BodyId other : near) {
      if (other == body_) continue;
      for (const ConvexPiece& piece : workspace_.bodies.pieces_in_world(other)) consider(piece);
    }
    return best;
  }

 private:
  const std::vector<ConvexPiece>& Pieces() const { return workspace_.bodies.pieces_in_world(body_); }

  // The centre of the object's volume, which has to be over the support.
  // By a fan of triangles from the first vertex of each piece, weighted by its height: pieces are convex and of one
  // density.
  Vec2 Center() const {
    Vec2 sum = Vec2::Zero();
    double area = 0.0;
    for (const ConvexPiece& piece : Pieces()) {
      // Relative to a vertex, so that no digits are lost far from the origin of W.
      const Vec2& origin = piece.vertices.front();
      for (std::size_t i = 1; i + 1 < piece.vertices.size(); ++i) {
        const Vec2 a = piece.vertices[i] - origin;
        const Vec2 b = piece.vertices[i + 1] - origin;
        const double weight = 0.5 * Cross(a, b) * (piece.z.max - piece.z.min);
        sum += weight * (origin + (a + b) / 3.0);
        area += weight;
      }
    }
    return area > 0.0 ? Vec2(sum / area) : workspace_.bodies.X_WB(body_).translation();
  }

  bool IsUnder(const ConvexPiece& below) const {
    for (const ConvexPiece& piece : Pieces()) {
      // Footprints that only touch are not above each other: a box beside a table does not rest on it.
      if (piece.obstacle && piece.z.min >= below.z.max - kRestReach &&
          PenetrationDepth(piece.vertices, below.vertices) > kTouchTolerance) {
        return true;
      }
    }
    return false;
  }

  static bool Contains(const std::vector<Vec2>& convex, const Vec2& p) {
    for (std::size_t i = 0; i < convex.size(); ++i) {
      const Vec2& a = convex[i];
      const Vec2& b = convex[i + 1 < convex.size() ? i + 1 : 0];
      if (Cross(b - a, p - a) < 0.0) return false;
    }
    return true;
  }

  const StepWorkspace& workspace_;
  BodyId body_;
  double bottom_ = std::numeric_limits<double>::infinity();
  Vec2 center_ = Vec2::Zero();
};

class ObjectFall {
 public:
  explicit ObjectFall(StepWorkspace& workspace) : workspace_(workspace) {}

  void Run() {
    for (ObjectId object : LowestFirst()) {
      if (NeedsSupport(object)) Move(object);
    }
  }

 private:
  bool NeedsSupport(ObjectId id) const {
    const ObjectState& object = workspace_.next.objects[id.index()];
    if (object.holder || object.mode == ObjectMode::kMounted) return false;
    return workspace_.needs_support[id.index()] != 0 || object.mode == ObjectMode::kFalling || IsBridge(id);
  }

  // Rests, but its centre is over no support that it would move with: its supports may move away.
  bool IsBridge(ObjectId id) const {
    const ObjectState& object = workspace_.next.objects[id.index()];
    return object.mode == ObjectMode::kResting && !object.support && UndersideOf(id) != 0.0;
  }

  // Height of the object's lowest block above the ground, m. Every support ends at or below it.
  double UndersideOf(ObjectId id) const {
    const Body& body = workspace_.scene.body(workspace_.scene.body_of(id));
    return workspace_.next.objects[id.index()].X_WO.z + body.z.min;
  }

  // Empty if no object needs a support: most ticks end here.
  std::vector<ObjectId> LowestFirst() const {
    std::vector<ObjectId> order;
    bool any = false;
    for (std::size_t i = 0; i < workspace_.next.objects.size(); ++i) {
      order.emplace_back(i);
      any = any || NeedsSupport(ObjectId(i));
    }
    if (!any) return {};
    // Stable, so that objects of one height are in the order of ids.
    std::stable_sort(order.begin(), order.end(),
                     [&](ObjectId a, ObjectId b) { return UndersideOf(a) < UndersideOf(b); });
    return order;
  }

  void Move(ObjectId id) {
    const SupportFinder finder(workspace_, id);
    const ObjectState& object = workspace_.next.objects[id.index()];
    const Support support = finder.Find();
    const double gap = finder.bottom() - support.height;
    // The support is as near as before: it moved down by no more than `lowered`, and the object with it.
    if (gap <= kRestReach || gap <= workspace_.lowered[id.index()] + kRestReach) {
      Rest(id, support, gap, object.mode == ObjectMode::kFalling);
    } else if (workspace_.world().gravity == 0.0 || support.height == -std::numeric_limits<double>::infinity()) {
      StayAloft(id);
    } else {
      Fall(id, support, gap);
    }
  }

  // Without gravity, or below the ground where nothing supports it: the object stays where it was let go.
  void StayAloft(ObjectId id) {
    ObjectState& object = workspace_.next.objects[id.index()];
    object.mode = ObjectMode::kPlaced;
    object.support = std::nullopt;
  }

  void Fall(ObjectId id, const Support& support, double gap) {
    const double seconds = workspace_.seconds();
    ObjectState& object = workspace_.next.objects[id.index()];
    const double gravity = workspace_.world().gravity;
    // Exact for a constant acceleration, so that the way of a fall does not depend on the length of ticks.
    const double distance = (object.fall_speed + 0.5 * gravity * seconds) * seconds;
    if (distance >= gap) {
      Rest(id, support, gap, true);
      return;
    }
    object.mode = ObjectMode::kFalling;
    object.support = std::nullopt;
    object.fall_speed += gravity * seconds;
    Lower(id, distance);
  }

  void Rest(ObjectId id, const Support& support, double gap, bool fell) {
    ObjectState& object = workspace_.next.objects[id.index()];
    const bool was_resting = object.mode == ObjectMode::kResting;
    const bool lost_balance = object.support && !support.is_under_center;
    object.mode = ObjectMode::kResting;
    object.fall_speed = 0.0;
    object.support = support.model;
    if (gap != 0.0) Lower(id, gap);
    if (was_resting && !fell && !lost_balance) return;  // the object only followed its support
    workspace_.object_events.push_back({.tick = workspace_.next.tick,
                                        .type = support.is_under_center ? EventType::kLanded : EventType::kUnstable,
                                        .other = support.model ? support.model : support.any,
                                        .object = workspace_.world().objects[id.index()]});
  }

  // Moves an object down; the objects that rest on it follow.
  void Lower(ObjectId id, double distance) {
    Pose X_WO = workspace_.next.objects[id.index()].X_WO;
    X_WO.z -= distance;
    workspace_.MoveObject(id, X_WO);
    for (std::size_t i = 0; i < workspace_.next.objects.size(); ++i) {
      const std::optional<ModelId>& below = workspace_.next.objects[i].support;
      if (!below || workspace_.scene.object_of(*below) != id) continue;
      // In this same tick: the objects above come later in the order, and find that their support is lower.
      workspace_.needs_support[i] = 1;
      workspace_.lowered[i] = std::max(workspace_.lowered[i], distance);
    }
  }

  StepWorkspace& workspace_;
};

}  // namespace

void FindSupports(StepWorkspace& workspace) {
  // Supports do not depend on each other here, because nothing moves: any order gives the same result.
  for (std::size_t i = 0; i < workspace.next.objects.size(); ++i) {
    ObjectState& object = workspace.next.objects[i];
    if (object.mode != ObjectMode::kPlaced || workspace.world().model(workspace.world().objects[i]).removed) continue;
    const SupportFinder finder(workspace, ObjectId(i));
    const Support support = finder.Find();
    if (finder.bottom() - support.height > kRestReach) continue;
    object.mode = ObjectMode::kResting;
    object.support = support.model;
  }
}

void LetObjectsFall(StepWorkspace& workspace) {
  ObjectFall(workspace).Run();
}

}  // namespace troupe
