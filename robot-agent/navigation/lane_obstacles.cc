#include "robot-agent/navigation/lane_obstacles.h"

#include <algorithm>

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

// A leaf of a door that opens or closes, or that is closed.
bool IsMovingLeaf(const Surroundings& around, ObjectId object) {
  const std::vector<DoorDescription>& doors = around.scene.world().doors;
  for (std::size_t i = 0; i < doors.size(); ++i) {
    const bool is_leaf = std::any_of(doors[i].leaves.begin(), doors[i].leaves.end(),
                                     [&](const DoorLeaf& leaf) { return leaf.object == object; });
    if (is_leaf) return around.state.doors[i].opening < 1.0;
  }
  return false;
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
  if (!(way > 0.0)) return std::nullopt;
  const RobotMover robot(around, own);
  const Vec2 direction_R = Transform2(X_WR).InverseRotate(direction);
  const Motion motion{X_WR, {direction_R.x(), direction_R.y(), 0.0}, 0.0, way};  // 1 m/s: seconds are metres
  const std::optional<Contact> contact = FirstContact(around.scene, around.bodies, robot.mover(), motion);
  if (!contact || !contact->other) return std::nullopt;
  return ContactAhead{*contact->other, contact->time};
}

std::optional<LaneObstacle> FindObstacleAhead(const Surroundings& around, RobotId own, const Pose& X_WR,
                                              const Vec2& direction, double way) {
  const Scene& scene = around.scene;
  const WorldDescription& world = scene.world();
  const std::optional<ContactAhead> contact = FindContactAhead(around, own, X_WR, direction, way);
  if (!contact) return std::nullopt;
  ModelId model = contact->model;
  if (scene.robot_of(model)) return std::nullopt;
  if (const std::optional<ObjectId> object = scene.object_of(model)) {
    if (IsMovingLeaf(around, *object)) return std::nullopt;
    model = world.objects[object->index()];
  }
  const std::optional<PersonId> person = scene.person_of(model);
  if (person) {
    const PersonState& walker = around.state.people[person->index()];
    if (walker.vx != 0.0 || walker.vy != 0.0) return std::nullopt;
    model = world.person(*person).root;
  }
  return LaneObstacle{world.model(model).name, contact->room, person.has_value()};
}

ClosedLanes::Block ClosedLanes::Count(std::size_t lane) {
  auto entry = Find(lane);
  if (entry == entries_.end() || entry->lane != lane) entry = entries_.insert(entry, {.lane = lane});
  const double before = entry->seconds;
  entry->seconds = before == 0.0 ? kFirstSeconds : std::min(2.0 * before, kMaxSeconds);
  return {entry->seconds, entry->seconds > before};
}

void ClosedLanes::Close(std::size_t lane, double time) {
  const auto entry = Find(lane);
  entry->until = time + entry->seconds;
}

void ClosedLanes::Forget(std::size_t lane) {
  const auto entry = Find(lane);
  if (entry != entries_.end() && entry->lane == lane) entries_.erase(entry);
}

std::vector<std::size_t> ClosedLanes::At(double time) const {
  std::vector<std::size_t> lanes;
  for (const Entry& entry : entries_) {
    if (time < entry.until) lanes.push_back(entry.lane);
  }
  return lanes;
}

std::vector<ClosedLanes::Entry>::iterator ClosedLanes::Find(std::size_t lane) {
  return std::lower_bound(entries_.begin(), entries_.end(), lane,
                          [](const Entry& entry, std::size_t number) { return entry.lane < number; });
}

}  // namespace troupe
