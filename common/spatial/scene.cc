#include "common/spatial/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>
#include <variant>

#include "common/model/states.h"
#include "common/spatial/walk_routes.h"
#include "common/traffic/path_schedule.h"
#include "common/traffic/traffic_routes.h"

namespace troupe {

struct TrafficRoutesStore {
  std::mutex mutex;
  std::vector<double> radii;
  std::shared_ptr<const TrafficGraph> graph;  // null: none yet
  std::vector<std::unique_ptr<TrafficRoutes>> free;
};

struct LazyPathSchedule {
  std::once_flag made;
  std::unique_ptr<const PathSchedule> schedule;
};

Scene::Scene(Shared<WorldDescription> description)
    : world_(std::move(description)),
      walk_routes_(std::make_shared<LazyWalkRoutes>()),
      traffic_routes_(std::make_shared<TrafficRoutesStore>()),
      path_schedule_(std::make_shared<LazyPathSchedule>()) {
  FindBodies();
  FindStoresOfModels();
  imus_ = FindImus(world());
  cameras_ = FindCameras(world());
  lights_ = FindLights(world());
  light_of_.resize(world().models.size());
  for (std::size_t i = 0; i < lights_.size(); ++i) light_of_[lights_[i].model.index()] = i;
  std::vector<ConvexPiece> static_pieces;
  std::vector<PixelPieces> areas;
  for (std::size_t i = 0; i < world().models.size(); ++i) AddModel(ModelId(i), static_pieces, areas);
  static_index_ = StaticIndex(std::move(static_pieces), std::move(areas));
  for (Body& body : bodies_) {
    MeasureBody(body);
    max_body_radius_ = std::max(max_body_radius_, body.radius);
    ray_shape_of_.push_back(ray_shapes_.Add(body));
  }
  MeasureRadioReach();
}

std::shared_ptr<TrafficRoutes> Scene::TrafficRoutesFor(const std::vector<double>& radii) const {
  const std::lock_guard lock(traffic_routes_->mutex);
  TrafficRoutesStore& store = *traffic_routes_;
  if (!store.graph || store.radii != radii) {
    store.graph = std::make_shared<const TrafficGraph>(world().lane_graphs, radii);
    store.radii = radii;
    store.free.clear();
  }
  std::unique_ptr<TrafficRoutes> routes;
  if (store.free.empty()) {
    routes = std::make_unique<TrafficRoutes>(store.graph);
  } else {
    routes = std::move(store.free.back());
    store.free.pop_back();
  }
  return {routes.release(), [owner = traffic_routes_](TrafficRoutes* used) {
            std::unique_ptr<TrafficRoutes> returned(used);
            const std::lock_guard returning(owner->mutex);
            if (&returned->graph() == owner->graph.get()) owner->free.push_back(std::move(returned));
          }};
}

const WalkRoutes& Scene::walk_routes() const {
  // People decide in several threads: the first one makes the routes, the others wait.
  std::call_once(walk_routes_->made, [this] { walk_routes_->routes = std::make_unique<const WalkRoutes>(*this); });
  return *walk_routes_->routes;
}

const PathSchedule& Scene::path_schedule() const {
  std::call_once(path_schedule_->made, [this] {
    std::vector<LaneTrip> trips = world().lane_trips;
    for (LaneTrip& trip : trips) {
      if (!RobotExists(world(), trip.robot)) trip.path.clear();  // the others do not wait for it
    }
    path_schedule_->schedule = std::make_unique<const PathSchedule>(trips);
  });
  return *path_schedule_->schedule;
}

void Scene::FreeMadeParts() const {
  const auto renew = [](const auto& part) {
    if (part.use_count() != 1) return;  // a scene that was copied from this one has it, too
    std::destroy_at(part.get());
    std::construct_at(part.get());
  };
  renew(walk_routes_);
  renew(traffic_routes_);
  renew(path_schedule_);
}

void Scene::FindBodies() {
  const std::size_t models = world().models.size();
  body_of_.resize(models);
  link_of_.resize(models, 0);
  X_LM_.resize(models);
  joint_of_.resize(models);
  for (std::size_t i = 0; i < models; ++i) {
    const ModelDescription& model = world().models[i];
    ranger_returns_.push_back(model.ranger_return);
    if (model.fiducial_return != 0 && !model.removed) fiducials_.emplace_back(i);
  }
  bodies_.resize(world().robots.size() + world().objects.size() + world().people.size());
  // Link 0, which is at the body's frame.
  for (Body& body : bodies_) body.links.push_back({});
  for (std::size_t i = 0; i < world().robots.size(); ++i) body_of_[world().robots[i].root.index()] = BodyId(i);
  for (std::size_t i = 0; i < world().objects.size(); ++i) {
    body_of_[world().objects[i].index()] = body_of(ObjectId(i));
  }
  for (std::size_t i = 0; i < world().people.size(); ++i) {
    body_of_[world().people[i].root.index()] = body_of(PersonId(i));
  }
  joints_of_.resize(world().robots.size());
  grippers_of_.resize(world().robots.size());
  joint_links_.resize(world().joints.size(), 0);
  for (std::size_t i = 0; i < world().joints.size(); ++i) {
    joint_of_[world().joints[i].model.index()] = JointId(i);
    joints_of_[world().joints[i].robot.index()].push_back(JointId(i));
  }
  for (std::size_t i = 0; i < world().grippers.size(); ++i) {
    grippers_of_[world().grippers[i].robot.index()].push_back(GripperId(i));
  }
}

Status Scene::CheckState(const WorldState& state) const {
  const DeviceCounts devices{
      .stores = stores_.size(), .imus = imus_.size(), .lights = lights_.size(), .cameras = cameras_.size()};
  return troupe::CheckState(world(), devices, state);
}

std::size_t Scene::first_light_of(RobotId robot) const {
  const auto first = std::lower_bound(lights_.begin(), lights_.end(), robot,
                                      [](const LightPlace& light, RobotId id) { return light.robot < id; });
  return static_cast<std::size_t>(first - lights_.begin());
}

std::span<const LightPlace> Scene::lights_of(RobotId robot) const {
  const std::size_t first = first_light_of(robot);
  std::size_t end = first;
  while (end < lights_.size() && lights_[end].robot == robot) ++end;
  return std::span(lights_).subspan(first, end - first);
}

void Scene::FindStoresOfModels() {
  store_of_.resize(world().models.size());
  for (const ModelId model : FindStores(world())) {
    store_of_[model.index()] = stores_.size();
    stores_.push_back({.model = model, .robot = std::nullopt});
  }
  if (stores_.empty()) return;
  // Parents first.
  for (std::size_t i = 0; i < world().models.size(); ++i) {
    const ModelDescription& model = world().models[i];
    // A model without a store of its own is fed by that of its nearest ancestor, which is known already.
    if (!store_of_[i] && model.parent) store_of_[i] = store_of_[model.parent->index()];
    if (store_of_[i] && !model.removed) stores_[*store_of_[i]].watts += model.power.watts;
  }
  for (std::size_t i = 0; i < world().robots.size(); ++i) {
    const RobotDescription& robot = world().robots[i];
    const std::optional<std::size_t> of_drive = store_of_[robot.root.index()];
    if (!of_drive) continue;
    stores_[*of_drive].robot = RobotId(i);
    stores_[*of_drive].mass = world().model(robot.root).power.mass;
  }
}

void Scene::MeasureRadioReach() {
  for (const RobotDescription& robot : world().robots) {
    for (const SensorDescription& sensor : robot.sensors) {
      const auto* const radio = std::get_if<RadioParameters>(&sensor.parameters);
      if (radio == nullptr) continue;
      // The antenna may be anywhere on a circle about the robot's origin.
      const double offset = X_LM(sensor.model).translation().norm() + radio->X_MS.translation().norm();
      const double reach = (radio->range + offset) * (1.0 + 1e-9);
      // Joints may take an antenna farther.
      const bool is_fixed = link_of(sensor.model) == 0;
      max_radio_reach_ = std::max(max_radio_reach_, is_fixed ? reach : std::numeric_limits<double>::infinity());
    }
  }
}

void Scene::AddModel(ModelId id, std::vector<ConvexPiece>& static_pieces, std::vector<PixelPieces>& areas) {
  const std::size_t i = id.index();
  const ModelDescription& model = world().models[i];
  if (model.parent) {
    const std::size_t parent = model.parent->index();
    body_of_[i] = body_of_[parent];
    link_of_[i] = link_of_[parent];
    X_LM_[i] = X_LM_[parent] * model.X_PM;
  } else {
    X_LM_[i] = body_of_[i] ? Pose{} : model.X_PM;
  }
  if (!body_of_[i]) {
    std::vector<ConvexPiece> pieces = MakePieces(world(), id, X_LM_[i]);
    std::move(pieces.begin(), pieces.end(), std::back_inserter(static_pieces));
    AppendAreaPieces(world(), id, X_LM_[i], areas);
    return;
  }
  Body& body = bodies_[body_of_[i]->index()];
  // A model with a joint begins a link: its frame is the link's, and all models below it belong to the link until
  // another joint begins one.
  if (joint_of_[i]) {
    body.links.push_back({.joint = joint_of_[i], .parent = link_of_[i], .X_PL = X_LM_[i]});
    link_of_[i] = static_cast<std::uint32_t>(body.links.size() - 1);
    X_LM_[i] = Pose{};
    joint_links_[joint_of_[i]->index()] = link_of_[i];
  }
  std::vector<ConvexPiece> pieces = MakePieces(world(), id, X_LM_[i]);
  body.piece_links.resize(body.piece_links.size() + pieces.size(), link_of_[i]);
  std::move(pieces.begin(), pieces.end(), std::back_inserter(body.pieces));
}

void Scene::MeasureBody(Body& body) const {
  // The largest distance of each link's origin from the body's, and its range of heights.
  std::vector<double> reach(body.links.size(), 0.0);
  std::vector<ZRange> heights(body.links.size());
  for (std::size_t k = 1; k < body.links.size(); ++k) {
    const Link& link = body.links[k];
    const JointDescription& joint = world().joint(*link.joint);
    reach[k] = reach[link.parent] + link.X_PL.translation().norm();
    heights[k] = heights[link.parent] + link.X_PL.z;
    // A turn leaves the origin of its link where it is; a shift moves it by up to the farther end of its way.
    if (joint.type == JointType::kRevolute) continue;
    const double travel = std::max(std::abs(joint.position.min), std::abs(joint.position.max));
    reach[k] += travel * joint.axis_xy.norm();
    const double a = joint.position.min * joint.axis_z;
    const double b = joint.position.max * joint.axis_z;
    heights[k] = {heights[k].min + std::min(a, b), heights[k].max + std::max(a, b)};
  }
  for (std::size_t i = 0; i < body.pieces.size(); ++i) {
    const ConvexPiece& piece = body.pieces[i];
    const std::uint32_t link = body.piece_links[i];
    const ZRange z{piece.z.min + heights[link].min, piece.z.max + heights[link].max};
    body.z.min = i == 0 ? z.min : std::min(body.z.min, z.min);
    body.z.max = i == 0 ? z.max : std::max(body.z.max, z.max);
    for (const Vec2& vertex : piece.vertices) body.radius = std::max(body.radius, reach[link] + vertex.norm());
  }
}

std::optional<RobotId> Scene::robot_of(ModelId model) const {
  const std::optional<BodyId>& body = body_of_[model.index()];
  return body && body->index() < world().robots.size() ? std::optional(RobotId(body->index())) : std::nullopt;
}

std::optional<ObjectId> Scene::object_of(ModelId model) const {
  const std::optional<BodyId>& body = body_of_[model.index()];
  return body ? object_of(*body) : std::nullopt;
}

std::optional<ObjectId> Scene::object_of(BodyId body) const {
  const std::size_t robots = world().robots.size();
  if (body.index() < robots || body.index() - robots >= world().objects.size()) return std::nullopt;
  return ObjectId(body.index() - robots);
}

std::optional<PersonId> Scene::person_of(ModelId model) const {
  const std::optional<BodyId>& body = body_of_[model.index()];
  return body ? person_of(*body) : std::nullopt;
}

std::optional<PersonId> Scene::person_of(BodyId body) const {
  const std::size_t others = world().robots.size() + world().objects.size();
  return body.index() >= others ? std::optional(PersonId(body.index() - others)) : std::nullopt;
}

void Scene::ComputeLinkPoses(BodyId id, std::span<const double> positions, std::vector<Pose>& X_BL) const {
  const Body& body = bodies_[id.index()];
  X_BL.resize(body.links.size());
  for (std::size_t k = 1; k < body.links.size(); ++k) {
    const Link& link = body.links[k];
    X_BL[k] = X_BL[link.parent] * link.X_PL * JointMotion(world().joint(*link.joint), positions[link.joint->index()]);
  }
}

std::vector<Pose> Scene::LinkPosesAtStart(BodyId body) const {
  std::vector<double> positions;
  for (const JointDescription& joint : world().joints) positions.push_back(joint.start);
  std::vector<Pose> X_BL;
  ComputeLinkPoses(body, positions, X_BL);
  return X_BL;
}

Pose Scene::X_RM(ModelId model) const {
  const std::uint32_t link = link_of(model);
  return link == 0 ? X_LM(model) : LinkPosesAtStart(*body_of(model))[link] * X_LM(model);
}

}  // namespace troupe
