#include "robot-agent/navigation/surroundings.h"

#include <cmath>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "common/spatial/sweep.h"

namespace troupe {
namespace {

// The robot's pieces as its joints are, in its frame, and all that it holds: no obstacles to it.
class RobotMover {
 public:
  RobotMover(const Surroundings& around, RobotId robot) : own_(around.scene.body_of(robot)) {
    const Scene& scene = around.scene;
    mover_ = MoverOf(scene, own_);
    bodies_.push_back(own_);
    const Body& body = scene.body(own_);
    if (body.has_joints()) {
      const std::vector<Pose>& X_BL = around.bodies.X_BL(own_);
      for (std::size_t i = 0; i < body.pieces.size(); ++i) {
        pieces_.push_back(Transformed(body.pieces[i], X_BL[body.piece_links[i]]));
      }
      mover_.pieces = pieces_;
    }
    if (!scene.grippers_of(robot).empty()) {
      for (std::size_t i = 0; i < scene.world().objects.size(); ++i) {
        const BodyId object = scene.body_of(ObjectId(i));
        if (around.bodies.owner(object) == robot) bodies_.push_back(object);
      }
    }
    mover_.bodies = bodies_;
  }
  RobotMover(const RobotMover&) = delete;
  RobotMover& operator=(const RobotMover&) = delete;

  const Mover& mover() const { return mover_; }

 private:
  BodyId own_;
  std::vector<ConvexPiece> pieces_;
  std::vector<BodyId> bodies_;
  Mover mover_;
};

std::optional<ContactAhead> FindContact(const Surroundings& around, RobotId own, const Motion& motion) {
  if (!(motion.duration > 0.0)) return std::nullopt;
  const RobotMover robot(around, own);
  const std::optional<Contact> contact = FirstContact(around.scene, around.bodies, robot.mover(), motion);
  if (!contact || !contact->other) return std::nullopt;
  return ContactAhead{*contact->other, contact->time};
}

}  // namespace

const WorldDescription& WorldIn(const Scene& scene) {
  return scene.world();
}

const WorldDescription& Surroundings::world() const {
  return scene.world();
}

const Pose& Surroundings::PoseOf(RobotId robot) const {
  return bodies.X_WB(scene.body_of(robot));
}

std::optional<ContactAhead> FindContactAhead(const Surroundings& around, RobotId own, const Pose& X_WR,
                                             const Vec2& direction, double way) {
  const Vec2 direction_R = Transform2(X_WR).InverseRotate(direction);
  // 1 m/s: seconds are metres.
  return FindContact(around, own, {X_WR, {direction_R.x(), direction_R.y(), 0.0}, 0.0, way});
}

std::optional<ContactAhead> FindContactInTurn(const Surroundings& around, RobotId own, const Pose& X_WR, double angle) {
  // 1 rad/s: seconds are radians.
  return FindContact(around, own, {X_WR, {0.0, 0.0, angle > 0.0 ? 1.0 : -1.0}, 0.0, std::fabs(angle)});
}

ModelId RootOf(const Surroundings& around, ModelId model) {
  while (const std::optional<ModelId> parent = around.world().model(model).parent) model = *parent;
  return model;
}

}  // namespace troupe
