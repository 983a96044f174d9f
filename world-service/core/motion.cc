// The motion of robots (step_workspace.h): a base along the exact arc of its twist, joints one by one, each with its
// payload; and grippers, which take and release objects.
//
// All motion is continuous: the body is swept along its path (common/spatial/sweep.h), and stops at the time of its
// first contact. A robot cannot pass through a thin wall at any speed, and the result does not depend on a step width
// of the collision search.
//
// A payload is found again in each motion, from the holders and supports in the state: nothing else is remembered. It
// moves rigidly with the part that carries it, and collides with everything but the robot itself, or, when a joint
// moves, with the rest of the robot, too.
#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// Payload: the objects that a part of a robot carries when it moves.
struct Payload {
  std::vector<ObjectId> held;     // by a gripper on the part, in id order
  std::vector<ObjectId> stacked;  // on the part, or on other objects of the payload, in id order
};

// The payload of the models for which `moves` is true.
// Held objects first, then stacks on the part and on objects of the payload.
Payload FindPayload(const StepWorkspace& workspace, const std::function<bool(ModelId)>& moves) {
  const std::vector<ObjectState>& objects = workspace.next.objects;
  Payload payload;
  std::vector<bool> carried(objects.size(), false);
  for (const ObjectId id : workspace.objects) {
    const std::optional<GripperId>& holder = objects[id.index()].holder;
    if (!holder || !moves(workspace.world().gripper(*holder).model)) continue;
    carried[id.index()] = true;
    payload.held.push_back(id);
  }
  // Stacks grow from the bottom; each round adds the objects that rest on objects of the previous round.
  for (bool grown = true; grown;) {
    grown = false;
    for (const ObjectId id : workspace.objects) {
      if (carried[id.index()] || !objects[id.index()].support) continue;
      const ModelId support = *objects[id.index()].support;
      const std::optional<ObjectId> below = workspace.scene.object_of(support);
      if (below ? !carried[below->index()] : !moves(support)) continue;
      carried[id.index()] = true;
      grown = true;
      payload.stacked.push_back(id);
    }
  }
  std::sort(payload.stacked.begin(), payload.stacked.end());
  return payload;
}

// Moves `objects` as frame F was moved, from X_WF_before to X_WF_after; heights change by `dz` m exactly.
void MoveObjects(StepWorkspace& workspace, const std::vector<ObjectId>& objects, const Pose& X_WF_before,
                 const Pose& X_WF_after, double dz) {
  const Pose X_FW = Inverse(X_WF_before);
  // An object that only moves up or down keeps the bits of its place in the plane: through the frames it would drift by
  // rounding, tick by tick.
  const bool shifted =
      X_WF_before.x != X_WF_after.x || X_WF_before.y != X_WF_after.y || X_WF_before.heading != X_WF_after.heading;
  for (ObjectId object : objects) {
    const Pose before = workspace.next.objects[object.index()].X_WO;
    Pose after = shifted ? X_WF_after * (X_FW * before) : before;
    after.z = before.z + dz;
    workspace.MoveObject(object, after);
  }
}

// Pieces gathered from several bodies, in the frame F of their common motion.
class MoverBuilder {
 public:
  void Add(const ConvexPiece& piece, const Pose& X_FL) {
    pieces_.push_back(Transformed(piece, X_FL));
    const ConvexPiece& added = pieces_.back();
    for (const Vec2& vertex : added.vertices) radius_ = std::max(radius_, vertex.norm());
    z_.min = pieces_.size() == 1 ? added.z.min : std::min(z_.min, added.z.min);
    z_.max = pieces_.size() == 1 ? added.z.max : std::max(z_.max, added.z.max);
  }
  void AddObjects(const StepWorkspace& workspace, const std::vector<ObjectId>& objects, const Pose& X_WF) {
    const Pose X_FW = Inverse(X_WF);
    for (ObjectId object : objects) {
      const BodyId body = workspace.scene.body_of(object);
      const Pose X_FO = X_FW * workspace.next.objects[object.index()].X_WO;
      for (const ConvexPiece& piece : workspace.scene.body(body).pieces) Add(piece, X_FO);
      Exempt(body);
    }
  }
  // The bodies that are parts of the mover: no obstacles for it.
  void Exempt(BodyId body) { bodies_.push_back(body); }

  // Valid until the next Add, while the builder lives.
  Mover Build() {
    std::sort(bodies_.begin(), bodies_.end());
    return {pieces_, radius_, z_, bodies_};
  }

 private:
  std::vector<ConvexPiece> pieces_;
  double radius_ = 0.0;
  ZRange z_;
  std::vector<BodyId> bodies_;
};

// Of two at the same time, the first argument.
std::optional<Contact> Earlier(const std::optional<Contact>& a, const std::optional<Contact>& b) {
  if (!a || !b) return a ? a : b;
  return b->time < a->time ? b : a;
}

// The links of a body that move with the link `first`: itself and its descendants.
std::vector<bool> LinksFrom(const Body& body, std::uint32_t first) {
  std::vector<bool> moves(body.links.size(), false);
  moves[first] = true;
  // Links come after their parents.
  for (std::size_t k = first + 1; k < body.links.size(); ++k) moves[k] = moves[body.links[k].parent];
  return moves;
}

// The part of a robot that a joint moves, and its payload.
struct JointAssembly {
  BodyId body;
  std::vector<bool> links;  // that move
  Payload payload;
  Pose X_WF;  // F: frame of the joint's model at the start
};

JointAssembly Assemble(const StepWorkspace& workspace, JointId id) {
  const Scene& scene = workspace.scene;
  const JointDescription& joint = workspace.world().joint(id);
  JointAssembly assembly;
  assembly.body = scene.body_of(joint.robot);
  assembly.links = LinksFrom(scene.body(assembly.body), scene.link_of(id));
  assembly.payload = FindPayload(workspace, [&](ModelId model) {
    return scene.body_of(model) == assembly.body && assembly.links[scene.link_of(model)];
  });
  assembly.X_WF = workspace.bodies.X_WM(joint.model);
  return assembly;
}

// The first contact of the part with the world, or of its payload with the rest of its own robot.
std::optional<Contact> SweepJoint(const StepWorkspace& workspace, const JointAssembly& assembly,
                                  const std::vector<ObjectId>& payload, const Motion& motion) {
  const Body& body = workspace.scene.body(assembly.body);
  const std::vector<Pose>& X_BL = workspace.bodies.X_BL(assembly.body);
  const Pose X_FB = Inverse(motion.X_WF) * workspace.bodies.X_WB(assembly.body);
  MoverBuilder whole;
  std::vector<ConvexPiece> rest;  // of the robot, in W
  const std::vector<ConvexPiece>& in_world = workspace.bodies.pieces_in_world(assembly.body);
  for (std::size_t i = 0; i < body.pieces.size(); ++i) {
    const std::uint32_t link = body.piece_links[i];
    if (assembly.links[link]) {
      whole.Add(body.pieces[i], X_FB * X_BL[link]);
    } else if (!payload.empty()) {
      rest.push_back(in_world[i]);
    }
  }
  whole.AddObjects(workspace, payload, motion.X_WF);
  whole.Exempt(assembly.body);
  const std::optional<Contact> contact = FirstContact(workspace.scene, workspace.bodies, whole.Build(), motion);
  // The robot's own links never collide with each other: their shapes overlap at the joints. Its payload must not be
  // moved into it, though: a lift that lowers an object onto its own base stops.
  if (payload.empty()) return contact;
  MoverBuilder objects;
  objects.AddObjects(workspace, payload, motion.X_WF);
  return Earlier(contact, FirstContactWith(rest, objects.Build(), motion));
}

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
  // Fingers that stand keep their contacts: a gripper holds without closing further.
  if (finger.velocity == 0.0) return;
  contact = std::nullopt;
  // Only a closing finger that was stopped at its pad grips.
  if (finger.velocity > 0.0 && finger.contact && finger.contact->mine == pad) contact = finger.contact->other;
}

}  // namespace

std::optional<Contact> MoveBase(StepWorkspace& workspace, RobotId id, const Twist& twist) {
  const Scene& scene = workspace.scene;
  RobotState& robot = workspace.next.robots[id.index()];
  const BodyId own = scene.body_of(id);
  const Body& body = scene.body(own);
  const Motion motion{robot.X_WR, twist, 0.0, workspace.seconds()};
  std::vector<ObjectId> payload;
  // A world without objects skips the search: most swarms have none.
  if (!workspace.next.objects.empty()) {
    Payload found = FindPayload(workspace, [&](ModelId model) { return scene.body_of(model) == own; });
    payload = std::move(found.held);
    payload.insert(payload.end(), found.stacked.begin(), found.stacked.end());
  }

  std::optional<Contact> contact;
  // A rigid robot is swept with the pieces of the scene, without a copy.
  if (!body.has_joints() && payload.empty()) {
    contact = FirstContact(scene, workspace.bodies, MoverOf(scene, own), motion);
  } else {
    MoverBuilder builder;
    const std::vector<Pose>& X_BL = workspace.bodies.X_BL(own);
    for (std::size_t i = 0; i < body.pieces.size(); ++i) builder.Add(body.pieces[i], X_BL[body.piece_links[i]]);
    builder.AddObjects(workspace, payload, robot.X_WR);
    builder.Exempt(own);
    contact = FirstContact(scene, workspace.bodies, builder.Build(), motion);
  }

  // At a contact the robot stops there, and its velocity is zero: contacts are not elastic.
  const double moved_for = contact ? contact->time : motion.duration;
  if (moved_for > 0.0) {
    const Pose before = robot.X_WR;
    robot.X_WR = motion.After(moved_for);
    workspace.bodies.Move(own, robot.X_WR);
    MoveObjects(workspace, payload, before, robot.X_WR, 0.0);
  }
  robot.twist = contact ? Twist{} : twist;
  robot.stalled = contact.has_value();
  return contact;
}

std::optional<Contact> MoveJoint(StepWorkspace& workspace, JointId id, double velocity) {
  const JointDescription& joint = workspace.world().joint(id);
  JointState& state = workspace.next.joints[id.index()];
  // A joint ends at its limit without an event: that is no contact.
  const double target = joint.position.Clamp(state.position + velocity * workspace.seconds());
  const double start = state.position;
  state.velocity = 0.0;
  state.blocked = false;
  if (target == start) return std::nullopt;

  JointAssembly assembly = Assemble(workspace, id);
  Motion motion{assembly.X_WF, {}, 0.0, (target - start) / velocity};
  if (joint.type == JointType::kRevolute) {
    motion.twist.wz = velocity;
  } else {
    motion.twist.vx = velocity * joint.axis_xy.x();
    motion.twist.vy = velocity * joint.axis_xy.y();
    motion.climb = velocity * joint.axis_z;
  }
  Payload& payload = assembly.payload;
  // What stands on a descending part is no obstacle to it and does not stop it: it follows by gravity, in this tick, or
  // stays where it lands on something else.
  const bool descends = motion.climb < 0.0;
  std::vector<ObjectId> swept = payload.held;
  if (!descends) swept.insert(swept.end(), payload.stacked.begin(), payload.stacked.end());
  std::sort(swept.begin(), swept.end());

  const std::optional<Contact> contact = SweepJoint(workspace, assembly, swept, motion);
  state.position = contact ? start + velocity * contact->time : target;
  // Against rounding of the product of velocity and time.
  state.position = joint.position.Clamp(state.position);
  state.velocity = contact ? 0.0 : (target - start) / workspace.seconds();
  state.blocked = contact.has_value();
  workspace.bodies.MoveJoint(id, state.position);
  const double moved_for = contact ? contact->time : motion.duration;
  const Pose after = motion.After(moved_for);
  const double dz = (state.position - start) * joint.axis_z;
  MoveObjects(workspace, swept, assembly.X_WF, after, joint.type == JointType::kRevolute ? 0.0 : dz);
  if (descends) {
    MoveObjects(workspace, payload.stacked, assembly.X_WF, after, 0.0);
    for (ObjectId object : payload.stacked) {
      workspace.needs_support[object.index()] = 1;
      // By this distance the object may come down without a fall; dz is negative.
      workspace.lowered[object.index()] -= dz;
    }
  }
  return contact;
}

void Release(StepWorkspace& workspace, GripperId id) {
  GripperState& gripper = workspace.next.grippers[id.index()];
  if (!gripper.clamped) return;
  const ObjectId object_id = *gripper.clamped;
  ObjectState& object = workspace.next.objects[object_id.index()];
  gripper = {};
  // Another gripper holds the object: this one only waited for it.
  if (object.holder != id) return;
  object.holder = std::nullopt;
  object.mode = ObjectMode::kPlaced;
  workspace.needs_support[object_id.index()] = 1;
  Report(workspace, EventType::kReleased, id, object_id);
  // In the order of ids, the first gripper that still touches the object gets it. It is of this island: islands join
  // all robots that clamp one object.
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
  // Both pads on one object; on two objects, or on a wall, the gripper is closed and holds nothing.
  if (!object || object != workspace.scene.object_of(*gripper.right_contact)) return;
  if (workspace.IsMounted(*object)) return;
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

// After all robots have acted: the holder may have taken the object away from between other pads.
void DropLostObjects(StepWorkspace& workspace) {
  for (std::size_t i = 0; i < workspace.next.grippers.size(); ++i) {
    GripperState& gripper = workspace.next.grippers[i];
    if (!gripper.clamped || workspace.next.objects[gripper.clamped->index()].holder == GripperId(i)) continue;
    if (!HasBetweenPads(workspace, workspace.world().grippers[i], *gripper.clamped)) gripper = {};
  }
}

}  // namespace troupe
