#include "common/worldfile/start_overlap.h"

#include <algorithm>
#include <map>
#include <optional>

#include "common/spatial/convex_piece.h"
#include "common/spatial/overlap.h"
#include "common/spatial/static_index.h"
#include "common/worldfile/quote.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxMessages = 20;

// Placing by hand and rounding in a file make small overlaps that nobody means; they do not keep a robot from moving.
constexpr double kNoticeableDepth = 1e-6;  // m

Rectangle BoxOf(const ConvexPiece& piece) {
  Rectangle box = Rectangle::Nothing();
  for (const Vec2& vertex : piece.vertices) box.Extend(vertex);
  return box;
}

bool Overlap(const ConvexPiece& a, const ConvexPiece& b) {
  return a.z.Overlaps(b.z) && PenetrationDepth(a.vertices, b.vertices) > kNoticeableDepth;
}

// All pieces of a world that collide, in W, in one index.
class Pieces {
 public:
  explicit Pieces(const WorldDescription& world) : world_(world) {
    for (std::size_t i = 0; i < world.robots.size(); ++i) robot_of_[world.robots[i].root] = RobotId(i);
    const std::vector<Pose> poses = InitialModelPoses(world);
    std::vector<ConvexPiece> pieces;
    for (std::size_t i = 0; i < world.models.size(); ++i) {
      const ModelDescription& model = world.models[i];
      if (model.parent) {
        const auto parent = robot_of_.find(*model.parent);
        if (parent != robot_of_.end()) robot_of_[ModelId(i)] = parent->second;
      }
      if (!model.obstacle_return) continue;
      for (const ConvexPiece& piece : PiecesOf(ModelId(i))) {
        pieces.push_back(Transformed(piece, poses[i]));
        pieces.back().model = ModelId(i);
      }
    }
    index_ = StaticIndex(std::move(pieces));
  }

  // For each robot what it starts inside of, if anything: the model with the lowest id.
  std::map<RobotId, ModelId> FindOverlaps() const {
    std::map<RobotId, ModelId> found;
    std::vector<std::uint32_t> near;
    for (const ConvexPiece& piece : index_.pieces()) {
      const std::optional<RobotId> robot = RobotOf(piece.model);
      if (!robot) continue;
      near.clear();
      index_.Query(BoxOf(piece), near);
      for (const std::uint32_t i : near) {
        const ConvexPiece& other = index_.pieces()[i];
        if (RobotOf(other.model) == robot || !Overlap(piece, other)) continue;
        const auto [entry, is_new] = found.emplace(*robot, other.model);
        if (!is_new) entry->second = std::min(entry->second, other.model);
      }
    }
    return found;
  }

 private:
  std::optional<RobotId> RobotOf(ModelId model) const {
    const auto found = robot_of_.find(model);
    return found == robot_of_.end() ? std::nullopt : std::optional(found->second);
  }

  // In the model's frame; cut into pieces once for all models of one shape.
  const std::vector<ConvexPiece>& PiecesOf(ModelId id) {
    const auto [entry, is_new] = by_shape_.try_emplace(world_.model(id).shape);
    if (is_new) entry->second = MakePieces(world_, id, Pose{});
    return entry->second;
  }

  const WorldDescription& world_;
  std::map<ModelId, RobotId> robot_of_;
  std::map<ShapeId, std::vector<ConvexPiece>> by_shape_;
  StaticIndex index_;
};

}  // namespace

std::vector<std::string> FindStartOverlaps(const WorldDescription& world) {
  std::vector<std::string> messages;
  if (world.robots.empty()) return messages;
  const std::map<RobotId, ModelId> overlaps = Pieces(world).FindOverlaps();
  for (const auto& [robot, model] : overlaps) {
    if (messages.size() == kMaxMessages) {
      messages.push_back(std::to_string(overlaps.size() - kMaxMessages) + " more robots start inside something");
      break;
    }
    messages.push_back("robot " + Quoted(world.robot(robot).name) + " starts inside " +
                       Quoted(world.model(model).name) + ", so it may be stuck");
  }
  return messages;
}

}  // namespace troupe
