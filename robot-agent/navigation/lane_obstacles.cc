#include "robot-agent/navigation/lane_obstacles.h"

#include <algorithm>

#include "common/spatial/scene.h"

namespace troupe {
namespace {

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
  Vec2 velocity = Vec2::Zero();
  if (person) {
    const PersonState& walker = around.state.people[person->index()];
    velocity = {walker.vx, walker.vy};
    model = world.person(*person).root;
  }
  return LaneObstacle{model,
                      world.model(model).name,
                      contact->room,
                      person.has_value(),
                      !velocity.isZero(0.0),
                      velocity.dot(direction) < 0.0};
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
