#include "common/spatial/point_velocity.h"

#include "troupe/check.h"

namespace troupe {
namespace {

// Of a point at `r` from the axis of a turn.
Vec2 Across(double rate, const Vec2& r) {
  return {-rate * r.y(), rate * r.x()};
}

}  // namespace

PointVelocity VelocityOf(const Scene& scene, const BodyIndex& bodies, const WorldState& state, ModelId model,
                         const Pose& X_MS) {
  const std::optional<RobotId> robot = scene.robot_of(model);
  TROUPE_CHECK(robot.has_value());
  const BodyId body_id = scene.body_of(*robot);
  const Body& body = scene.body(body_id);
  const Pose& X_WB = bodies.X_WB(body_id);
  const Vec2 point = (bodies.X_WM(model) * X_MS).translation();
  const Twist& twist = state.robots[robot->index()].twist;
  PointVelocity velocity;
  velocity.xy = Transform2(X_WB).Rotate({twist.vx, twist.vy}) + Across(twist.wz, point - X_WB.translation());
  velocity.turn = twist.wz;
  for (std::uint32_t i = scene.link_of(model); i != 0; i = body.links[i].parent) {
    const JointId id = *body.links[i].joint;
    const JointDescription& joint = scene.world().joint(id);
    const double rate = state.joints[id.index()].velocity;
    const Pose X_WJ = bodies.X_WM(joint.model);
    if (joint.type == JointType::kRevolute) {
      velocity.xy += Across(rate, point - X_WJ.translation());
      velocity.turn += rate;
    } else {
      velocity.xy += rate * Transform2(X_WJ).Rotate(joint.axis_xy);
      velocity.z += rate * joint.axis_z;
    }
  }
  return velocity;
}

}  // namespace troupe
