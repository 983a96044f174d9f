#include "worldfile/models/types/gripper_builder.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/geometry/limits.h"
#include "worldfile/models/types/break_beams.h"
#include "worldfile/models/types/model_type.h"
#include "worldfile/stage/world_tree.h"
#include "worldfile/text/quote.h"

namespace troupe {

void GripperBuilder::Describe(const GripperDraft& draft) {
  if (context_.diagnostics.failed()) return;
  GripperDescription gripper;
  gripper.name = NameOnRobot(world_, draft.robot, world_.model(draft.model).name);
  gripper.robot = draft.robot;
  gripper.autosnatch = draft.settings.autosnatch;
  if (draft.own) {
    gripper.left = draft.own->left;
    gripper.right = draft.own->right;
    gripper.lift = draft.own->lift;
  } else {
    gripper.left = FindJoint(draft, *draft.settings.left_finger, false);
    gripper.right = FindJoint(draft, *draft.settings.right_finger, false);
  }
  if (draft.settings.lift) gripper.lift = FindJoint(draft, *draft.settings.lift, true);
  if (context_.diagnostics.failed()) return;
  gripper.left_pad = FindPad(draft, draft.settings.left_pad, gripper.left);
  gripper.right_pad = FindPad(draft, draft.settings.right_pad, gripper.right);
  CheckFingers(draft, gripper);
  if (context_.diagnostics.failed()) return;
  gripper.model = Mount(world_.joint(gripper.left).model, world_.joint(gripper.right).model);
  gripper.beams = BreakBeamsOf(world_, gripper);
  for (const BreakBeam& beam : gripper.beams) {
    if (std::max({beam.from.cwiseAbs().maxCoeff(), beam.to.cwiseAbs().maxCoeff(), std::fabs(beam.z)}) > kMaxMagnitude) {
      Fail(draft.where, "found a gripper with a pad beyond 1000 km, expected it nearer");
    }
  }
  world_.grippers.push_back(std::move(gripper));
}

void GripperBuilder::CheckFingers(const GripperDraft& draft, const GripperDescription& gripper) {
  if (context_.diagnostics.failed()) return;
  const ModelId left = world_.joint(gripper.left).model;
  const ModelId right = world_.joint(gripper.right).model;
  if (!draft.own && (IsInTree(world_, left, right) || IsInTree(world_, right, left))) {
    Fail(draft.settings.right_finger->where, "found fingers " + Quoted(draft.settings.left_finger->name) + " and " +
                                                 Quoted(draft.settings.right_finger->name) +
                                                 ", of which one carries the other, expected two beside each other");
  } else if (draft.settings.lift && !IsInTree(world_, Mount(left, right), world_.joint(*gripper.lift).model)) {
    Fail(draft.settings.lift->where, "found lift " + Quoted(draft.settings.lift->name) +
                                         ", which does not move both fingers, expected one that carries them");
  }
  for (const GripperDescription& other : world_.grippers) {
    const std::set<JointId> fingers{other.left, other.right, gripper.left, gripper.right};
    if (fingers.size() == 4 && other.model != Mount(left, right)) continue;
    Fail(draft.where, "found the fingers of gripper " + Quoted(other.name) +
                          ", or others mounted on the same model, expected each gripper to have its own");
  }
  for (const ModelId pad : {gripper.left_pad, gripper.right_pad}) {
    if (world_.model(pad).obstacle_return) continue;
    context_.diagnostics.Warn(draft.where, "pad " + Quoted(world_.model(pad).name) +
                                               " touches nothing, so this gripper never grips: its "
                                               "'obstacle_return' is 0");
  }
}

ModelId GripperBuilder::FindModel(const GripperDraft& draft, const PartName& part, bool also_on_robot) {
  std::vector<std::string> candidates{FullName(world_.model(draft.model).name, part.name)};
  if (also_on_robot) candidates.push_back(FullName(world_.robot(draft.robot).name, part.name));
  for (const std::string& name : candidates) {
    for (std::size_t i = 0; i < world_.models.size(); ++i) {
      const ModelId top = also_on_robot ? world_.robot(draft.robot).root : draft.model;
      if (world_.models[i].name == name && ModelId(i) != top && IsInTree(world_, ModelId(i), top)) return ModelId(i);
    }
  }
  std::string message = "found no model " + Quoted(part.name) + " in gripper " + Quoted(world_.model(draft.model).name);
  if (also_on_robot) message += " or its robot";
  message += ", expected one of";
  const std::vector<std::string> names = NamesBelow(draft);
  for (const std::string& name : names) message += " " + Quoted(name);
  Fail(part.where, message + (names.empty() ? " its children, but it has none" : ""));
  return draft.model;
}

JointId GripperBuilder::FindJoint(const GripperDraft& draft, const PartName& part, bool also_on_robot) {
  const ModelId model = FindModel(draft, part, also_on_robot);
  for (std::size_t i = 0; i < world_.joints.size(); ++i) {
    if (world_.joints[i].model == model) return JointId(i);
  }
  Fail(part.where, "found " + Quoted(part.name) + ", which does not move, expected the name of an actuator");
  return JointId();
}

ModelId GripperBuilder::FindPad(const GripperDraft& draft, const std::optional<PartName>& part, JointId finger) {
  const ModelId finger_model = world_.joint(finger).model;
  const ModelId pad = part ? FindModel(draft, *part, false) : finger_model;
  if (context_.diagnostics.failed()) return pad;
  const SourceLocation& where = part ? part->where : draft.where;
  const Shape& shape = world_.shape(world_.model(pad).shape);
  if (!IsInTree(world_, pad, finger_model)) {
    Fail(where, "found pad " + Quoted(part->name) + ", which finger " + Quoted(world_.joint(finger).name) +
                    " does not move, expected the finger or a model on it");
  } else if (shape.empty()) {
    Fail(where, "found a gripper without pads: " + Quoted(world_.model(pad).name) +
                    " has no body, expected fingers with blocks, or the names of their pads");
  }
  return pad;
}

ModelId GripperBuilder::Mount(ModelId left, ModelId right) const {
  ModelId mount = *world_.model(left).parent;
  while (!IsInTree(world_, right, mount)) mount = *world_.model(mount).parent;
  return mount;
}

std::vector<std::string> GripperBuilder::NamesBelow(const GripperDraft& draft) const {
  constexpr std::size_t kMost = 12;
  const std::string prefix = world_.model(draft.model).name + ".";
  std::vector<std::string> names;
  for (std::size_t i = draft.model.index() + 1; i < world_.models.size() && names.size() < kMost; ++i) {
    if (!IsInTree(world_, ModelId(i), draft.model)) break;
    const std::string& name = world_.models[i].name;
    names.push_back(name.starts_with(prefix) ? name.substr(prefix.size()) : "/" + name);
  }
  return names;
}

}  // namespace troupe
