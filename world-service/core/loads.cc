// Hand-over of loads (step_workspace.h: HandOverLoads): an object is put onto the middle of a robot, or down from it,
// in one tick. It does what a fork, rollers or a person at a station do, without their motions; robots with grippers
// use these. An object on a robot moves with it, because it rests on it (motion.cc).
#include <algorithm>
#include <limits>
#include <memory_resource>
#include <optional>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

class HandOver {
 public:
  HandOver(StepWorkspace& workspace, RobotId robot, const LoadOrder& order)
      : workspace_(workspace),
        robot_(robot),
        order_(order),
        root_(order.object),
        object_(*workspace.scene.object_of(order.object)) {}  // it is one: orders are checked (check_order.h)

  void Act() {
    const ObjectState& object = workspace_.next.objects[object_.index()];
    const bool is_loose = object.mode != ObjectMode::kHeld && object.mode != ObjectMode::kMounted;
    const std::optional<RobotId> carrier = object.support ? workspace_.scene.robot_of(*object.support) : std::nullopt;
    if (!is_loose || workspace_.world().model(root_).removed || IsBelowOthers()) return;
    const std::optional<Pose> place = order_.takes ? PlaceOnRobot(carrier) : PlaceBeside(carrier, object);
    if (!place || IsTaken(*place)) return;
    Report(order_.takes ? EventType::kGripped : EventType::kReleased);
    ObjectState& moved = workspace_.next.objects[object_.index()];
    moved.mode = ObjectMode::kFalling;
    moved.fall_speed = 0.0;
    moved.support = std::nullopt;
    workspace_.MoveObject(object_, *place);
    workspace_.needs_support[object_.index()] = 1;
  }

 private:
  const Pose& X_WR() const { return workspace_.next.robots[robot_.index()].X_WR; }
  bool IsInReach(const Vec2& point) const { return (point - X_WR().translation()).norm() <= kLoadReach; }

  bool IsBelowOthers() const {
    return std::any_of(workspace_.next.objects.begin(), workspace_.next.objects.end(), [&](const ObjectState& other) {
      return other.support && workspace_.scene.object_of(*other.support) == object_;
    });
  }

  std::optional<Pose> PlaceOnRobot(const std::optional<RobotId>& carrier) const {
    const Pose& before = workspace_.next.objects[object_.index()].X_WO;
    if (carrier || !IsInReach(before.translation())) return std::nullopt;
    Pose place = X_WR();
    place.z = before.z;
    // The highest top of the robot below the object.
    double deck = -std::numeric_limits<double>::infinity();
    for (const ConvexPiece& piece : PiecesAt(place)) {
      for (const ConvexPiece& below : workspace_.bodies.pieces_in_world(workspace_.scene.body_of(robot_))) {
        if (!below.obstacle || !OverlapBy(piece.vertices, below.vertices, kNoticeableDepth)) continue;
        deck = std::max(deck, below.z.max);
      }
    }
    if (deck == -std::numeric_limits<double>::infinity()) return std::nullopt;
    place.z = deck - workspace_.scene.body(workspace_.scene.body_of(object_)).z.min;
    return place;
  }

  std::optional<Pose> PlaceBeside(const std::optional<RobotId>& carrier, const ObjectState& object) const {
    const Vec2 to(order_.x, order_.y);
    if (carrier != robot_ || !IsInReach(to)) return std::nullopt;
    return Pose{to.x(), to.y(), object.X_WO.z, object.X_WO.heading};
  }

  std::vector<ConvexPiece> PiecesAt(const Pose& X_WO) const {
    std::vector<ConvexPiece> pieces;
    for (const ConvexPiece& piece : workspace_.scene.body(workspace_.scene.body_of(object_)).pieces) {
      pieces.push_back(Transformed(piece, X_WO));
    }
    return pieces;
  }

  // Another body is where the object would be.
  bool IsTaken(const Pose& place) const {
    NearPieces static_pieces;
    std::pmr::vector<BodyId> near;
    for (const ConvexPiece& piece : PiecesAt(place)) {
      if (!piece.obstacle) continue;
      const Rectangle box = BoundingBox(piece.vertices);
      workspace_.scene.static_index().Query(box, static_pieces);
      for (const ConvexPiece* const other : static_pieces) {
        if (other->obstacle && OverlapBy(piece, *other, kNoticeableDepth)) return true;
      }
      near.clear();
      workspace_.bodies.Query(box, near);
      for (const BodyId body : near) {
        if (body == workspace_.scene.body_of(object_)) continue;
        for (const ConvexPiece& other : workspace_.bodies.pieces_in_world(body)) {
          if (other.obstacle && OverlapBy(piece, other, kNoticeableDepth)) return true;
        }
      }
    }
    return false;
  }

  void Report(EventType type) {
    workspace_.robot_events.push_back(
        {.tick = workspace_.next.tick, .type = type, .robot = robot_, .other = {}, .detail = "load", .object = root_});
  }

  StepWorkspace& workspace_;
  const RobotId robot_;
  const LoadOrder order_;
  const ModelId root_;
  const ObjectId object_;
};

}  // namespace

void HandOverLoads(const TickOrders& orders, StepWorkspace& workspace) {
  orders.ForEachOfRobots<LoadOrder>(
      [&](RobotId robot, const LoadOrder& order) { HandOver(workspace, robot, order).Act(); });
}

}  // namespace troupe
