// Scene: a world description prepared for fast queries: bodies with their links and pieces, indices by model, the
// static index, the stores, lights and units in the order of their rows in a state. All that can be computed from a
// description, and that a step, an agent or a sensor would else compute in each tick.
//
// Immutable after its construction, so that any thread may read it; made once by the service and once by each agent in
// another process, and made again by an edit that changes the description. The description is shared, not copied.
//
// The tree of models becomes bodies: a robot, an object or a person with everything below its root is one body, whose
// links are the parts between joints. All other models are static, and their pieces are in W.
//
// Cost: linear in models and pieces, with the partition of concave outlines; the routes of people are made by the first
// call that asks for them, because most worlds have none.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/ray_shape.h"
#include "common/spatial/static_index.h"
#include "troupe/ids.h"
#include "troupe/result.h"
#include "troupe/shared.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// A rigid part of a body. Link 0 is the part that no joint moves; its frame is the body's.
struct Link {
  std::optional<JointId> joint;  // that moves it; nothing: link 0
  std::uint32_t parent = 0;      // link; smaller than its own number
  Pose X_PL;                     // in the parent link's frame, at joint position 0
};

// A moving body: a robot, a movable object or a person, with everything below its root model.
struct Body {
  std::vector<Link> links;
  std::vector<ConvexPiece> pieces;         // each in the frame of its link
  std::vector<std::uint32_t> piece_links;  // by piece
  double radius = 0.0;  // m: every vertex stays within this distance of the body's origin, wherever its joints are
  ZRange z;             // m, spans all pieces wherever its joints are, in the body's frame

  bool has_joints() const { return links.size() > 1; }
};

class WalkRoutes;
struct LazyWalkRoutes;
class PathSchedule;
class TrafficRoutes;
struct TrafficRoutesStore;
struct LazyPathSchedule;

// A store of energy, with the models that it feeds.
struct Store {
  ModelId model;
  std::optional<RobotId> robot;  // whose drive it feeds
  double watts = 0.0;            // W that its models consume all the time
  double mass = 0.0;             // kg, of the robot
};

class Scene {
 public:
  // REQUIRES: Validate(description) found nothing.
  explicit Scene(Shared<WorldDescription> description);

  const WorldDescription& world() const { return *world_; }
  // As troupe::CheckState, without counting the rows again: that took a fifth of an agent's time.
  Status CheckState(const WorldState& state) const;
  const StaticIndex& static_index() const { return static_index_; }
  // Uses equal memory for the map, if there is any.
  void ShareMap(const FindEqualMemory& find) { static_index_.ShareRayMap(find); }

  // Bodies: robots by id, then objects by id, then people by id.
  std::size_t body_count() const { return bodies_.size(); }
  const Body& body(BodyId id) const { return bodies_[id.index()]; }
  const RayShape& ray_shape(BodyId id) const { return ray_shapes_[ray_shape_of_[id.index()]]; }
  BodyId body_of(RobotId robot) const { return BodyId(robot.index()); }
  BodyId body_of(ObjectId object) const { return BodyId(world().robots.size() + object.index()); }
  BodyId body_of(PersonId person) const {
    return BodyId(world().robots.size() + world().objects.size() + person.index());
  }
  // The body that the model belongs to; nothing for a static model.
  std::optional<BodyId> body_of(ModelId model) const { return body_of_[model.index()]; }
  std::optional<RobotId> robot_of(ModelId model) const;
  std::optional<ObjectId> object_of(ModelId model) const;
  std::optional<PersonId> person_of(ModelId model) const;
  // Nothing if the body is of another kind.
  std::optional<ObjectId> object_of(BodyId body) const;
  std::optional<PersonId> person_of(BodyId body) const;

  // The link of its body that the model belongs to, and its pose in that link. REQUIRES: body_of(model)
  std::uint32_t link_of(ModelId model) const { return link_of_[model.index()]; }
  const Pose& X_LM(ModelId model) const { return X_LM_[model.index()]; }
  // Poses of a body's links in its frame. `positions`: of all joints of the world, by JointId.
  void ComputeLinkPoses(BodyId body, std::span<const double> positions, std::vector<Pose>& X_BL) const;
  std::vector<Pose> LinkPosesAtStart(BodyId body) const;
  // Pose of a robot's model in the robot's frame with all joints at their starts. REQUIRES: robot_of(model)
  Pose X_RM(ModelId model) const;

  // The models with a fiducial_return, in id order, without removed ones.
  std::span<const ModelId> fiducials() const { return fiducials_; }

  // The stores of energy, in the order of StoreState.
  std::span<const Store> stores() const { return stores_; }
  // The store that feeds a model, among stores(); nothing for a model without one.
  std::optional<std::size_t> store_of(ModelId model) const { return store_of_[model.index()]; }

  // The lights of robots, in the order of LightState; the lights of one robot, and the row of the first of them; and
  // the row of a model among all, nothing for another model.
  std::span<const LightPlace> lights() const { return lights_; }
  std::span<const LightPlace> lights_of(RobotId robot) const;
  std::size_t first_light_of(RobotId robot) const;
  std::optional<std::size_t> light_of(ModelId model) const { return light_of_[model.index()]; }

  // The inertial measurement units, in the order of ImuState.
  std::span<const SensorPlace> imus() const { return imus_; }
  // The cameras, in the order of CameraState.
  std::span<const SensorPlace> cameras() const { return cameras_; }
  // No message gets farther than that from the pose of the robot that sends it, m; 0 without radios.
  double max_radio_reach() const { return max_radio_reach_; }

  // As in the model's description, but close together in memory.
  double ranger_return(ModelId model) const { return ranger_returns_[model.index()]; }

  std::span<const JointId> joints_of(RobotId robot) const { return joints_of_[robot.index()]; }
  std::span<const GripperId> grippers_of(RobotId robot) const { return grippers_of_[robot.index()]; }
  // The link that the joint moves, of its robot's body.
  std::uint32_t link_of(JointId joint) const { return joint_links_[joint.index()]; }

  // The ways of people. Made by the first call, by any thread.
  const WalkRoutes& walk_routes() const;

  // Routes on the lanes of the world for robots of these radii, m, by graph of lanes; for one thread, until they are
  // released. What they keep is of use to the next call with these radii, which change only when robots begin or end to
  // take part in the traffic.
  std::shared_ptr<TrafficRoutes> TrafficRoutesFor(const std::vector<double>& radii) const;

  // The order of the moves on the paths of the world's trips. Made by the first call, by any thread.
  const PathSchedule& path_schedule() const;

  // Frees the parts that calls have made, routes and schedules, as if none had been made: for a scene that ends with
  // its memory, without its destructor. REQUIRES: nothing uses these parts
  void FreeMadeParts() const;

  // The largest of all bodies' radii, m.
  double max_body_radius() const { return max_body_radius_; }

 private:
  void FindBodies();
  void FindStoresOfModels();
  void MeasureRadioReach();
  void AddModel(ModelId id, std::vector<ConvexPiece>& static_pieces, std::vector<PixelPieces>& areas);
  void MeasureBody(Body& body) const;

  Shared<WorldDescription> world_;
  std::vector<std::optional<BodyId>> body_of_;  // by model, like the next four
  std::vector<std::uint32_t> link_of_;
  std::vector<Pose> X_LM_;  // in W for static models
  std::vector<std::optional<JointId>> joint_of_;
  std::vector<double> ranger_returns_;
  std::vector<ModelId> fiducials_;
  std::vector<Store> stores_;
  std::vector<std::optional<std::size_t>> store_of_;  // by model
  std::vector<SensorPlace> imus_;
  std::vector<SensorPlace> cameras_;
  double max_radio_reach_ = 0.0;
  std::vector<LightPlace> lights_;
  std::vector<std::optional<std::size_t>> light_of_;  // by model
  std::vector<Body> bodies_;
  RayShapes ray_shapes_;
  std::vector<std::uint32_t> ray_shape_of_;          // by body
  std::vector<std::vector<JointId>> joints_of_;      // by robot
  std::vector<std::vector<GripperId>> grippers_of_;  // by robot
  std::vector<std::uint32_t> joint_links_;           // by joint
  StaticIndex static_index_;
  double max_body_radius_ = 0.0;
  std::shared_ptr<LazyWalkRoutes> walk_routes_;
  std::shared_ptr<TrafficRoutesStore> traffic_routes_;
  std::shared_ptr<LazyPathSchedule> path_schedule_;
};

// The world of a scene, without a copy: it lives as long as one of both.
inline std::shared_ptr<const WorldDescription> WorldOf(const std::shared_ptr<const Scene>& scene) {
  return {scene, &scene->world()};
}

}  // namespace troupe
