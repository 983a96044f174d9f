#include "worldfile/models/types/gripper_builder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/geometry/limits.h"
#include "common/model/states.h"
#include "troupe/world_description.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/stage/world_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// The box around a pad of an open gripper, frame G.
struct PadBox {
  Rectangle area = Rectangle::Nothing();
  ZRange z;
};

class BeamMaker {
 public:
  BeamMaker(const WorldDescription& world, const GripperDescription& gripper) : world_(world), gripper_(gripper) {
    for (const JointDescription& joint : world.joints) joints_.emplace(joint.model, &joint);
  }

  PadBox BoxOf(ModelId pad) const {
    Pose X_GM;
    // From the pad up to the mount, one joint after another.
    for (ModelId at = pad; at != gripper_.model; at = *world_.model(at).parent) {
      Pose X_PM = world_.model(at).X_PM;
      if (const auto found = joints_.find(at); found != joints_.end()) {
        // Fingers at their open end, whatever the start of the file: the beams belong to the gripper, not to its first
        // state.
        const bool is_finger = at == world_.joint(gripper_.left).model || at == world_.joint(gripper_.right).model;
        X_PM = X_PM * JointMotion(*found->second, is_finger ? found->second->position.min : found->second->start);
      }
      X_GM = X_PM * X_GM;
    }
    const Transform2 move(X_GM);
    const Shape& shape = world_.shape(world_.model(pad).shape);
    PadBox box;
    bool is_first = true;
    const auto extend = [&](const Polygon& outline, const ZRange& z) {
      for (const Vec2& corner : outline) box.area.Extend(move * corner);
      const ZRange z_G = z + X_GM.z;
      box.z = is_first ? z_G : ZRange{std::min(box.z.min, z_G.min), std::max(box.z.max, z_G.max)};
      is_first = false;
    };
    for (const Block& block : shape.blocks) extend(block.outline, block.z);
    for (const Rectangle& r : shape.rectangles) {
      extend({{r.min_x, r.min_y}, {r.max_x, r.min_y}, {r.max_x, r.max_y}, {r.min_x, r.max_y}}, shape.rectangles_z);
    }
    return box;
  }

 private:
  const WorldDescription& world_;
  const GripperDescription& gripper_;
  std::map<ModelId, const JointDescription*> joints_;
};

double Middle(double min, double max) {
  return 0.5 * (min + max);
}

// Between two intervals: from where `a` ends towards `b`, to where `b` ends towards `a`.
struct Gap {
  double from = 0.0;
  double to = 0.0;
  double width = 0.0;  // negative where they overlap
};

Gap GapBetween(const Interval& a, const Interval& b) {
  // By the middles, so that overlapping pads give a gap of negative width and not two.
  if (Middle(a.min, a.max) > Middle(b.min, b.max)) return {a.min, b.max, a.min - b.max};
  return {a.max, b.min, b.min - a.max};
}

// Two beams between the open pads, at a quarter and three quarters of their common length, at half their height.
std::vector<BreakBeam> BreakBeamsOf(const WorldDescription& world, const GripperDescription& gripper) {
  const BeamMaker maker(world, gripper);
  const PadBox left = maker.BoxOf(gripper.left_pad);
  const PadBox right = maker.BoxOf(gripper.right_pad);
  const Gap gap_x = GapBetween({left.area.min_x, left.area.max_x}, {right.area.min_x, right.area.max_x});
  const Gap gap_y = GapBetween({left.area.min_y, left.area.max_y}, {right.area.min_y, right.area.max_y});
  const double z = Middle(std::max(left.z.min, right.z.min), std::min(left.z.max, right.z.max));
  const bool along_y = gap_y.width >= gap_x.width;  // the pads face each other
  std::vector<BreakBeam> beams;
  for (const double part : {0.25, 0.75}) {
    if (along_y) {
      const double min = std::max(left.area.min_x, right.area.min_x);
      const double max = std::min(left.area.max_x, right.area.max_x);
      const double x = min + part * (max - min);
      beams.push_back({{x, gap_y.from}, {x, gap_y.to}, z});
    } else {
      const double min = std::max(left.area.min_y, right.area.min_y);
      const double max = std::min(left.area.max_y, right.area.max_y);
      const double y = min + part * (max - min);
      beams.push_back({{gap_x.from, y}, {gap_x.to, y}, z});
    }
  }
  return beams;
}

// `gripper`: two fingers that close on an object: paddles of its own, or models that the file names.

class GripperReader : public ModelReader {
 public:
  Shape ReadShape(PropertyReader& reader, const ModelDraft& draft, BuildContext& context) override {
    settings_ = ReadSettings(reader, draft, context.world);
    if (!settings_ || draft.map) return ModelReader::ReadShape(reader, draft, context);
    // Without paddles the blocks are all of its body.
    if (!settings_->paddles) return ReadModelShape(reader, false, draft.size, draft.X_MD, context);
    const PaddleSettings& paddles = *settings_->paddles;
    const bool has_back = paddles.size.x < draft.size.x;
    return ReadModelShape(reader, has_back, BackSize(draft.size, paddles), BackPose(draft.X_MD, paddles), context);
  }

  void AddParts(const ModelDraft& draft, BuildContext& context) override {
    if (!settings_) return;
    gripper_ = GripperDraft{draft.node.where, draft.id, *draft.robot, std::move(*settings_), std::nullopt};
    if (!gripper_->settings.paddles) return;
    gripper_->own = AddPaddles(*gripper_->settings.paddles, draft.size, draft.X_MD, gripper_->where, draft.id,
                               *draft.robot, context);
    for (const ModelId part : gripper_->own->models) {
      context.names.AddPart(draft.node.where, context.world.model(part).name, context.diagnostics);
    }
  }

  void Complete(BuildContext& context) override {
    if (gripper_) GripperBuilder(context).Describe(*gripper_);
  }

 private:
  // Nothing for a gripper on no robot, which is only a body.
  static std::optional<GripperSettings> ReadSettings(PropertyReader& reader, const ModelDraft& draft,
                                                     const WorldDescription& world) {
    const double base = draft.robot ? world.model(world.robot(*draft.robot).root).X_PM.z : draft.X_WM.z;
    const GripperSettings settings = ReadGripper(reader, draft.size, draft.X_WM.z - base);
    if (draft.robot) return settings;
    reader.diagnostics().Warn(draft.node.where, "this gripper is on no robot, so it is only a body");
    return std::nullopt;
  }

  std::optional<GripperSettings> settings_;
  std::optional<GripperDraft> gripper_;
};

}  // namespace

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
    // Four different joints: a finger of two grippers would get two commands.
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
  constexpr std::size_t kMax = 12;
  const std::string prefix = world_.model(draft.model).name + ".";
  std::vector<std::string> names;
  for (std::size_t i = draft.model.index() + 1; i < world_.models.size() && names.size() < kMax; ++i) {
    if (!IsInTree(world_, ModelId(i), draft.model)) break;
    const std::string& name = world_.models[i].name;
    names.push_back(name.starts_with(prefix) ? name.substr(prefix.size()) : "/" + name);
  }
  return names;
}

namespace {

class PaddleBuilder {
 public:
  PaddleBuilder(const SourceLocation& where, ModelId gripper, RobotId robot, BuildContext& context)
      : where_(where), gripper_(gripper), robot_(robot), context_(context) {}

  // A model like the gripper, a box or without a body. It must not be beyond 1000 km.
  ModelId AddModel(const std::string& name, ModelId parent, const Pose& X_PM, const Size& size, bool has_body) {
    if (!IsWithinReach(X_PM)) {
      context_.diagnostics.Fail(where_, "found a gripper with a paddle beyond 1000 km, expected it nearer");
    }
    WorldDescription& world = context_.world;
    const ModelDescription& gripper = world.model(gripper_);
    ModelDescription model;
    model.name = gripper.name + "." + name;
    model.type = "actuator";
    model.parent = parent;
    model.X_PM = X_PM;
    model.size_x = size.x;
    model.size_y = size.y;
    model.size_z = size.z;
    model.color = gripper.color;
    model.obstacle_return = gripper.obstacle_return;
    model.ranger_return = gripper.ranger_return;
    Shape shape;
    if (has_body) {
      shape.blocks.push_back(BoxBlock({-0.5 * size.x, -0.5 * size.y, 0.5 * size.x, 0.5 * size.y}, {0.0, size.z}));
    }
    model.shape = context_.shapes.Add(std::move(shape));
    const ModelId id(world.models.size());
    world.models.push_back(std::move(model));
    return id;
  }

  // It starts at one end or the other of its travel.
  JointId AddJoint(ModelId model, const Vec2& axis_xy, double axis_z, double travel, double speed, bool at_end) {
    WorldDescription& world = context_.world;
    JointDescription joint;
    joint.name = NameOnRobot(world, robot_, world.model(model).name);
    joint.robot = robot_;
    joint.model = model;
    joint.axis_xy = axis_xy;
    joint.axis_z = axis_z;
    joint.position = {0.0, travel};
    joint.start = at_end ? travel : 0.0;
    joint.max_speed = speed;
    const JointId id(world.joints.size());
    world.joints.push_back(std::move(joint));
    return id;
  }

 private:
  const SourceLocation& where_;
  ModelId gripper_;
  RobotId robot_;
  BuildContext& context_;
};

}  // namespace

OwnParts AddPaddles(const PaddleSettings& settings, const Size& size, const Pose& X_MD, const SourceLocation& where,
                    ModelId gripper, RobotId robot, BuildContext& context) {
  PaddleBuilder builder(where, gripper, robot, context);
  OwnParts parts;
  ModelId mount = gripper;
  Pose X_ML = X_MD;  // L: the mount of the paddles
  if (settings.height) {
    X_ML.z += settings.height->min;
    mount = builder.AddModel("lift", gripper, X_ML, {settings.size.x, size.y, settings.size.z}, false);
    parts.lift = builder.AddJoint(mount, {0.0, 0.0}, 1.0, settings.height->max - settings.height->min,
                                  settings.lift_speed, settings.up);
    parts.models.push_back(mount);
    X_ML = Pose{};
  }
  const double x = 0.5 * (size.x - settings.size.x);
  const double y = 0.5 * (size.y - settings.size.y);
  const ModelId left = builder.AddModel("left_paddle", mount, X_ML * Pose{x, y, 0.0, 0.0}, settings.size, true);
  parts.left = builder.AddJoint(left, {0.0, -1.0}, 0.0, settings.travel, settings.speed, settings.closed);
  const ModelId right = builder.AddModel("right_paddle", mount, X_ML * Pose{x, -y, 0.0, 0.0}, settings.size, true);
  parts.right = builder.AddJoint(right, {0.0, 1.0}, 0.0, settings.travel, settings.speed, settings.closed);
  parts.models.push_back(left);
  parts.models.push_back(right);
  return parts;
}

ModelType GripperType() {
  return {.name = "gripper", .size = {0.2, 0.3, 0.2}, .make_reader = MakeReader<GripperReader>};
}

}  // namespace troupe
