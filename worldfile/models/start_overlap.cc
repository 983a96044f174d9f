#include "worldfile/models/start_overlap.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory_resource>
#include <optional>
#include <set>
#include <utility>

#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/lift_shafts.h"
#include "common/spatial/static_index.h"
#include "troupe/world_state.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxMessages = 20;

// All pieces of a world that collide, in W, in one index. A body is a tree that moves as one: a robot's or an object's.
class Pieces {
 public:
  explicit Pieces(const WorldDescription& world) : world_(world), body_of_(world.models.size()) {
    for (const RobotDescription& robot : world.robots) body_of_[robot.root.index()] = robot.root;
    for (const ModelId object : world.objects) body_of_[object.index()] = object;
    for (const DoorDescription& door : world.doors) {
      for (const DoorLeaf& leaf : door.leaves) mounted_.insert(world.objects[leaf.object.index()]);
    }
    for (const LiftDescription& lift : world.lifts) mounted_.insert(world.objects[lift.cabin.index()]);
    const std::vector<Pose> poses = ModelPoses(world, PlacedState(world));
    std::vector<ConvexPiece> pieces;
    std::vector<PixelPieces> areas;
    for (std::size_t i = 0; i < world.models.size(); ++i) {
      const ModelDescription& model = world.models[i];
      if (model.parent && body_of_[model.parent->index()]) body_of_[i] = body_of_[model.parent->index()];
      if (!model.obstacle_return) continue;
      for (const ConvexPiece& piece : PiecesOf(ModelId(i))) {
        pieces.push_back(Transformed(piece, poses[i]));
        pieces.back().model = ModelId(i);
      }
      AppendAreaPieces(world, ModelId(i), poses[i], areas);
    }
    for (ConvexPiece& shaft : EmptyShafts(world)) pieces.push_back(std::move(shaft));
    index_ = StaticIndex(std::move(pieces), std::move(areas));
  }

  // The body that starts inside another model, by its root, with that model; of several the lowest id.
  std::map<ModelId, ModelId> FindOverlaps() const {
    std::map<ModelId, ModelId> found;
    NearPieces near;
    for (const ConvexPiece& piece : index_.kept_pieces()) {  // all of bodies are among them
      const std::optional<ModelId>& body = BodyOf(piece.model);
      if (!body || mounted_.contains(*body)) continue;  // a leaf may slide into a wall
      // The lowest id wins below: the order of a query must not decide on the message.
      index_.Query(BoundingBox(piece.vertices), near);
      for (const ConvexPiece* other : near) {
        if (BodyOf(other->model) == body || !OverlapBy(piece, *other, kNoticeableDepth)) continue;
        const auto [entry, is_new] = found.emplace(*body, other->model);
        if (!is_new) entry->second = std::min(entry->second, other->model);
      }
    }
    return found;
  }

 private:
  const std::optional<ModelId>& BodyOf(ModelId model) const { return body_of_[model.index()]; }

  // In the model's frame; cut into pieces once for all models of one shape.
  const std::vector<ConvexPiece>& PiecesOf(ModelId id) {
    const auto [entry, is_new] = by_shape_.try_emplace(world_.model(id).shape);
    if (is_new) entry->second = MakePieces(world_, id, Pose{});
    return entry->second;
  }

  const WorldDescription& world_;
  std::vector<std::optional<ModelId>> body_of_;  // by model
  std::set<ModelId> mounted_;                    // leaves of doors, and cabins
  std::map<ShapeId, std::vector<ConvexPiece>> by_shape_;
  StaticIndex index_;
};

// The messages of one kind of body; of many only their number.
std::vector<std::string> Describe(const std::string& kind, const std::string& consequence,
                                  const std::vector<std::pair<std::string, std::string>>& overlaps) {
  std::vector<std::string> messages;
  for (const auto& [name, other] : overlaps) {
    if (messages.size() == kMaxMessages) {
      messages.push_back(std::to_string(overlaps.size() - kMaxMessages) + " more " + kind + "s start inside something");
      break;
    }
    messages.push_back(fmt::format("{} {} starts inside {}{}", kind, Quoted(name), Quoted(other), consequence));
  }
  return messages;
}

}  // namespace

std::vector<std::string> FindStartOverlaps(const WorldDescription& world) {
  if (world.robots.empty()) return {};
  std::set<ModelId> robots;
  for (const RobotDescription& robot : world.robots) robots.insert(robot.root);
  std::vector<std::pair<std::string, std::string>> of_robots;
  std::vector<std::pair<std::string, std::string>> of_objects;
  for (const auto& [root, other] : Pieces(world).FindOverlaps()) {
    (robots.contains(root) ? of_robots : of_objects).emplace_back(world.model(root).name, world.model(other).name);
  }
  std::vector<std::string> messages = Describe("robot", ", so it may be stuck", of_robots);
  for (std::string& message : Describe("object", ", so a gripper may not move it", of_objects)) {
    messages.push_back(std::move(message));
  }
  return messages;
}

}  // namespace troupe
