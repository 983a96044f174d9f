#include "world-service/core/grip.h"

#include "common/spatial/overlap.h"

namespace troupe {
namespace {

// A pad touches an object that is nearer than this: far more than rounding, far less than a picture could show.
constexpr double kPadReach = 1e-6;  // m

bool Touches(const StepWorkspace& workspace, ModelId pad, ObjectId object) {
  const auto& pads = workspace.bodies.pieces_in_world(*workspace.scene.body_of(pad));
  for (const ConvexPiece& a : pads) {
    if (a.model != pad) continue;
    for (const ConvexPiece& b : workspace.bodies.pieces_in_world(workspace.scene.body_of(object))) {
      if (OverlapBy(a, b, -kPadReach)) return true;
    }
  }
  return false;
}

bool HasBetweenPads(const StepWorkspace& workspace, const GripperDescription& gripper, ObjectId object) {
  return Touches(workspace, gripper.left_pad, object) && Touches(workspace, gripper.right_pad, object);
}

void Report(StepWorkspace& workspace, EventType type, GripperId id, ObjectId object) {
  const GripperDescription& gripper = workspace.world().gripper(id);
  workspace.robot_events.push_back({.tick = workspace.next.tick,
                                    .type = type,
                                    .robot = gripper.robot,
                                    .detail = gripper.name,
                                    .object = workspace.world().objects[object.index()]});
}

void Hold(StepWorkspace& workspace, GripperId gripper, ObjectId id) {
  ObjectState& object = workspace.next.objects[id.index()];
  object.mode = ObjectMode::kHeld;
  object.holder = gripper;
  object.support = std::nullopt;
  object.fall_speed = 0.0;
  workspace.needs_support[id.index()] = 0;
  Report(workspace, EventType::kGripped, gripper, id);
}

void UpdateContact(const FingerMotion& finger, ModelId pad, std::optional<ModelId>& contact) {
  if (finger.velocity == 0.0) return;
  contact = std::nullopt;
  if (finger.velocity > 0.0 && finger.contact && finger.contact->mine == pad) contact = finger.contact->other;
}

}  // namespace

void Release(StepWorkspace& workspace, GripperId id) {
  GripperState& gripper = workspace.next.grippers[id.index()];
  if (!gripper.clamped) return;
  const ObjectId object_id = *gripper.clamped;
  ObjectState& object = workspace.next.objects[object_id.index()];
  gripper = {};
  if (object.holder != id) return;
  object.holder = std::nullopt;
  object.mode = ObjectMode::kPlaced;
  workspace.needs_support[object_id.index()] = 1;
  Report(workspace, EventType::kReleased, id, object_id);
  for (const GripperId other : workspace.grippers) {
    if (workspace.next.grippers[other.index()].clamped != object_id) continue;
    if (!HasBetweenPads(workspace, workspace.world().gripper(other), object_id)) continue;
    Hold(workspace, other, object_id);
    return;
  }
}

void Grip(StepWorkspace& workspace, GripperId id, const FingerMotion& left, const FingerMotion& right) {
  const GripperDescription& description = workspace.world().gripper(id);
  GripperState& gripper = workspace.next.grippers[id.index()];
  UpdateContact(left, description.left_pad, gripper.left_contact);
  UpdateContact(right, description.right_pad, gripper.right_contact);
  if (gripper.clamped || !gripper.left_contact || !gripper.right_contact) return;
  const std::optional<ObjectId> object = workspace.scene.object_of(*gripper.left_contact);
  if (!object || object != workspace.scene.object_of(*gripper.right_contact)) return;
  gripper.clamped = object;
  const std::optional<GripperId>& holder = workspace.next.objects[object->index()].holder;
  if (!holder) {
    Hold(workspace, id, *object);
    return;
  }
  workspace.robot_events.push_back({.tick = workspace.next.tick,
                                    .type = EventType::kBlocked,
                                    .robot = description.robot,
                                    .other = workspace.world().objects[object->index()],
                                    .detail = description.name + ": held by " +
                                              workspace.world().robot(workspace.world().gripper(*holder).robot).name});
}

void DropLostObjects(StepWorkspace& workspace) {
  for (std::size_t i = 0; i < workspace.next.grippers.size(); ++i) {
    GripperState& gripper = workspace.next.grippers[i];
    if (!gripper.clamped || workspace.next.objects[gripper.clamped->index()].holder == GripperId(i)) continue;
    if (!HasBetweenPads(workspace, workspace.world().grippers[i], *gripper.clamped)) gripper = {};
  }
}

}  // namespace troupe
