#include "worldfile/scenario/place_spawns.h"

#include <memory_resource>
#include <string>

#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/lift_shafts.h"
#include "common/spatial/static_index.h"
#include "troupe/random.h"
#include "troupe/world_state.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Separates the poses of models from other uses of the same seed.
constexpr std::uint64_t kSpawnStream = 0x7370'6177'6e00;

bool Matters(const ConvexPiece& piece) {
  return piece.obstacle || piece.ranger_return >= 0.0;
}

Rectangle BoxOf(const std::vector<ConvexPiece>& pieces) {
  Rectangle box = Rectangle::Nothing();
  for (const ConvexPiece& piece : pieces) {
    for (const Vec2& vertex : piece.vertices) box.Extend(vertex);
  }
  return box;
}

// The size of the smallest box around the origin that contains the pieces at any heading.
double WidthOf(const std::vector<ConvexPiece>& pieces) {
  double radius = 0.0;
  for (const ConvexPiece& piece : pieces) {
    for (const Vec2& vertex : piece.vertices) radius = std::max(radius, vertex.norm());
  }
  return 2.0 * radius;
}

// A body at its place.
struct PlacedBody {
  std::vector<ConvexPiece> pieces;  // frame W
  Rectangle box = Rectangle::Nothing();
};

// Every model's root in the file, with which spawning moves it, and its pose in the root's frame. A model that is
// placed in the world by itself belongs to its parent in the file.
struct Tree {
  ModelId root;
  Pose X_RM;
};

std::vector<Tree> FindTrees(const LoadedWorld& loaded) {
  const std::vector<Pose> X_WM = ModelPoses(loaded.world, PlacedState(loaded.world));
  std::map<ModelId, const JointDescription*> joints;
  for (const JointDescription& joint : loaded.world.joints) joints.emplace(joint.model, &joint);
  std::vector<Tree> trees;
  for (std::size_t i = 0; i < loaded.world.models.size(); ++i) {
    const ModelDescription& model = loaded.world.models[i];
    if (const auto alone = loaded.placed_alone.find(ModelId(i)); alone != loaded.placed_alone.end()) {
      const ModelId root = trees[alone->second.index()].root;
      trees.push_back({root, Inverse(X_WM[root.index()]) * X_WM[i]});
    } else if (model.parent) {
      const Tree& parent = trees[model.parent->index()];
      const auto joint = joints.find(ModelId(i));
      const Pose X_PM =
          joint == joints.end() ? model.X_PM : model.X_PM * JointMotion(*joint->second, joint->second->start);
      trees.push_back({parent.root, parent.X_RM * X_PM});
    } else {
      trees.push_back({ModelId(i), Pose{}});
    }
  }
  return trees;
}

class Placer {
 public:
  Placer(LoadedWorld loaded, const std::vector<PlannedSpawn>& spawns, std::uint64_t seed, std::uint64_t max_draws)
      : spawns_(spawns), seed_(seed), max_draws_(max_draws), loaded_(std::move(loaded)), world_(loaded_.world) {}

  // REQUIRES: called once.
  Result<LoadedWorld> Run() {
    if (Status error = Prepare(); !error.ok()) return error.error();
    for (std::size_t i = 0; i < spawns_.size(); ++i) {
      if (Status error = Place(spawns_[i], i); !error.ok()) return error.error();
    }
    return std::move(loaded_);
  }

 private:
  // Sorts all pieces into the static ones and, by root, the pieces that need a place.
  Status Prepare() {
    std::map<std::string, ModelId> roots;
    for (std::size_t i = 0; i < world_.models.size(); ++i) roots.emplace(world_.models[i].name, ModelId(i));
    for (const PlannedSpawn& spawn : spawns_) {
      for (const std::string& name : spawn.names) {
        const auto found = roots.find(name);
        TROUPE_CHECK(found != roots.end());
        bodies_.emplace(found->second, std::vector<ConvexPiece>());
        roots_.emplace(name, found->second);
      }
    }
    for (std::size_t i = 0; i < world_.robots.size(); ++i) robots_.emplace(world_.robots[i].root, i);
    std::vector<ConvexPiece> static_pieces;
    std::vector<PixelPieces> areas;
    const std::vector<Tree> trees = FindTrees(loaded_);
    for (const auto& [alone, below] : loaded_.placed_alone) followers_[trees[alone.index()].root].push_back(alone);
    for (std::size_t i = 0; i < trees.size(); ++i) {
      const auto body = bodies_.find(trees[i].root);
      const bool placed = body == bodies_.end();
      const Pose X_FM = placed ? world_.model(trees[i].root).X_PM * trees[i].X_RM : trees[i].X_RM;
      for (ConvexPiece& piece : MakePieces(world_, ModelId(i), X_FM)) {
        if (Matters(piece)) (placed ? static_pieces : body->second).push_back(std::move(piece));
      }
      const ModelDescription& model = world_.models[i];
      if (!world_.shape(model.shape).area || (!model.obstacle_return && model.ranger_return < 0.0)) continue;
      if (placed) {
        AppendAreaPieces(world_, ModelId(i), X_FM, areas);
      } else if (world_.shape(model.shape).area->cover().count() > kMaxMovingRectangles) {
        return TooManyRectangles(model, trees[i].root);
      } else {
        std::vector<PixelPieces> own;
        AppendAreaPieces(world_, ModelId(i), X_FM, own);
        for (const PixelPieces& pieces : own) {
          pieces.ForEach([&](ConvexPiece piece) { body->second.push_back(std::move(piece)); });
        }
      }
    }
    for (ConvexPiece& shaft : EmptyShafts(world_)) static_pieces.push_back(std::move(shaft));
    static_index_ = StaticIndex(std::move(static_pieces), std::move(areas));
    double width = 0.0;
    for (const auto& [root, pieces] : bodies_) width = std::max(width, WidthOf(pieces));
    placed_cells_ = CellMap(width);
    return Status();
  }

  // A model that a rule places is tested piece by piece.
  Error TooManyRectangles(const ModelDescription& model, ModelId root) const {
    const auto spawn = std::find_if(spawns_.begin(), spawns_.end(), [&](const PlannedSpawn& rule) {
      return std::any_of(rule.names.begin(), rule.names.end(),
                         [&](const std::string& name) { return roots_.at(name) == root; });
    });
    return {spawn->rule->where, "found " + Quoted(model.name) + " with a bitmap of " +
                                    std::to_string(world_.shape(model.shape).area->cover().count()) +
                                    " rectangles, expected at most " + std::to_string(kMaxMovingRectangles) +
                                    " in a model that is placed by a rule"};
  }

  Status Place(const PlannedSpawn& spawn, std::size_t rule_number) {
    const SpawnEntry& rule = *spawn.rule;
    const Rectangle region = BoundingBox(rule.region);
    std::vector<Vec2> origins;
    CellMap origin_cells(rule.spacing);
    for (std::size_t i = 0; i < spawn.names.size(); ++i) {
      const ModelId root = roots_.at(spawn.names[i]);
      bool found = false;
      for (std::uint64_t draw = 0; draw < max_draws_ && !found; ++draw) {
        const auto random = [&](std::uint64_t component) {
          // Without the number of the rule: with its own seed a rule gives the same places wherever it is in the list.
          if (rule.seed) return RandomUniform({*rule.seed, kSpawnStream, i, draw, component});
          return RandomUniform({seed_, kSpawnStream, rule_number, i, draw, component});
        };
        Pose X_WR = world_.model(root).X_PM;
        X_WR.x = region.min_x + random(0) * region.width();
        X_WR.y = region.min_y + random(1) * region.height();
        if (rule.z) X_WR.z = *rule.z;
        // Each component has a key of its own: a fixed heading does not shift the other draws.
        X_WR.heading = rule.heading ? *rule.heading : WrapAngle((2.0 * random(2) - 1.0) * kPi);
        found = Contains(rule.region, X_WR.translation()) &&
                HasSpacing(X_WR.translation(), rule.spacing, origins, origin_cells) &&
                TryPlace(root, X_WR, spawn.origin_at_start);
      }
      if (!found) return NoRoom(rule, i);
      if (rule.spacing == 0.0) continue;
      const Vec2 origin = world_.model(root).X_PM.translation();
      origin_cells.Insert({origin.x(), origin.y(), origin.x(), origin.y()}, static_cast<std::uint32_t>(origins.size()));
      origins.push_back(origin);
    }
    return Status();
  }

  static bool HasSpacing(const Vec2& origin, double spacing, const std::vector<Vec2>& others, const CellMap& cells) {
    const Rectangle near{origin.x() - spacing, origin.y() - spacing, origin.x() + spacing, origin.y() + spacing};
    return !cells.AnyNear(
        near, [&](std::uint32_t other) { return (others[other] - origin).squaredNorm() < spacing * spacing; });
  }

  bool TryPlace(ModelId root, const Pose& X_WR, bool origin_at_start) {
    PlacedBody body;
    for (const ConvexPiece& piece : bodies_.at(root)) body.pieces.push_back(Transformed(piece, X_WR));
    body.box = BoxOf(body.pieces);
    if (!body.box.empty() && !IsFree(body)) return false;
    Pose& X_PM = world_.models[root.index()].X_PM;
    if (const auto robot = robots_.find(root); robot != robots_.end() && !origin_at_start) {
      // Odometry counts from a place in the world, from which the robot now starts elsewhere.
      Pose& origin = world_.robots[robot->second].localization.origin;
      origin = origin * Inverse(X_PM) * X_WR;
    }
    for (const ModelId follower : followers_[root]) {
      Pose& X_WF = world_.models[follower.index()].X_PM;
      // A model that is placed alone in the world keeps its pose relative to the robot that carries it in the file.
      X_WF = X_WR * (Inverse(X_PM) * X_WF);
    }
    X_PM = X_WR;
    // A model without pieces is nowhere in the way, and an empty box has no cells.
    if (!body.box.empty()) placed_cells_.Insert(body.box, static_cast<std::uint32_t>(placed_.size()));
    placed_.push_back(std::move(body));
    return true;
  }

  bool IsFree(const PlacedBody& body) const {
    NearPieces near;
    static_index_.Query(body.box, near);
    for (const ConvexPiece& piece : body.pieces) {
      for (const ConvexPiece* other : near) {
        if (OverlapBy(piece, *other, kTouchTolerance)) return false;
      }
    }
    return !placed_cells_.AnyNear(body.box, [&](std::uint32_t other) { return Overlap(body, placed_[other]); });
  }

  static bool Overlap(const PlacedBody& a, const PlacedBody& b) {
    if (!a.box.Overlaps(b.box)) return false;
    for (const ConvexPiece& piece_of_a : a.pieces) {
      for (const ConvexPiece& piece_of_b : b.pieces) {
        if (OverlapBy(piece_of_a, piece_of_b, kTouchTolerance)) return true;
      }
    }
    return false;
  }

  static Error NoRoom(const SpawnEntry& rule, std::size_t fitted) {
    return {rule.where, "found room for " + std::to_string(fitted) + " of " + std::to_string(rule.count) + " " +
                            Quoted(rule.model.text) +
                            ", expected room for all: enlarge the region or reduce count or "
                            "spacing"};
  }

  const std::vector<PlannedSpawn>& spawns_;
  std::uint64_t seed_;
  std::uint64_t max_draws_;
  LoadedWorld loaded_;
  WorldDescription& world_;
  std::map<std::string, ModelId> roots_;
  std::map<ModelId, std::size_t> robots_;               // by root
  std::map<ModelId, std::vector<ConvexPiece>> bodies_;  // by root, frame R
  std::map<ModelId, std::vector<ModelId>> followers_;   // placed in the world by themselves, by root
  StaticIndex static_index_;
  std::vector<PlacedBody> placed_;
  CellMap placed_cells_{0.0};
};

}  // namespace

Result<LoadedWorld> PlaceSpawns(LoadedWorld loaded, const std::vector<PlannedSpawn>& spawns, std::uint64_t seed,
                                std::uint64_t max_draws) {
  if (spawns.empty()) return loaded;
  return Placer(std::move(loaded), spawns, seed, max_draws).Run();
}

}  // namespace troupe
