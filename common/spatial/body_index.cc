#include "common/spatial/body_index.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "troupe/check.h"

namespace troupe {
namespace {

constexpr double kMinCell = 0.01;  // m

Rectangle BoundsOf(const std::vector<Pose>& poses) {
  Rectangle bounds = Rectangle::Nothing();
  for (const Pose& pose : poses) bounds.Extend(pose.translation());
  return bounds;
}

// The velocity of a point at `r` from the axis of a turn.
Vec2 Across(double rate, const Vec2& r) {
  return {-rate * r.y(), rate * r.x()};
}

}  // namespace

void BodyIndex::Assign(const WorldState& state) {
  const WorldDescription& world = scene_->world();
  TROUPE_CHECK(state.robots.size() == world.robots.size() && state.objects.size() == world.objects.size() &&
               state.joints.size() == world.joints.size() && state.people.size() == world.people.size());
  const std::size_t count = scene_->body_count();
  const bool first = X_WB_.size() != count || positions_.size() != world.joints.size();
  if (first) {
    X_WB_.clear();
    positions_.clear();
    for (const RobotState& robot : state.robots) X_WB_.push_back(robot.X_WR);
    for (const ObjectState& object : state.objects) X_WB_.push_back(object.X_WO);
    for (const PersonState& person : state.people) X_WB_.push_back(person.X_WP);
    for (const JointState& joint : state.joints) positions_.push_back(joint.position);
    cache_.assign(count, {});
    transforms_.assign(count, {});
    discs_.Clear();
    // The radius of the ray shape is the body's with a tolerance for the rounding of a moved vertex.
    for (std::size_t i = 0; i < count; ++i) discs_.Add(X_WB_[i].translation(), scene_->ray_shape(BodyId(i)).radius);
    fresh_.assign(count, 0);
    owner_.assign(count, std::nullopt);
    for (std::size_t i = 0; i < state.robots.size(); ++i) owner_[i] = RobotId(i);
    if (has_grid()) Rebuild();
  } else {
    for (std::size_t i = 0; i < state.robots.size(); ++i) Move(BodyId(i), state.robots[i].X_WR);
    for (std::size_t i = 0; i < state.objects.size(); ++i) {
      Move(scene_->body_of(ObjectId(i)), state.objects[i].X_WO);
    }
    for (std::size_t i = 0; i < state.people.size(); ++i) Move(scene_->body_of(PersonId(i)), state.people[i].X_WP);
    for (std::size_t i = 0; i < state.joints.size(); ++i) MoveJoint(JointId(i), state.joints[i].position);
    if (has_grid() && !FitsGrid()) Rebuild();
  }
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    const std::optional<GripperId>& holder = state.objects[i].holder;
    // Every time: a holder changes without a motion.
    owner_[world.robots.size() + i] = holder ? std::optional(world.gripper(*holder).robot) : std::nullopt;
  }
}

void BodyIndex::Move(BodyId body, const Pose& X_WB) {
  const auto index = static_cast<std::uint32_t>(body.index());
  // By value: -0.0 and 0.0 count as equal, and give the same vertices but for a sign of zero.
  if (X_WB_[index] == X_WB) return;
  X_WB_[index] = X_WB;
  discs_.Move(index, X_WB.translation());
  // Links are in the frame of the body, and stay valid; everything in W does not.
  fresh_[index] &= kLinksFresh;
  if (!has_grid() || grid_.CellOf(X_WB.translation()) == cell_of_[index]) return;
  Remove(index);
  Insert(index);
}

void BodyIndex::MoveJoint(JointId joint, double position) {
  if (positions_[joint.index()] == position) return;
  positions_[joint.index()] = position;
  // The other way round: the body has not moved, but its links have.
  fresh_[scene_->body_of(scene_->world().joint(joint).robot).index()] &= kTransformFresh;
}

const Transform2& BodyIndex::transform(BodyId body) const {
  Transform2& transform = transforms_[body.index()];
  if ((fresh_[body.index()] & kTransformFresh) == 0) transform = Transform2(X_WB_[body.index()]);
  fresh_[body.index()] |= kTransformFresh;
  return transform;
}

const std::vector<Pose>& BodyIndex::X_BL(BodyId body) const {
  Cache& cache = cache_[body.index()];
  if ((fresh_[body.index()] & kLinksFresh) == 0) scene_->ComputeLinkPoses(body, positions_, cache.X_BL);
  fresh_[body.index()] |= kLinksFresh;
  return cache.X_BL;
}

Pose BodyIndex::X_WM(ModelId model) const {
  const BodyId body = *scene_->body_of(model);
  const std::uint32_t link = scene_->link_of(model);
  const Pose& X_WB = X_WB_[body.index()];
  const Pose& X_LM = scene_->X_LM(model);
  if (link != 0) return X_WB * X_BL(body)[link] * X_LM;
  // X_WB * X_LM, with the same bits.
  const Vec2 p = transform(body) * X_LM.translation();
  return {p.x(), p.y(), X_WB.z + X_LM.z, WrapAngle(X_WB.heading + X_LM.heading)};
}

Transform2 BodyIndex::TransformOf(ModelId model, const Pose& X_WM) const {
  const BodyId body = *scene_->body_of(model);
  // By bits: the sines of both zeros differ.
  const bool is_alike =
      std::bit_cast<std::uint64_t>(X_WM.heading) == std::bit_cast<std::uint64_t>(X_WB_[body.index()].heading);
  return is_alike ? transform(body).MovedTo(X_WM.translation()) : Transform2(X_WM);
}

const std::vector<ConvexPiece>& BodyIndex::pieces_in_world(BodyId id) const {
  Cache& cache = cache_[id.index()];
  if ((fresh_[id.index()] & kPiecesFresh) != 0) return cache.pieces;
  const Body& body = scene_->body(id);
  const Pose& X_WB = X_WB_[id.index()];
  // Once: from then on only heights and vertices are written, into memory that is there already.
  if (cache.pieces.size() != body.pieces.size()) cache.pieces = body.pieces;
  Pose X_WL = X_WB;
  Transform2 transform = this->transform(id);
  std::uint32_t link = 0;
  for (std::size_t i = 0; i < body.pieces.size(); ++i) {
    // Pieces of one link are neighbours: a transform is made once for each.
    if (body.piece_links[i] != link) {
      link = body.piece_links[i];
      X_WL = link == 0 ? X_WB : X_WB * X_BL(id)[link];
      transform = Transform2(X_WL);
    }
    const ConvexPiece& from = body.pieces[i];
    ConvexPiece& to = cache.pieces[i];
    to.z = from.z + X_WL.z;
    for (std::size_t v = 0; v < from.vertices.size(); ++v) to.vertices[v] = transform * from.vertices[v];
  }
  fresh_[id.index()] |= kPiecesFresh;
  return cache.pieces;
}

void BodyIndex::Query(const Rectangle& box, std::pmr::vector<BodyId>& result) const {
  const auto first = static_cast<std::ptrdiff_t>(result.size());
  ForEachNear(box, [&](BodyId body) { result.push_back(body); });
  // Without a grid the discs are in the order of ids already.
  if (has_grid()) std::sort(result.begin() + first, result.end());
}

// The grid fits as long as all bodies are in it and are not all in a small part of it. It is correct anyway, only
// slower.
bool BodyIndex::FitsGrid() const {
  const Rectangle bounds = BoundsOf(X_WB_);
  const Rectangle& grid = grid_.bounds();
  return grid.Contains({bounds.min_x, bounds.min_y}) && grid.Contains({bounds.max_x, bounds.max_y}) &&
         4.0 * (std::max(bounds.width(), bounds.height()) + grid_.cell_size()) >= std::max(grid.width(), grid.height());
}

void BodyIndex::Rebuild() {
  const std::size_t count = X_WB_.size();
  const Rectangle tight = BoundsOf(X_WB_);
  const double smallest_cell = std::max(2.0 * scene_->max_body_radius(), kMinCell);
  // Room to drive without having to rebuild.
  const Rectangle bounds = tight.Inflated(0.25 * std::max(tight.width(), tight.height()) + smallest_cell);
  const double bodies = static_cast<double>(count);
  // About one body in a cell, but no cell smaller than the largest body, so that a query looks at few cells.
  const double cell = std::max(smallest_cell, std::sqrt(bounds.width() * bounds.height() / bodies));
  grid_ = Grid(bounds, cell, 2.0 * bodies + 16.0);
  cell_first_.assign(grid_.cell_count(), kNone);
  next_.assign(count, kNone);
  cell_of_.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) Insert(static_cast<std::uint32_t>(i));
}

void BodyIndex::Insert(std::uint32_t body) {
  const std::size_t cell = grid_.CellOf(X_WB_[body].translation());
  cell_of_[body] = static_cast<std::uint32_t>(cell);
  next_[body] = cell_first_[cell];
  cell_first_[cell] = body;
}

void BodyIndex::Remove(std::uint32_t body) {
  std::uint32_t* link = &cell_first_[cell_of_[body]];
  while (*link != body) link = &next_[*link];
  *link = next_[body];
}

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
  // From the model's link up to the base: each joint on the way adds the velocity that it gives to the point.
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
