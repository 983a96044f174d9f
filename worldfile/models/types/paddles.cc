#include "worldfile/models/types/paddles.h"

#include "worldfile/models/types/model_type.h"

namespace troupe {
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

}  // namespace troupe
